"""The wind: a fan's, with swirls that it carries along, bent round the head and slowed at and behind it."""

import numpy as np
from numba import njit

from body import HEAD_HALF_AXES_M, smooth_step
from configurations import STILL_SECS, Fan
from head_motion import SAMPLE_SECS, HeadMotion

RISE_SECS = 0.35
SWAY_SECS = 0.4
FLUTTER_SECS = 0.2
SWIRL_WAVES = 90
SLOWED_LAYER_M = 0.007
"""Over this distance from the scalp the wind rises to 1 - 1/e of what it is farther off."""
WAKE = 0.55
"""Share of the wind that is missing right behind the head."""


def smooth_noise(rng: np.random.Generator, times_secs: np.ndarray, alike_secs: float) -> np.ndarray:
    """Noise of standard deviation 1 at even times, alike over a given time."""
    count = len(times_secs)
    # One number more is drawn than is used: what is drawn later depends on it.
    white = rng.standard_normal(count + 1)[:count]
    frequencies = np.fft.rfftfreq(count, times_secs[1] - times_secs[0])
    kept = np.exp(-((2 * np.pi * frequencies * alike_secs) ** 2) / 4)
    noise = np.fft.irfft(np.fft.rfft(white) * kept, count)
    return noise / noise.std()


class Wind:
    """The wind at any point and time, in head axes.

    Far from the head it is known in lab axes, those of the head at rest. Swirls are a sum of plane waves
    across which the air moves, so that none of it is lost.
    """

    def __init__(self, fan: Fan, motion: HeadMotion, rng: np.random.Generator) -> None:
        self._motion = motion
        t = motion.secs
        self.azimuth_deg = fan.azimuth_deg + rng.normal(0, 2.5)
        self.elevation_deg = fan.elevation_deg + rng.normal(0, 1.5)
        self.speed_mps = fan.speed_mps * (1 + rng.normal(0, 0.04))
        rise = smooth_step((t - STILL_SECS) / RISE_SECS)

        azimuth_deg = self.azimuth_deg
        if fan.azimuth_end_deg is not None:
            way_deg = fan.azimuth_end_deg - fan.azimuth_deg
            azimuth_deg = azimuth_deg + way_deg * np.clip((t - 1.5) / 3.0, 0, 1)
        azimuth_deg = azimuth_deg + fan.sway_deg * smooth_noise(rng, t, SWAY_SECS)
        elevation_deg = self.elevation_deg + 0.6 * fan.sway_deg * smooth_noise(rng, t, SWAY_SECS)
        swell_phase = 2 * np.pi * fan.swell_hz * (t - 1) + rng.uniform(0, 6.28)
        gust = 1 + fan.swell * np.sin(swell_phase) + fan.flutter * smooth_noise(rng, t, FLUTTER_SECS)
        speed_mps = self.speed_mps * rise * np.maximum(gust, 0.15)
        azimuth, elevation = np.radians(azimuth_deg), np.radians(elevation_deg)
        self._far_mps = -speed_mps[:, None] * direction_from(azimuth, elevation)
        self._carried_m = np.cumsum(self._far_mps, 0) * SAMPLE_SECS

        self._wave_vectors = rng.standard_normal((SWIRL_WAVES, 3)) / (fan.swirl_m / np.sqrt(2))
        self._frequencies = rng.standard_normal(SWIRL_WAVES) * np.sqrt(2) / fan.swirl_secs
        self._phases = rng.uniform(0, 2 * np.pi, SWIRL_WAVES)
        amplitudes = rng.standard_normal((SWIRL_WAVES, 3))
        along = self._wave_vectors / np.linalg.norm(self._wave_vectors, axis=1)[:, None]
        amplitudes -= (amplitudes * along).sum(1)[:, None] * along
        # Each component has variance 1.
        self._amplitudes = amplitudes * np.sqrt(2 * 3 / (amplitudes**2).sum())
        self._swirl_mps = fan.turbulence * self.speed_mps * rise * np.clip(gust, 0.3, 2)

    def at(self, points_m: np.ndarray, secs: float) -> np.ndarray:
        """Velocity of the air over the ground (N, 3), m/s, head axes, at points (N, 3) of the head frame."""
        i = self._motion.index(secs)
        # A head that turns in its place moves hardly any air; one that walks meets it.
        head_mps = self._motion.lab_velocity[i] if self._motion.walks else np.zeros(3)
        out = np.empty_like(points_m)
        _wind(
            points_m,
            self._far_mps[i],
            head_mps,
            self._motion.head_to_lab[i],
            self._motion.lab_position_m[i],
            self._carried_m[i],
            secs,
            self._wave_vectors,
            self._frequencies,
            self._phases,
            self._amplitudes,
            self._swirl_mps[i],
            out,
        )
        return out


def direction_from(azimuth: np.ndarray, elevation: np.ndarray) -> np.ndarray:
    """The direction that wind comes from, axes of the head at rest; angles in radians, azimuth 0 in front."""
    level = np.cos(elevation)
    return np.stack([np.cos(azimuth) * level, np.sin(azimuth) * level, np.sin(elevation)], -1)


