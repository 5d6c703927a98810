"""The subject's motion, sampled finely, and what of it locks in the head frame feel."""

import numpy as np
from scipy.spatial.transform import Rotation

from body import HEAD_POSITION_M, HEAD_ROTATION, TURNING_POINT_M, smooth_step
from configurations import DURATION_SECS, MotionKind

GRAVITY_MPS2 = 9.81
STEP_SECS = 1 / 1920
"""The engine's time step."""
SAMPLE_SECS = STEP_SECS / 2
FIRST_SECS = -0.02
"""Samples go a little beyond the capture at both ends, as derivatives are poor at the outermost."""

WALK_FROM_SECS, WALK_SPEED_MPS, WALK_M, WALK_RISE_SECS = 1.5, 0.7, 1.0, 0.5
WALK_BOB_M, WALK_BOB_HZ = 0.01, 2
SHAKE_FROM_SECS, SHAKE_RISE_SECS = 1.4, 0.5


def _rate(samples: np.ndarray) -> np.ndarray:
    """Derivative by time, by central differences."""
    return np.gradient(samples, SAMPLE_SECS, axis=0)


def _into(rotations: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Vectors (T, 3) turned by the inverses of rotations (T, 3, 3)."""
    return np.einsum("tji,tj->ti", rotations, vectors)


def _shake(t: np.ndarray) -> Rotation:
    """The head's turning, from the head frame to the head frame at rest, when it shakes, nods and rolls."""
    rise = smooth_step((t - SHAKE_FROM_SECS) / SHAKE_RISE_SECS)
    since = t - SHAKE_FROM_SECS
    yaw = np.radians(40) * np.sin(2 * np.pi * 0.8 * since) * rise
    pitch = np.radians(12) * np.sin(2 * np.pi * 0.55 * since) * rise
    roll = np.radians(4) * np.sin(2 * np.pi * 1.1 * since + 1) * rise
    return Rotation.from_euler("ZYX", np.c_[yaw, pitch, roll])


def _walk(t: np.ndarray) -> np.ndarray:
    """The subject's way in the world (T, 3), m, when it walks forward and bobs up and down."""
    start = smooth_step((t - WALK_FROM_SECS) / WALK_RISE_SECS)
    stop = smooth_step((t - WALK_FROM_SECS - WALK_M / WALK_SPEED_MPS) / WALK_RISE_SECS)
    way = np.cumsum(WALK_SPEED_MPS * start * (1 - stop)) * SAMPLE_SECS
    way -= np.interp(0, t, way)
    forward = HEAD_ROTATION[:, 0].copy()
    forward[2] = 0
    forward /= np.linalg.norm(forward)
    bob = WALK_BOB_M * np.sin(2 * np.pi * WALK_BOB_HZ * (t - WALK_FROM_SECS)) * (start * (1 - stop))
    return way[:, None] * forward + np.c_[np.zeros_like(t), np.zeros_like(t), bob]


class HeadMotion:
    """Poses of head and torso at times `secs`, with velocities and accelerations.

    Names say the axes: `world_`, `head_` (the moving head's), `lab_` (those of the head at rest).
    """

    def __init__(self, kind: MotionKind) -> None:
        count = int((DURATION_SECS + 0.1) / SAMPLE_SECS) + 1
        self.secs = np.arange(count) * SAMPLE_SECS + FIRST_SECS
        self.moves = kind != "still"
        self.turns = kind == "shake"
        self.walks = kind == "walk"
        turning = _shake(self.secs) if self.turns else Rotation.from_rotvec(np.zeros((count, 3)))
        way_m = _walk(self.secs) if self.walks else np.zeros((count, 3))

        self.head_to_lab = turning.as_matrix()
        self.rotation = HEAD_ROTATION @ self.head_to_lab
        turned_m = (TURNING_POINT_M - self.head_to_lab @ TURNING_POINT_M) @ HEAD_ROTATION.T
        self.position_m = HEAD_POSITION_M + turned_m + way_m
        self.world_velocity = _rate(self.position_m)
        spin = _rate(self.rotation) @ self.rotation.transpose(0, 2, 1)
        # Twice the antisymmetric part: of numeric derivatives the other is not quite 0.
        twice = (
            spin[:, 2, 1] - spin[:, 1, 2],
            spin[:, 0, 2] - spin[:, 2, 0],
            spin[:, 1, 0] - spin[:, 0, 1],
        )
        self.world_angular_velocity = np.stack(twice, 1) / 2

        self.head_velocity = _into(self.rotation, self.world_velocity)
        self.head_acceleration = _into(self.rotation, _rate(self.world_velocity))
        self.head_angular_velocity = _into(self.rotation, self.world_angular_velocity)
        self.head_angular_acceleration = _into(self.rotation, _rate(self.world_angular_velocity))
        self.head_gravity = _into(self.rotation, np.tile([0, 0, -GRAVITY_MPS2], (count, 1)))
        self.lab_position_m = np.einsum("ji,tj->ti", HEAD_ROTATION, self.position_m - HEAD_POSITION_M)
        self.lab_velocity = np.einsum("ji,tj->ti", HEAD_ROTATION, self.world_velocity)
        self._add_torso(way_m)

    def _add_torso(self, way_m: np.ndarray) -> None:
        """The torso, which walks but does not turn, seen from the head frame; its spin is in its own axes."""
        rotation = self.rotation.transpose(0, 2, 1) @ HEAD_ROTATION
        self.torso_position_m = _into(self.rotation, HEAD_POSITION_M + way_m - self.position_m)
        self.torso_velocity = _rate(self.torso_position_m)
        spin = _rate(rotation) @ rotation.transpose(0, 2, 1)
        angular_velocity = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], 1)
        self.torso_own_angular_velocity = _into(rotation, angular_velocity)
        self.torso_quaternion_wxyz = Rotation.from_matrix(rotation).as_quat()[:, [3, 0, 1, 2]]

    def index(self, secs: float) -> int:
        """The sample at a time."""
        return min(max(round((secs - FIRST_SECS) / SAMPLE_SECS), 0), len(self.secs) - 1)
