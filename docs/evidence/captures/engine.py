"""Locks simulated by MuJoCo as chains of sticks, in the head frame.

The scalp stands still: gravity and the inertial forces of the moving head are applied to every stick. When
the head turns, the torso is a heavy free body whose pose and velocity are set at each step. Locks do not
touch each other.
"""

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from body import HEAD_HALF_AXES_M, LOCK_RADIUS_M, NECK, SHOULDERS, Capsule
from forces import MASS_UNITS_PER_KG, apply_forces, middles
from head_motion import STEP_SECS, HeadMotion
from locks import Lock, carried_across
from wind import Wind

SETTLING_SECS = 2.6
WIND_EVERY_STEPS = 4
"""The wind changes slowly enough to be looked up anew only so often."""
TORSO_KG = 50

# Elliptic cones and stiff contacts: by default the engine lets sliding hair creep and sink in.
_HEADER = f"""<mujoco>
<compiler angle="radian" autolimits="true" inertiafromgeom="false" boundmass="0" boundinertia="0"/>
<option timestep="{STEP_SECS:.12g}" integrator="implicitfast" gravity="0 0 0" cone="elliptic" impratio="10"
 jacobian="sparse" solver="Newton" iterations="30" tolerance="1e-9"/>
<size memory="400M"/>
<default><geom friction=".25 0 0" condim="3" solref=".006 1" solimp=".9 .97 .0006"/></default>
<worldbody>"""


class DivergedError(RuntimeError):
    """The simulation has come to numbers that are none."""


def _numbers(values: np.ndarray) -> str:
    return " ".join(f"{value:.9g}" for value in values)


def _capsule(capsule: Capsule) -> str:
    return (
        f'<geom type="capsule" fromto="{_numbers(capsule.a)} {_numbers(capsule.b)}" size="{capsule.radius_m}"'
        f' contype="1" conaffinity="0" mass="{TORSO_KG * MASS_UNITS_PER_KG}"/>'
    )


def _body(free_torso: bool) -> str:
    head = f'<geom type="ellipsoid" size="{_numbers(HEAD_HALF_AXES_M)}" contype="1" conaffinity="0"/>'
    shoulders = _capsule(SHOULDERS)
    if free_torso:
        unit = MASS_UNITS_PER_KG
        shoulders = (
            f'<body><freejoint/><inertial pos="0 0 0" mass="{TORSO_KG * unit}"'
            f' diaginertia="{unit} {unit} {unit}"/>'
            f"{shoulders}</body>"
        )
    return head + _capsule(NECK) + shoulders


class _Sticks:
    """What the sticks of some locks are, lock after lock from the root, and the engine's words for them."""

    def __init__(self, locks: list[Lock]) -> None:
        self.lengths_m: list[float] = []
        self.masses: list[float] = []
        self.gyration_m: list[float] = []
        self.widths_m: list[float] = []
        self.of_lock: list[slice] = []
        self.xml = ""
        for lock in locks:
            first = len(self.lengths_m)
            self._add(lock)
            self.of_lock.append(slice(first, len(self.lengths_m)))

    def _add(self, lock: Lock) -> None:
        frames = _frames(lock.directions)
        stick_m, count = lock.stick_m, len(lock.directions)
        stiffness = MASS_UNITS_PER_KG * lock.bending_stiffness / stick_m
        on_stick = np.minimum((lock.marker_distances_m / stick_m).astype(int), count - 1)
        for j in range(count):
            here = on_stick == j
            markers = [
                (distance_m - j * stick_m, kg)
                for distance_m, kg in zip(
                    lock.marker_distances_m[here], lock.marker_masses_kg[here], strict=True
                )
            ]
            mass_kg, center_m, across, along = _inertia(lock, markers)
            # A joint stands for half a stick to either side; the clamped root has its half only.
            joint_stiffness = stiffness * (2 if j == 0 else 1)
            place = lock.root_m if j == 0 else np.array([stick_m, 0, 0])
            turn = frames[j] if j == 0 else frames[j - 1].T @ frames[j]
            quaternion = Rotation.from_matrix(turn).as_quat()[[3, 0, 1, 2]]
            inertia = np.array([along, across, across]) * MASS_UNITS_PER_KG
            # The first stick starts in the scalp and cannot touch it.
            shape = "" if j == 0 else _stick_shape(stick_m)
            self.xml += (
                f'<body pos="{_numbers(place)}" quat="{_numbers(quaternion)}">'
                f'<inertial pos="{center_m:.9g} 0 0" mass="{mass_kg * MASS_UNITS_PER_KG:.9g}"'
                f' diaginertia="{_numbers(inertia)}"/>'
                f'<joint type="ball" stiffness="{joint_stiffness:.9g}"'
                f' damping="{joint_stiffness * lock.damping_secs:.9g}"/>{shape}'
            )
            self.lengths_m.append(stick_m)
            self.masses.append(mass_kg * MASS_UNITS_PER_KG)
            self.gyration_m.append(np.sqrt(across / mass_kg))
            self.widths_m.append(lock.width_m)
        self.xml += "</body>" * count


def _stick_shape(stick_m: float) -> str:
    return (
        f'<geom type="capsule" fromto="0 0 0 {stick_m:.8g} 0 0" size="{LOCK_RADIUS_M}"'
        ' contype="0" conaffinity="1"/>'
    )


