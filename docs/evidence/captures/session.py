"""What the people in the room would know of a capture: `session.json`, with a hand's errors."""

from typing import Any

import numpy as np

from body import HEAD_ROTATION, TEMPLATE
from configurations import DURATION_SECS, STILL_SECS, Config, Fan
from locks import Lock
from wind import direction_from


def session(name: str, config: Config, wig: list[Lock], rng: np.random.Generator) -> dict[str, Any]:
    """The session of a capture: what the template says of room and subject, with this capture's settings."""
    rate_hz = config.cameras.rate_hz
    still_frames = round(STILL_SECS * rate_hz)
    return {
        "name": name,
        "rate_hz": rate_hz,
        "frames": round(DURATION_SECS * rate_hz),
        "still_frames": [1, still_frames],
        "wind_starts_about_frame": still_frames + 1,
        "subject_kind": "mannequin" if config.motion == "still" else "person",
        **TEMPLATE["session"],
        "fans": [_fan(config.fan)],
        "strands": [_strand(lock, rng) for lock in wig],
    }


def _fan(fan: Fan) -> dict[str, Any]:
    """The fan as it is set."""
    azimuth, elevation = np.radians(fan.azimuth_deg), np.radians(fan.elevation_deg)
    towards = -HEAD_ROTATION @ direction_from(azimuth, elevation)
    carried = {} if fan.azimuth_end_deg is None else {"to_azimuth_deg": fan.azimuth_end_deg}
    return {
        "from_azimuth_deg": fan.azimuth_deg,
        **carried,
        "from_elevation_deg": fan.elevation_deg,
        "speed_mps": fan.speed_mps,
        "program": fan.program,
        "blows_towards_world": [round(float(part), 3) for part in towards],
    }


def _strand(lock: Lock, rng: np.random.Generator) -> dict[str, Any]:
    """A lock as measured: places to about a millimeter, density to 3 %, width to 5 %."""
    distances_mm = lock.marker_distances_m * 1e3
    return {
        "strand": lock.name,
        "length_mm": _whole(lock.length_m * 1e3 + rng.normal(0, 1)),
        "linear_density_g_per_m": round(lock.linear_density * 1e3 * (1 + rng.normal(0, 0.03)), 2),
        "lock_width_mm": round(lock.width_m * 1e3 * (1 + rng.normal(0, 0.05)), 1),
        "root_mm": [_whole(x) for x in lock.root_m * 1e3 + rng.normal(0, 0.6, 3)],
        "markers": lock.marker_names,
        "marker_distance_from_root_mm": [
            _whole(x) for x in distances_mm + rng.normal(0, 0.8, len(distances_mm))
        ],
        "marker_mass_mg": _whole(lock.marker_masses_kg.mean() * 1e6),
    }


def _whole(value: float) -> float:
    return float(round(value))
