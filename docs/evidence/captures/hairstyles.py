"""The locks of the captured wig and of style B, drawn at random."""

import numpy as np

from body import HEAD_HALF_AXES_M, TEMPLATE, on_scalp
from configurations import Hair
from locks import Lock, natural_directions

GOLDEN_ANGLE_TIMES = np.pi * (1 + 5**0.5)
"""Points that turn by this from one to the next, and go down evenly, are spread evenly over a sphere."""


def wig_of(hair: Hair, rng: np.random.Generator) -> list[Lock]:
    """The captured wig: locks near those of the template, or some of them, with markers."""
    there = TEMPLATE["wig"]
    chosen = np.unique(np.round(np.linspace(0, len(there) - 1, hair.locks)).astype(int))
    stiffness = hair.stiffness * (1 if hair.curl_radii_m is None else 1.5)
    wig = []
    for number, which in enumerate(chosen, 1):
        like = there[which]
        root_m = on_scalp(np.array(like["root_m"]) + rng.normal(0, 0.002, 3))
        if hair.lengths_m is None:
            length_m = like["length_m"] * rng.uniform(0.9, 1.1)
        else:
            length_m = rng.uniform(*hair.lengths_m)
        density = rng.uniform(1.3e-3, 3.6e-3)
        width_m = 0.0050 * (density / 2e-3) ** 0.45 * rng.uniform(0.88, 1.12)
        bending = density * 1e-3 * rng.uniform(1.0, 1.9) * stiffness
        damping_secs = rng.uniform(0.013, 0.029)
        distances_m, masses_kg = _markers(length_m, hair.markers, rng)
        directions = natural_directions(root_m, length_m, rng, hair.curl_radii_m)
        lock = Lock(
            name=f"S{number:02d}",
            root_m=root_m,
            length_m=length_m,
            linear_density=density,
            bending_stiffness=bending,
            width_m=width_m,
            damping_secs=damping_secs,
            directions=directions,
            marker_distances_m=distances_m,
            marker_masses_kg=masses_kg,
        )
        wig.append(lock)
    return wig


def _markers(length_m: float, count: int | None, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Distances from the root, m, and masses, kg, of a lock's markers, the last of them near the tip."""
    if count is None:
        count = int(np.clip(round(length_m / 0.042 + rng.uniform(-0.8, 0.8)), 4, 10))
    first_m = min(0.16 * length_m, 0.05) + rng.uniform(0, 0.008)
    last_m = length_m - rng.uniform(0.003, 0.008)
    distances_m = np.linspace(first_m, last_m, count)
    spacing_m = distances_m[1] - distances_m[0]
    distances_m[1:-1] += rng.uniform(-0.12, 0.12, count - 2) * spacing_m
    masses_kg = np.clip(rng.lognormal(np.log(19e-6), 0.5, count), 5e-6, 40e-6)
    return distances_m, masses_kg


def style_b_of(hair: Hair, rng: np.random.Generator) -> list[Lock]:
    """The other hairstyle: locks spread over the scalp, without markers."""
    style = []
    none = np.empty(0)
    for number, near_m in enumerate(_spread_over_scalp(hair.locks, rng), 1):
        root_m = on_scalp(near_m + rng.normal(0, 0.003, 3))
        length_m = rng.uniform(*hair.lengths_m)
        density = rng.uniform(0.8e-3, 3.8e-3)
        width_m = 0.0043 * (density / 1.6e-3) ** 0.42 * rng.uniform(0.85, 1.18)
        bending = density * 1e-3 * np.exp(rng.uniform(np.log(0.55), np.log(3.2))) * hair.stiffness
        damping_secs = rng.uniform(0.012, 0.028)
        # Half of the locks of a curly style are curly.
        curly = hair.curl_radii_m is not None and rng.random() < 0.5
        directions = natural_directions(root_m, length_m, rng, hair.curl_radii_m if curly else None)
        lock = Lock(
            name=f"B{number:02d}",
            root_m=root_m,
            length_m=length_m,
            linear_density=density,
            bending_stiffness=bending,
            width_m=width_m,
            damping_secs=damping_secs,
            directions=directions,
            marker_distances_m=none,
            marker_masses_kg=none,
        )
        style.append(lock)
    return style


def _spread_over_scalp(count: int, rng: np.random.Generator) -> np.ndarray:
    """Points (count, 3) on the head ellipsoid, m, spread evenly over where hair grows."""
    steps = np.arange(400)
    height = 1 - 1.4 * ((steps + 0.5) / 400)
    angle = GOLDEN_ANGLE_TIMES * steps + rng.uniform(0, 6.28)
    level = np.sqrt(1 - height * height)
    points_m = np.c_[level * np.cos(angle), level * np.sin(angle), height] * HEAD_HALF_AXES_M
    x, z = points_m[:, 0], points_m[:, 2]
    points_m = points_m[(z > -0.035) & ((x < 0.035) | ((z > 0.06) & (x < 0.06)))]
    return points_m[np.round(np.linspace(0, len(points_m) - 1, count)).astype(int)]
