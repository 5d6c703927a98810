"""A lock of hair: what it is made of, and the shape it has by nature."""

from dataclasses import dataclass

import numpy as np

from body import scalp_normal, smooth_step, turned_off_body, unit

STICK_M = 0.016
"""Length of the sticks that the engine makes a lock of, about."""
STEP_M = 0.002
DOWN = np.array([0.0, 0.0, -1.0])


@dataclass(frozen=True)
class Lock:
    """A lock with its natural shape; lengths and places in m, the rest in SI units."""

    name: str
    root_m: np.ndarray
    length_m: float
    linear_density: float
    """kg/m."""
    bending_stiffness: float
    """N m^2."""
    width_m: float
    damping_secs: float
    """Ratio of internal damping to stiffness."""
    directions: np.ndarray
    """Directions (n, 3) of its sticks, of equal length, when no force acts."""
    marker_distances_m: np.ndarray
    """Of its markers, from the root along the lock; ascending."""
    marker_masses_kg: np.ndarray

    @property
    def stick_m(self) -> float:
        """Length of a stick."""
        return self.length_m / len(self.directions)

    @property
    def marker_names(self) -> list[str]:
        """Names of its markers, from the root."""
        return [f"{self.name}_{k + 1}" for k in range(len(self.marker_distances_m))]

    def spaced_distances_m(self) -> np.ndarray:
        """Distances of evenly spaced control points about 19 mm apart, root and tip included."""
        return np.linspace(0, self.length_m, max(6, round(self.length_m / 0.019)) + 1)

    def places_m(self, nodes_m: np.ndarray, distances_m: np.ndarray) -> np.ndarray:
        """Places (T, S, 3) at distances (S) along it when its sticks' ends are at `nodes_m` (T, n + 1, 3)."""
        stick = np.minimum((distances_m / self.stick_m).astype(int), nodes_m.shape[1] - 2)
        share = (distances_m / self.stick_m - stick)[None, :, None]
        return nodes_m[:, stick] * (1 - share) + nodes_m[:, stick + 1] * share


def carried_across(directions: np.ndarray, first: np.ndarray) -> np.ndarray:
    """For each of a row of directions (n, 3) a unit vector across it, carried from `first` without twist."""
    across = np.empty_like(directions)
    vector = first
    for k, direction in enumerate(directions):
        vector = unit(vector - direction * (vector @ direction))
        across[k] = vector
    return across


def natural_directions(
    root_m: np.ndarray, length_m: float, rng: np.random.Generator, curl_radii_m: tuple[float, float] | None
) -> np.ndarray:
    """Directions (n, 3) of a lock's sticks when no force acts, drawn at random.

    It leaves the scalp between upright and flat, bends down and outwards round the body, and coils a little
    about that way, or with the radii that are given.
    """
    outwards = _outwards(root_m, rng)
    normal = scalp_normal(root_m)
    flat = DOWN + 0.6 * outwards
    flat = unit(flat - normal * (flat @ normal))
    upright = rng.uniform(0.35, 0.75)
    start = unit(normal * upright + flat * (1 - upright) + 0.1 * rng.standard_normal(3))
    goal = unit(DOWN + rng.uniform(0.15, 0.6) * outwards + 0.15 * rng.standard_normal(3))
    if curl_radii_m is None:
        radius_m, pitch_m = rng.uniform(0.003, 0.010), rng.uniform(0.10, 0.22)
    else:
        radius_m, pitch_m = rng.uniform(*curl_radii_m), rng.uniform(0.09, 0.15)
    bending = rng.uniform(6, 12)
    # A coil is longer than the way it winds about, so that goes on beyond the lock's length.
    steps = int(1.6 * length_m / STEP_M)
    way_m, directions = _way(root_m, start, goal, steps, bending, radius_m + 0.004)
    coil_m = _coil(way_m, directions, radius_m, pitch_m, rng)

    lengths_m = np.linalg.norm(np.diff(coil_m, axis=0), axis=1)
    distances_m = np.r_[0, np.cumsum(lengths_m)]
    sticks = int(np.clip(round(length_m / STICK_M), 6, 20))
    at_m = np.linspace(0, length_m, sticks + 1)
    nodes_m = np.array([np.interp(at_m, distances_m, coil_m[:, c]) for c in range(3)]).T
    chords_m = np.diff(nodes_m, axis=0)
    return chords_m / np.linalg.norm(chords_m, axis=1)[:, None]


def _outwards(root_m: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """The level direction that a lock falls to: off the head's axis, from the crown to the back or a side."""
    level = root_m * [1, 1, 0]
    outwards = unit(level) if np.linalg.norm(level) > 0.02 else np.array([-1.0, 0.0, 0.0])
    if root_m[2] > 0.06 and np.linalg.norm(root_m[:2]) < 0.05:
        outwards = unit(outwards + np.array([-0.4, 0, 0]) + 0.4 * rng.standard_normal(3) * [1, 1, 0])
    return outwards


def _way(
    root_m: np.ndarray, start: np.ndarray, goal: np.ndarray, steps: int, bending: float, margin_m: float
) -> tuple[np.ndarray, np.ndarray]:
    """Points and directions (steps + 1, 3) of a way off the body that turns to a goal, `bending` a meter."""
    point_m, direction = root_m, start
    points_m, directions = [point_m], [direction]
    for _ in range(steps):
        direction = direction + STEP_M * bending * (goal - direction)
        direction = turned_off_body(point_m + STEP_M * direction, unit(direction), margin_m)
        point_m = point_m + STEP_M * direction
        points_m.append(point_m)
        directions.append(direction)
    return np.array(points_m), np.array(directions)


def _coil(
    way_m: np.ndarray, directions: np.ndarray, radius_m: float, pitch_m: float, rng: np.random.Generator
) -> np.ndarray:
    """Points of an irregular coil about a way; it begins on the way and reaches its radius after 5 cm."""
    along_m = np.arange(len(way_m)) * STEP_M
    turns = 2 * np.pi * along_m / pitch_m * rng.choice([-1, 1]) + rng.uniform(0, 6.28)
    knots_m = np.linspace(0, along_m[-1], 8)
    phase = turns + 0.5 * np.interp(along_m, knots_m, rng.standard_normal(8))
    across = carried_across(directions, np.cross(directions[0], [0.3, 0.9, 0.1]))
    other = np.cross(directions, across)
    radii_m = radius_m * smooth_step((along_m - 0.004) / 0.05)[:, None]
    return way_m + radii_m * (np.cos(phase)[:, None] * across + np.sin(phase)[:, None] * other)
