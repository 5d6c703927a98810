"""What the cameras make of the markers: noise, gaps, exchanged labels, ghosts; and the file of it."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from body import HEAD_POSITION_M, TEMPLATE, TURNING_POINT_M
from configurations import Cameras
from head_motion import HeadMotion
from locks import Lock

HEAD_MARKERS: dict[str, list[float]] = TEMPLATE["session"]["head_markers_mm_in_head_frame"]
HEAD_LABELS = list(HEAD_MARKERS)
HEAD = len(HEAD_LABELS)
"""Head markers come first, then the hair's."""
NECK_FOLLOWS = 0.4
"""Share of the head's turning that markers on the neck follow."""
NOISY_MARKERS = 6
"""Markers that have twice the noise of the others."""
SWAP_REACH_MM = 60
ALL_HEAD_GAPS_SECS = (2.2, 3.6)
ALL_HEAD_GAP_SECS = 0.25
HEAD_GAPS_SECS = {
    "NOSE": (2.6, 3.5),
    "LFHD": (1.2, 2.1),
    "RCHK": (3.9, 4.9),
    "JAW": (2.5, 3.2),
    "RFHD": (4.1, 4.6),
}


@dataclass(frozen=True)
class Recording:
    """What is exported of a capture, and what was done to it."""

    rate_hz: int
    labels: list[str]
    positions_mm: np.ndarray
    """(T, labels, 3) in the world; not a number where it is not seen."""
    visible: np.ndarray
    """(T, HEAD + M), whether a marker is seen, by true identity."""
    events: dict[str, list[dict[str, Any]]]
    """`label_swaps` and `ghosts`, with frames counted from 1."""

    def write_csv(self, path: Path) -> None:
        """Writes it as Vicon Nexus exports trajectories."""
        count = len(self.labels)
        lines = [
            "Trajectories",
            str(self.rate_hz),
            ",," + ",".join(f"{label},," for label in self.labels),
            "Frame,Sub Frame," + ",".join(["X,Y,Z"] * count),
            ",," + ",".join(["mm"] * 3 * count),
        ]
        for frame, row in enumerate(self.positions_mm, 1):
            cells = ("" if np.isnan(value) else f"{value:.6g}" for value in row.ravel().tolist())
            lines.append(f"{frame},0," + ",".join(cells))
        path.write_text("".join(f"{line}\r\n" for line in lines), encoding="ascii", newline="")


def head_markers_m(motion: HeadMotion, samples: list[int], rng: np.random.Generator) -> np.ndarray:
    """True places (T, HEAD, 3) of the head markers, head frame: half a millimeter off what was measured."""
    measured_m = np.array(list(HEAD_MARKERS.values())) / 1e3
    at_rest_m = measured_m + rng.normal(0, 0.0005, (HEAD, 3))
    places_m = np.repeat(at_rest_m[None], len(samples), 0)
    # Seen from the head, the neck stays behind by what it does not follow.
    turning = Rotation.from_matrix(motion.head_to_lab[samples]).as_rotvec()
    behind = Rotation.from_rotvec(turning * (NECK_FOLLOWS - 1))
    for label in ("LNCK", "RNCK"):
        k = HEAD_LABELS.index(label)
        places_m[:, k] = behind.apply(at_rest_m[k] - TURNING_POINT_M) + TURNING_POINT_M
    return places_m


