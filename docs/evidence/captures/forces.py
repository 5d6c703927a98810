"""Weight, inertia and the air's force on every stick of every lock.

Compiled, as they are needed for some hundred sticks at each of ten thousand steps; but without leave to
reorder sums (`fastmath`): hair that touches the body makes tenths of a millimeter of a rounding.
"""

import numpy as np
from numba import njit

MASS_UNITS_PER_KG = 1e4
"""The engine's unit of mass is so small that its guards against tiny numbers stay out of the way of hair."""
AIR_DENSITY_KG_M3 = 1.2
AIR_VISCOSITY_M2_S = 1.5e-5
DRAG_ALONG = 0.08
"""Coefficient Ct of the drag along a lock."""


@njit
def middles(starts, axes, lengths_m, out):
    """Writes the middles (N, 3) of sticks to `out`; `axes` are rotation matrices with x along a stick."""
    for n in range(len(lengths_m)):
        for c in range(3):
            out[n, c] = starts[n, c] + axes[n, 3 * c] * lengths_m[n] / 2


@njit
def _cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@njit
def _plus_cross(a, b, c):
    """a + b x c: the velocity at c of what moves with a and spins with b."""
    return (
        a[0] + b[1] * c[2] - b[2] * c[1],
        a[1] + b[2] * c[0] - b[0] * c[2],
        a[2] + b[0] * c[1] - b[1] * c[0],
    )


@njit
def _plus(a, b):
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@njit
def _minus(a, b):
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@njit
def _times(a, factor):
    return a[0] * factor, a[1] * factor, a[2] * factor


@njit
def _row(rows, n):
    return rows[n, 0], rows[n, 1], rows[n, 2]


@njit
def _three(vector):
    return vector[0], vector[1], vector[2]


@njit
def _drag(wind, axis, width_m, length_m):
    """The air's force on a stick, in the engine's units, in a wind as the stick feels it.

    The law is that of the captures' truth: `drag` in truth.json.
    """
    along = wind[0] * axis[0] + wind[1] * axis[1] + wind[2] * axis[2]
    across = _minus(wind, _times(axis, along))
    speed = np.sqrt(across[0] * across[0] + across[1] * across[1] + across[2] * across[2])
    reynolds = max(speed, 1e-6) * width_m / AIR_VISCOSITY_M2_S
    scale = 0.5 * AIR_DENSITY_KG_M3 * width_m * length_m * MASS_UNITS_PER_KG
    across_factor = scale * (1 + 10 * reynolds ** (-2 / 3)) * speed
    along_factor = scale * np.pi * DRAG_ALONG * abs(along) * along
    return _plus(_times(across, across_factor), _times(axis, along_factor))


@njit
def apply_forces(
    starts,
    centers,
    axes,
    spatial_velocities,
    tree_centers,
    tree_of,
    lengths_m,
    masses,
    gyration_m,
    widths_m,
    wind,
    gravity,
    head_velocity,
    head_acceleration,
    head_angular_velocity,
    head_angular_acceleration,
    head_moves,
    viscous_rate,
    in_air,
    out,
):
    """Writes force and torque about the center of mass (N, 6) of sticks to `out`, in head axes.

    `starts`, `centers` (of mass), `axes`, `spatial_velocities` (angular, then linear at the center of the
    whole tree) and `tree_centers` are the engine's own arrays, `masses` in its units. Everything of the
    head is in its own axes, SI units. `viscous_rate`, 1/s, is a resistance to all motion, and without
    `in_air` there is no air.

    A stick's mass counts as two points at its radius of gyration to both sides of its center: for a thin
    stick, force and torque of all fields that change linearly along it are then exact.
    """
    spin, turning = _three(head_angular_velocity), _three(head_angular_acceleration)
    for n in range(len(lengths_m)):
        axis = (axes[n, 0], axes[n, 3], axes[n, 6])
        center = _row(centers, n)
        tree_center = _row(tree_centers, tree_of[n])
        angular = _row(spatial_velocities, n)
        linear = (spatial_velocities[n, 3], spatial_velocities[n, 4], spatial_velocities[n, 5])
        force, torque = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for side in (-1.0, 1.0):
            arm = _times(axis, side * gyration_m[n])
            point = _plus(center, arm)
            velocity = _plus_cross(linear, angular, _minus(point, tree_center))
            acceleration = _minus(_three(gravity), _times(velocity, viscous_rate))
            if head_moves:
                # Coriolis and centrifugal force share a cross product with the head's spin.
                turned = _plus_cross(_times(velocity, 2.0), spin, point)
                felt = _plus_cross(_three(head_acceleration), turning, point)
                acceleration = _minus(acceleration, _plus_cross(felt, spin, turned))
            push = _times(acceleration, masses[n] / 2)
            force = _plus(force, push)
            torque = _plus(torque, _cross(arm, push))
        if in_air:
            point = _plus(_row(starts, n), _times(axis, lengths_m[n] / 2))
            velocity = _plus_cross(linear, angular, _minus(point, tree_center))
            if head_moves:
                velocity = _plus(velocity, _plus_cross(_three(head_velocity), spin, point))
            push = _drag(_minus(_row(wind, n), velocity), axis, widths_m[n], lengths_m[n])
            force = _plus(force, push)
            torque = _plus(torque, _cross(_minus(point, center), push))
        out[n, 0], out[n, 1], out[n, 2] = force
        out[n, 3], out[n, 4], out[n, 5] = torque
