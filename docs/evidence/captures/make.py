"""Makes synthetic captures of a wig in the wind, with the truth beside them.

    pip install -r requirements.txt
    python3 make.py NAME... -o DIR
    python3 make.py all -o DIR
    python3 make.py --list

README.md beside it says what they are; the format is that of the project's development captures.
"""

import argparse
import json
import shutil
import sys
import time
import zlib
from pathlib import Path
from typing import Any

import numpy as np

import truth
from cameras import head_markers_m, record
from configurations import CONFIGS, DURATION_SECS
from engine import DivergedError, Simulation
from hairstyles import style_b_of, wig_of
from head_motion import HeadMotion
from locks import Lock
from session import session
from truth import SIMULATED_HZ
from wind import Wind

LOCKS_AT_ONCE = 8
"""Locks in one simulation; contacts make the engine's time grow faster than their number."""
SHARED_FILES = ("style_b.json", "truth/style_b.npz", "truth/wig_a.npz", "truth/field.npz")
"""What captures of the same motion have in common; none of it depends on the cameras."""


def make(name: str, captures: Path) -> None:
    """Makes one capture, `captures/name/`; one that shows another's motion needs that in `captures`."""
    config = CONFIGS[name]
    folder = captures / name
    (folder / "truth").mkdir(parents=True, exist_ok=True)
    seed = zlib.crc32((config.seed_of or config.motion_of or name).encode()) & 0xFFFF
    # Each matter has random numbers of its own, so that none of them changes when another draws more.
    for_hair, for_wind, for_cameras, for_session = (
        np.random.default_rng([seed, matter]) for matter in range(4)
    )

    motion = HeadMotion(config.motion)
    wind = Wind(config.fan, motion, for_wind)
    wig, style_b = wig_of(config.wig, for_hair), style_b_of(config.style_b, for_hair)
    rate_hz = config.cameras.rate_hz
    every = SIMULATED_HZ // rate_hz
    if config.motion_of is None:
        nodes_m = _simulate(name, wig + style_b, motion, wind)
        _write_hair_and_wind(folder, wig, style_b, nodes_m, wind)
        places = [
            lock.places_m(nodes[::every], lock.marker_distances_m)
            for lock, nodes in zip(wig, nodes_m[: len(wig)], strict=True)
        ]
        markers_m = np.concatenate(places, 1)
    else:
        for file in SHARED_FILES:
            shutil.copy(captures / config.motion_of / file, folder / file)
        with np.load(captures / config.motion_of / "truth/markers.npz") as there:
            markers_m = there["pos_head"][::every].astype(float)

    times_secs = np.arange(round(DURATION_SECS * rate_hz)) / rate_hz
    samples = [motion.index(secs) for secs in times_secs]
    head_m = np.concatenate([head_markers_m(motion, samples, for_session), markers_m], 1)
    turned_m = np.einsum("tij,tmj->tmi", motion.rotation[samples], head_m)
    world_mm = (turned_m + motion.position_m[samples][:, None]) * 1e3
    recording = record(world_mm, wig, config.cameras, for_cameras)

    recording.write_csv(folder / f"{name}.csv")
    truth.write_head(folder / "truth/head.npz", motion, times_secs, samples)
    truth.write_markers(folder / "truth/markers.npz", times_secs, markers_m, recording.visible)
    _write_json(folder / "session.json", session(name, config, wig, for_session))
    # Last, as a folder with it counts as a capture.
    _write_json(folder / "truth/truth.json", truth.facts(name, config, wig, wind, recording))


def _simulate(name: str, locks: list[Lock], motion: HeadMotion, wind: Wind) -> list[np.ndarray]:
    """Places (T, n + 1, 3) of the ends of every lock's sticks, m, at SIMULATED_HZ."""
    nodes_m: list[np.ndarray] = []
    for first in range(0, len(locks), LOCKS_AT_ONCE):
        print(f"{name}: {first} of {len(locks)} locks simulated", file=sys.stderr)
        simulation = Simulation(locks[first : first + LOCKS_AT_ONCE], motion, wind)
        simulation.settle()
        nodes_m += simulation.run(SIMULATED_HZ, DURATION_SECS)
    return nodes_m


def _write_hair_and_wind(
    folder: Path, wig: list[Lock], style_b: list[Lock], nodes_m: list[np.ndarray], wind: Wind
) -> None:
    wig_m, style_b_m = nodes_m[: len(wig)], nodes_m[len(wig) :]
    curves_m = truth.write_curves(folder / "truth/style_b.npz", style_b, style_b_m)
    _write_json(folder / "style_b.json", truth.style_b_facts(style_b, curves_m), indent=None)
    truth.write_curves(folder / "truth/wig_a.npz", wig, wig_m)
    truth.write_field(folder / "truth/field.npz", wind, wig, wig_m)


def _write_json(path: Path, content: dict[str, Any], indent: int | None = 1) -> None:
    path.write_text(json.dumps(content, indent=indent), encoding="utf-8")


def _chosen(parser: argparse.ArgumentParser, names: list[str], captures: Path) -> list[str]:
    """The captures asked for, each after the one whose motion it shows; an error if that is not there."""
    unknown = [name for name in names if name not in CONFIGS and name != "all"]
    if unknown:
        parser.error(f"no capture {', '.join(unknown)}; there are: {', '.join(CONFIGS)}, or all")
    chosen = [name for name in CONFIGS if name in names or "all" in names]
    for name in chosen:
        source = CONFIGS[name].motion_of
        if source and source not in chosen and not (captures / source / "truth/truth.json").is_file():
            parser.error(
                f"{name} shows the motion of {source}, which is not in {captures}: ask for {source} too"
            )
    return chosen


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(
        description="Makes synthetic captures of a wig in the wind, with the truth."
    )
    parser.add_argument("names", metavar="NAME", nargs="*", help="captures to make, or: all")
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, help="folder that gets a folder for each")
    parser.add_argument("--list", action="store_true", help="say what there is, and make nothing")
    arguments = parser.parse_args()
    if arguments.list:
        for name, config in CONFIGS.items():
            print(f"{name:18}{config.summary}")
        return
    if not arguments.names or arguments.output is None:
        parser.error("needs names of captures (or all, or --list to see them), and -o DIR")
    for name in _chosen(parser, arguments.names, arguments.output):
        start_secs = time.monotonic()
        try:
            make(name, arguments.output)
        except (DivergedError, OSError) as error:
            sys.exit(f"make.py: {name}: {error}")
        print(f"{name}: made in {time.monotonic() - start_secs:.0f} s")


if __name__ == "__main__":
    main()