def _inertia(lock: Lock, markers: list[tuple[float, float]]) -> tuple[float, float, float, float]:
    """Of a stick: mass, kg, center of mass from its start, m, moments of inertia across and along, kg m^2.

    `markers` are on it: distance from its start, m, and mass, kg.
    """
    stick_m = lock.stick_m
    bare_kg = lock.linear_density * stick_m
    mass_kg, moment = bare_kg, bare_kg * stick_m / 2
    for at_m, kg in markers:
        mass_kg += kg
        moment += kg * at_m
    center_m = moment / mass_kg
    across = (
        bare_kg * stick_m * stick_m / 12
        + bare_kg * (stick_m / 2 - center_m) ** 2
        + sum(kg * (at_m - center_m) ** 2 for at_m, kg in markers)
    )
    along = mass_kg * (lock.width_m / 2) ** 2 / 2
    return mass_kg, center_m, across, along


def _frames(directions: np.ndarray) -> np.ndarray:
    """Rotation matrices (n, 3, 3) with x along directions (n, 3), carried on without twist."""
    first = np.cross(directions[0], [0.1, 0.3, 0.95])
    if np.linalg.norm(first) < 0.1:
        first = np.cross(directions[0], [0.9, 0.3, 0.1])
    across = carried_across(directions, first)
    return np.stack([directions, across, np.cross(directions, across)], -1)


class Simulation:
    """Some locks in a wind, on a head that moves. Few locks at a time take less time in all."""

    def __init__(self, locks: list[Lock], motion: HeadMotion, wind: Wind) -> None:
        self._motion, self._wind = motion, wind
        sticks = _Sticks(locks)
        xml = f"{_HEADER}{_body(motion.turns)}{sticks.xml}</worldbody></mujoco>"
        self._model = mujoco.MjModel.from_xml_string(xml)
        self._data = mujoco.MjData(self._model)
        self._of_lock = sticks.of_lock
        self._lengths_m = np.array(sticks.lengths_m)
        self._masses = np.array(sticks.masses)
        self._gyration_m = np.array(sticks.gyration_m)
        self._widths_m = np.array(sticks.widths_m)
        self._middles_m = np.zeros((len(self._lengths_m), 3))
        self._air_mps = np.zeros((len(self._lengths_m), 3))

        first = self._model.nbody - len(self._lengths_m)
        self._tree_of = self._model.body_rootid[first:].copy()
        # Views of the engine's own memory, taken once, as taking them costs more than a step's forces.
        data = self._data
        self._starts, self._centers, self._axes = data.xpos[first:], data.xipos[first:], data.xmat[first:]
        self._spatial_velocities, self._tree_centers = data.cvel[first:], data.subtree_com
        self._applied = data.xfrc_applied[first:]
        self._positions, self._velocities = data.qpos, data.qvel

    def settle(self) -> None:
        """Lets the locks come to rest under gravity from their natural shape, first as in syrup."""
        step_secs = STEP_SECS * 2
        steps = int(SETTLING_SECS / step_secs)
        self._model.opt.timestep = step_secs
        for k in range(steps):
            share = k / steps
            gravity = min(1, share / 0.25 + 0.1)
            viscous_rate = 8 * max(0, 1 - max(0, share - 0.6) / 0.3)
            self._step(0.0, k, gravity, viscous_rate, in_air=share > 0.85)
        self._model.opt.timestep = STEP_SECS

    def run(self, rate_hz: int, secs: float) -> list[np.ndarray]:
        """Places (T, n + 1, 3) of the ends of each lock's sticks, m, at a rate."""
        steps_a_frame = round(1 / rate_hz / STEP_SECS)
        frames = []
        self._data.time = 0
        for frame in range(int(secs * rate_hz)):
            frames.append(self._nodes_m())
            for k in range(frame * steps_a_frame, (frame + 1) * steps_a_frame):
                self._step(k * STEP_SECS, k)
            if not np.isfinite(self._positions).all():
                raise DivergedError(f"the simulation diverged at {frame / rate_hz:.2f} s")
        return [np.array(nodes) for nodes in zip(*frames, strict=True)]

    def _step(
        self, secs: float, k: int, gravity: float = 1.0, viscous_rate: float = 0.0, in_air: bool = True
    ) -> None:
        motion, i = self._motion, self._motion.index(secs)
        if motion.turns:
            self._positions[:3] = motion.torso_position_m[i]
            self._positions[3:7] = motion.torso_quaternion_wxyz[i]
            self._velocities[:3] = motion.torso_velocity[i]
            self._velocities[3:6] = motion.torso_own_angular_velocity[i]
        mujoco.mj_step1(self._model, self._data)
        if in_air and k % WIND_EVERY_STEPS == 0:
            middles(self._starts, self._axes, self._lengths_m, self._middles_m)
            self._air_mps = self._wind.at(self._middles_m, secs)
        apply_forces(
            self._starts,
            self._centers,
            self._axes,
            self._spatial_velocities,
            self._tree_centers,
            self._tree_of,
            self._lengths_m,
            self._masses,
            self._gyration_m,
            self._widths_m,
            self._air_mps,
            motion.head_gravity[i] * gravity,
            motion.head_velocity[i],
            motion.head_acceleration[i],
            motion.head_angular_velocity[i],
            motion.head_angular_acceleration[i],
            motion.moves,
            float(viscous_rate),
            in_air,
            self._applied,
        )
        mujoco.mj_step2(self._model, self._data)

    def _nodes_m(self) -> list[np.ndarray]:
        """Where the ends of each lock's sticks are now."""
        mujoco.mj_kinematics(self._model, self._data)
        ends = self._starts + self._axes[:, [0, 3, 6]] * self._lengths_m[:, None]
        return [np.vstack([self._starts[lock], ends[lock.stop - 1]]) for lock in self._of_lock]
