"""The subject: head, neck and shoulders, and what a wig's roots need to know of them.

All places are in the head frame: origin in the middle of the head, x forward, y to the subject's left, z up;
meters.
"""

import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

TEMPLATE: dict[str, Any] = json.loads(Path(__file__).with_name("template.json").read_text(encoding="utf-8"))
_COLLIDERS = TEMPLATE["session"]["colliders"]

LOCK_RADIUS_M = 0.002
"""How far a lock's middle stays from what it touches."""

HEAD_HALF_AXES_M = np.array(_COLLIDERS["head_ellipsoid_half_axes_mm"]) / 1e3
TURNING_POINT_M = np.array([-0.02, 0.0, -0.11])
"""What the head turns about; the session says so in words."""

# The template is in single precision, so its rotation is made orthogonal again.
HEAD_ROTATION = Rotation.from_matrix(TEMPLATE["head_at_rest"]["rotation"]).as_matrix()
"""From the head frame at rest to the world."""
HEAD_POSITION_M = np.array(TEMPLATE["head_at_rest"]["position_m"])
"""Origin of the head frame at rest, in the world."""


class Capsule(NamedTuple):
    """All points within a radius of a line from a to b."""

    a: np.ndarray
    b: np.ndarray
    radius_m: float


def _capsule(words: dict[str, Any]) -> Capsule:
    return Capsule(np.array(words["a"]) / 1e3, np.array(words["b"]) / 1e3, words["radius"] / 1e3)


NECK = _capsule(_COLLIDERS["neck_capsule_mm"])
SHOULDERS = _capsule(_COLLIDERS["shoulders_capsule_mm"])


def unit(vector: np.ndarray) -> np.ndarray:
    """A vector's direction, of length 1."""
    return vector / np.linalg.norm(vector)


def smooth_step(x: np.ndarray) -> np.ndarray:
    """0 below 0, 1 above 1, and between them a rise that begins and ends without speed or acceleration."""
    x = np.clip(x, 0, 1)
    return x**3 * (10 - 15 * x + 6 * x * x)


def scalp_normal(point_m: np.ndarray) -> np.ndarray:
    """The direction out of the head at a point on or near it."""
    return unit(point_m / HEAD_HALF_AXES_M**2)


def on_scalp(point_m: np.ndarray) -> np.ndarray:
    """Where a lock has its root that lies nearest to a point: a lock's radius off the scalp."""
    below = point_m / np.linalg.norm(point_m / HEAD_HALF_AXES_M)
    return below + scalp_normal(below) * LOCK_RADIUS_M


def turned_off_body(point_m: np.ndarray, direction: np.ndarray, margin_m: float) -> np.ndarray:
    """A unit direction, turned so that who follows it from a point stays off the body by a margin.

    What goes into the body is taken off the more, the nearer the body is; a point inside is led out.
    """
    scaled = np.linalg.norm(point_m / (HEAD_HALF_AXES_M + margin_m))
    if scaled < 1.15:
        normal = scalp_normal(point_m)
        outwards = direction @ normal
        if outwards < 0:
            direction = direction - normal * outwards * min(1, (1.15 - scaled) / 0.1)
        if scaled < 1.0:
            direction = direction + 0.5 * normal
    for a, b, radius_m in (NECK, SHOULDERS):
        share = np.clip((point_m - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        normal = point_m - (a + share * (b - a))
        gap_m = np.linalg.norm(normal) - radius_m - margin_m
        if gap_m < 0.03:
            normal /= np.linalg.norm(normal)
            outwards = direction @ normal
            if outwards < 0:
                direction = direction - normal * outwards * min(1, (0.03 - gap_m) / 0.02)
            if gap_m < 0:
                direction = direction + 0.5 * normal
    return unit(direction)
