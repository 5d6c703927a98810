"""What nobody in the room could know, for judging: the files of `truth/`, and `style_b.json`."""

from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from body import HEAD_HALF_AXES_M
from cameras import HEAD_LABELS, Recording
from configurations import DURATION_SECS, Config
from forces import AIR_DENSITY_KG_M3, AIR_VISCOSITY_M2_S
from head_motion import HeadMotion
from locks import Lock
from wind import Wind

SIMULATED_HZ = 120
CURVES_HZ = 60
FIELD_HZ = 30
VOXELS, VOXEL_M, CUBE_FROM_M = 30, 0.02, -0.3
"""The cube that the wind is stored in: voxels a side, their edge, and where it begins along each axis."""
LEAST_QUANTUM_MPS = 0.04
"""The wind is stored in whole multiples of a speed, at least of this one."""
ALONG_HAIR_M = 0.005

DRAG_LAW = (
    "per length: 0.5*rho*d*(Cn*|wn|*wn + pi*Ct*|wt|*wt), w = air minus lock velocity, "
    "n / t = across / along the lock; Cn = 1 + 10*Re^(-2/3), Re = |wn|*d/nu; Ct = 0.08"
)
STYLE_B_NOTE = (
    "another hairstyle for the same wind. Rest curves hang still under gravity; metres, head frame, "
    "root first. Control points are evenly spaced along each lock."
)


def write_head(path: Path, motion: HeadMotion, times_secs: np.ndarray, samples: list[int]) -> None:
    """The head's poses and velocities in the world."""
    _write(
        path,
        t=times_secs,
        R=motion.rotation[samples],
        p=motion.position_m[samples],
        v=motion.world_velocity[samples],
        w=motion.world_angular_velocity[samples],
    )


def write_curves(path: Path, locks: list[Lock], nodes_m: list[np.ndarray]) -> list[np.ndarray]:
    """Where control points of locks go, simulated at SIMULATED_HZ; returns them, m, (T, n, 3) a lock."""
    every = SIMULATED_HZ // CURVES_HZ
    curves_m = [
        lock.places_m(nodes[::every], lock.spaced_distances_m())
        for lock, nodes in zip(locks, nodes_m, strict=True)
    ]
    counts = np.array([curve.shape[1] for curve in curves_m], np.int32)
    _write(path, t=np.arange(len(curves_m[0])) / CURVES_HZ, pos=np.concatenate(curves_m, 1), counts=counts)
    return curves_m


def style_b_facts(locks: list[Lock], curves_m: list[np.ndarray]) -> dict[str, Any]:
    """`style_b.json`: rest curves and properties of the other hairstyle."""
    strands = [
        {
            "name": lock.name,
            "length_m": round(lock.length_m, 5),
            "linear_density_kg_per_m": round(lock.linear_density, 7),
            "bending_stiffness_N_m2": float(f"{lock.bending_stiffness:.3e}"),
            "lock_width_m": round(lock.width_m, 6),
            "internal_damping_time_s": round(lock.damping_secs, 4),
            "rest_curve_m": np.round(curve[0], 5).tolist(),
        }
        for lock, curve in zip(locks, curves_m, strict=True)
    ]
    return {"note": STYLE_B_NOTE, "strands": strands}


def write_field(path: Path, wind: Wind, wig: list[Lock], nodes_m: list[np.ndarray]) -> None:
    """The true wind on the cube, and where the wig has hair."""
    times_secs = np.arange(int(DURATION_SECS * FIELD_HZ)) / FIELD_HZ
    cube = (VOXELS,) * 3
    axis_m = CUBE_FROM_M + VOXEL_M / 2 + VOXEL_M * np.arange(VOXELS)
    centers_m = np.stack(np.meshgrid(axis_m, axis_m, axis_m, indexing="ij"), -1).reshape(-1, 3)
    solid = (np.linalg.norm(centers_m / HEAD_HALF_AXES_M, axis=1) < 1).reshape(cube)
    air_mps = np.stack([wind.at(centers_m, secs).T.reshape(3, *cube) for secs in times_secs])
    air_mps = np.where(solid, 0, air_mps)
    scale = np.float32(max(LEAST_QUANTUM_MPS, np.abs(air_mps).max() / 126))
    quanta = np.clip(np.round(air_mps / scale), -127, 127).astype(np.int8)

    hair = np.zeros((len(times_secs), *cube), np.uint8)
    for lock, nodes in zip(wig, nodes_m, strict=True):
        along_m = np.linspace(0, lock.length_m, int(lock.length_m / ALONG_HAIR_M))
        places_m = lock.places_m(nodes[:: SIMULATED_HZ // FIELD_HZ], along_m)
        voxels = np.floor((places_m - CUBE_FROM_M) / VOXEL_M).astype(int)
        inside = ((voxels >= 0) & (voxels < VOXELS)).all(2)
        frames = np.broadcast_to(np.arange(len(times_secs))[:, None], inside.shape)
        x, y, z = voxels[inside].T
        hair[frames[inside], x, y, z] = 1
    _write(path, t=times_secs, scale=scale, u_q=quanta, solid=solid.astype(np.uint8), hair=hair)


def write_markers(path: Path, times_secs: np.ndarray, places_m: np.ndarray, visible: np.ndarray) -> None:
    """Where the wig's markers really went, in the head frame, and which samples are in the exported file."""
    _write(path, t=times_secs, pos_head=places_m, visible=visible.astype(np.uint8))


def facts(name: str, config: Config, wig: list[Lock], wind: Wind, recording: Recording) -> dict[str, Any]:
    """`truth.json`: names, true properties, and what the cameras did."""
    return {
        "name": name,
        "rate_hz": config.cameras.rate_hz,
        "markers": [marker for lock in wig for marker in lock.marker_names],
        "head_markers": HEAD_LABELS,
        "marker_strand": [lock.name for lock in wig for _ in lock.marker_names],
        "marker_distance_from_root_m": [round(float(m), 5) for lock in wig for m in lock.marker_distances_m],
        "marker_mass_kg": [float(f"{kg:.4g}") for lock in wig for kg in lock.marker_masses_kg],
        "strands": [_lock_facts(lock) for lock in wig],
        "air": {"density_kg_m3": AIR_DENSITY_KG_M3, "kinematic_viscosity_m2_s": AIR_VISCOSITY_M2_S},
        "drag": DRAG_LAW,
        "reference_lock": {"linear_density_kg_per_m": 0.002, "lock_width_m": 0.005},
        "far_wind": {
            "azimuth_from_deg": wind.azimuth_deg,
            "elevation_deg": wind.elevation_deg,
            "speed": wind.speed_mps,
        },
        "events": recording.events,
        "noise_mm_rms": config.cameras.noise_mm,
        "generator": f"docs/evidence/captures (MuJoCo {mujoco.__version__})",
    }


def _lock_facts(lock: Lock) -> dict[str, Any]:
    return {
        "name": lock.name,
        "length_m": lock.length_m,
        "linear_density_kg_per_m": lock.linear_density,
        "bending_stiffness_N_m2": lock.bending_stiffness,
        "lock_width_m": lock.width_m,
        "internal_damping_time_s": lock.damping_secs,
        "root_m": lock.root_m.tolist(),
    }


def _write(path: Path, **arrays: np.ndarray) -> None:
    """Writes arrays as `.npz`; what is in double precision in single."""
    stored = {
        key: array.astype(np.float32) if array.dtype == np.float64 else array for key, array in arrays.items()
    }
    np.savez_compressed(path, **stored)