@njit
def _turned_back(rotation, vector):
    """A vector times the inverse of a rotation."""
    return (
        vector[0] * rotation[0, 0] + vector[1] * rotation[1, 0] + vector[2] * rotation[2, 0],
        vector[0] * rotation[0, 1] + vector[1] * rotation[1, 1] + vector[2] * rotation[2, 1],
        vector[0] * rotation[0, 2] + vector[1] * rotation[1, 2] + vector[2] * rotation[2, 2],
    )


@njit
def _in_air(x, y, z, turn, moved, carried):
    """The place of a point of the head frame in the air that the wind carries, lab axes."""
    return (
        turn[0, 0] * x + turn[0, 1] * y + turn[0, 2] * z + moved[0] - carried[0],
        turn[1, 0] * x + turn[1, 1] * y + turn[1, 2] * z + moved[1] - carried[1],
        turn[2, 0] * x + turn[2, 1] * y + turn[2, 2] * z + moved[2] - carried[2],
    )


@njit
def _swirls(place, secs, wave_vectors, frequencies, phases, amplitudes):
    """The sum of the waves at a place that is carried with the wind; standard deviation 1 a component."""
    x, y, z = 0.0, 0.0, 0.0
    for k in range(wave_vectors.shape[0]):
        wave = wave_vectors[k, 0] * place[0] + wave_vectors[k, 1] * place[1] + wave_vectors[k, 2] * place[2]
        height = np.cos(wave + frequencies[k] * secs + phases[k])
        x += amplitudes[k, 0] * height
        y += amplitudes[k, 1] * height
        z += amplitudes[k, 2] * height
    return x, y, z


@njit
def _bent(flow, x, y, z, radius):
    """A flow bent round the head: potential flow round the unit sphere that the head is when scaled."""
    axes = HEAD_HALF_AXES_M
    n0, n1, n2 = x / axes[0] / radius, y / axes[1] / radius, z / axes[2] / radius
    f0, f1, f2 = flow[0] / axes[0], flow[1] / axes[1], flow[2] / axes[2]
    outwards = f0 * n0 + f1 * n1 + f2 * n2
    near = 1 / radius**3
    return (
        (f0 * (1 + 0.5 * near) - 1.5 * near * outwards * n0) * axes[0],
        (f1 * (1 + 0.5 * near) - 1.5 * near * outwards * n1) * axes[1],
        (f2 * (1 + 0.5 * near) - 1.5 * near * outwards * n2) * axes[2],
    )


@njit
def _slowed(x, y, z, radius, main, main_speed):
    """The share of the wind that is left in the slow layer at the scalp and in the wake."""
    axes = HEAD_HALF_AXES_M
    slope = np.sqrt((x / axes[0] ** 2) ** 2 + (y / axes[1] ** 2) ** 2 + (z / axes[2] ** 2) ** 2)
    gap_m = (radius - 1) * radius / slope
    share = 1 - np.exp(-gap_m / SLOWED_LAYER_M)
    behind = (x * main[0] + y * main[1] + z * main[2]) / main_speed
    if behind > 0:
        aside2 = x * x + y * y + z * z - behind * behind
        width = 0.075 + 0.1 * behind
        begins = 1 - np.exp(-((behind / 0.08) ** 2))
        ends = np.exp(-((behind / 0.4) ** 2))
        share *= 1 - WAKE * np.exp(-aside2 / (2 * width * width)) * begins * ends
    return share


@njit
def _wind(
    points,
    far,
    head_velocity,
    head_to_lab,
    head_position,
    carried,
    secs,
    wave_vectors,
    frequencies,
    phases,
    amplitudes,
    swirl,
    out,
):
    """Writes the wind at `points` (N, 3) to `out`; since the beginning the air has gone by `carried`."""
    axes = HEAD_HALF_AXES_M
    met = (far[0] - head_velocity[0], far[1] - head_velocity[1], far[2] - head_velocity[2])
    main = _turned_back(head_to_lab, met)
    main_speed = np.sqrt(main[0] ** 2 + main[1] ** 2 + main[2] ** 2) + 1e-9
    head = _turned_back(head_to_lab, (head_velocity[0], head_velocity[1], head_velocity[2]))
    for n in range(points.shape[0]):
        x, y, z = points[n, 0], points[n, 1], points[n, 2]
        radius = np.sqrt((x / axes[0]) ** 2 + (y / axes[1]) ** 2 + (z / axes[2]) ** 2)
        if radius <= 1.0:
            out[n, 0], out[n, 1], out[n, 2] = 0.0, 0.0, 0.0
            continue
        flow = main
        if swirl > 0:
            place = _in_air(x, y, z, head_to_lab, head_position, carried)
            s0, s1, s2 = _swirls(place, secs, wave_vectors, frequencies, phases, amplitudes)
            turned = _turned_back(head_to_lab, (s0 * swirl, s1 * swirl, s2 * swirl))
            flow = (main[0] + turned[0], main[1] + turned[1], main[2] + turned[2])
        bent = _bent(flow, x, y, z, radius)
        share = _slowed(x, y, z, radius, main, main_speed)
        # Seen from the head the air stands still at the scalp: there it moves with the head.
        for c in range(3):
            out[n, c] = head[c] + bent[c] * share