class _Shot:
    """A recording in the making; every step draws from the same random numbers, so their order counts."""

    def __init__(
        self, true_mm: np.ndarray, wig: list[Lock], cameras: Cameras, rng: np.random.Generator
    ) -> None:
        self.true_mm, self.cameras, self.rng = true_mm, cameras, rng
        self.frames, self.count = true_mm.shape[:2]
        self.names = [name for lock in wig for name in lock.marker_names]
        self.lock_of = np.array([-1] * HEAD + [k for k, lock in enumerate(wig) for _ in lock.marker_names])
        noise_mm = np.full(self.count, cameras.noise_mm)
        noise_mm[rng.choice(self.count, NOISY_MARKERS, replace=False)] *= 2
        self.seen_mm = true_mm + rng.standard_normal(true_mm.shape) * noise_mm[None, :, None]
        self.visible = np.ones((self.frames, self.count), bool)

    def frames_of(self, frames_at_120_hz: int) -> int:
        """As many frames as last as long at the cameras' rate."""
        return max(2, round(frames_at_120_hz * (self.cameras.rate_hz / 120)))

    def open_gaps(self) -> None:
        """Hides markers until enough samples are missing."""
        rng, rate_hz = self.rng, self.cameras.rate_hz
        while 1 - self.visible.mean() < self.cameras.gaps:
            marker = rng.integers(self.count)
            length = self.frames_of(rng.integers(5, 61))
            first = rng.integers(0, self.frames - length // 2)
            # The head is seen better than hair is.
            if marker < HEAD and rng.random() < 0.5:
                continue
            self.visible[first : first + length, marker] = False
        if self.cameras.head_gaps:
            length = int(ALL_HEAD_GAP_SECS * rate_hz)
            for start_secs in ALL_HEAD_GAPS_SECS:
                first = int(start_secs * rate_hz)
                self.visible[first : first + length, :HEAD] = False
            for label, (start_secs, end_secs) in HEAD_GAPS_SECS.items():
                gap = slice(int(start_secs * rate_hz), int(end_secs * rate_hz))
                self.visible[gap, HEAD_LABELS.index(label)] = False

    def swap_labels(self, exported_mm: np.ndarray) -> list[dict[str, Any]]:
        """Exchanges pairs of markers of locks that pass near each other, for a while or to the end."""
        swaps: list[dict[str, Any]] = []
        used: set[int] = set()
        for _ in range(self.cameras.swaps):
            first, one, other = self._pair_to_swap(used)
            used |= {one, other}
            last = self.frames
            if self.rng.random() >= 0.3:
                last = min(last, first + self.frames_of(self.rng.integers(30, 150)))
            exported_mm[first:last, [one, other]] = exported_mm[first:last, [other, one]]
            a, b = self.names[one - HEAD], self.names[other - HEAD]
            swaps.append({"a": a, "b": b, "first_frame": int(first + 1), "last_frame": int(last)})
        return swaps

    def _pair_to_swap(self, used: set[int]) -> tuple[int, int, int]:
        """A frame, and two markers that are near each other then."""
        while True:
            first = self.rng.integers(self.cameras.rate_hz, self.frames - self.frames_of(60))
            one = int(self.rng.integers(HEAD, self.count))
            apart_mm = np.linalg.norm(self.true_mm[first] - self.true_mm[first, one], axis=1)
            apart_mm[(self.lock_of == self.lock_of[one]) | (self.lock_of < 0)] = np.inf
            other = int(np.argmin(apart_mm))
            if apart_mm[other] < SWAP_REACH_MM and not {one, other} & used:
                return first, one, other

    def ghosts(self) -> tuple[list[np.ndarray], list[dict[str, Any]]]:
        """Trajectories (T, 3) without a label: by turns a piece of a marker in its gap, and a reflection."""
        trajectories, events = [], []
        for number in range(self.cameras.ghosts):
            trajectory = np.full((self.frames, 3), np.nan)
            if number % 2 == 0:
                marker, piece = self._piece_in_gap()
                trajectory[piece] = self.seen_mm[piece, marker]
                event = {"kind": "unlabelled piece", "of": self.names[marker - HEAD]}
                first, last = piece[0], piece[-1]
            else:
                first, reflection_mm = self._reflection()
                last = first + len(reflection_mm) - 1
                trajectory[first : last + 1] = reflection_mm
                event = {"kind": "ghost"}
            events.append(event | {"first_frame": int(first + 1), "last_frame": int(last + 1)})
            trajectories.append(trajectory)
        return trajectories, events

    def _piece_in_gap(self) -> tuple[int, np.ndarray]:
        """A hair's marker, and the frames of its longest gap without the first and the last."""
        while True:
            marker = self.rng.integers(HEAD, self.count)
            missing = np.flatnonzero(~self.visible[:, marker])
            if len(missing) > 8:
                break
        gaps = np.split(missing, np.flatnonzero(np.diff(missing) > 1) + 1)
        return marker, max(gaps, key=len)[1:-1]

    def _reflection(self) -> tuple[int, np.ndarray]:
        """First frame and places (n, 3), mm, of something that drifts slowly near the head."""
        length = self.frames_of(self.rng.integers(8, 40))
        first = self.rng.integers(10, self.frames - length)
        place = HEAD_POSITION_M * 1e3 + self.rng.normal(0, 150, 3)
        noise = self.rng.normal(0, 0.5, (length, 3))
        return first, place + noise + np.arange(length)[:, None] * self.rng.normal(0, 0.8, 3)


def record(true_mm: np.ndarray, wig: list[Lock], cameras: Cameras, rng: np.random.Generator) -> Recording:
    """What the cameras see of markers that are at `true_mm` (T, HEAD + M, 3) in the world."""
    shot = _Shot(true_mm, wig, cameras, rng)
    shot.open_gaps()
    exported_mm = np.where(shot.visible[..., None], shot.seen_mm, np.nan)
    swaps = shot.swap_labels(exported_mm)
    trajectories, ghosts = shot.ghosts()
    return Recording(
        rate_hz=cameras.rate_hz,
        labels=[f"Wig:{name}" for name in HEAD_LABELS + shot.names]
        + [f"*{k + 1}" for k in range(len(ghosts))],
        positions_mm=np.concatenate([exported_mm] + [each[:, None] for each in trajectories], 1),
        visible=shot.visible,
        events={"label_swaps": swaps, "ghosts": ghosts},
    )
