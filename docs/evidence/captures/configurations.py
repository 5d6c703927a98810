"""What is set for each capture: fan, hairstyles, the subject's motion and how well the cameras see."""

from dataclasses import dataclass, field
from typing import Literal

MotionKind = Literal["still", "shake", "walk"]

DURATION_SECS = 5.0
STILL_SECS = 1.0
"""Nothing moves before; then the wind rises."""


@dataclass(frozen=True)
class Fan:
    """The wind as it is set; the true one differs by a few degrees and a few per cent."""

    program: str
    """What the session says of it."""
    azimuth_deg: float
    """Where it comes from: 0 in front, 90 on the subject's left."""
    azimuth_end_deg: float | None = None
    """Where it is carried round to, from 1.5 to 4.5 s."""
    elevation_deg: float = 0
    speed_mps: float = 2.6
    swell: float = 0.42
    """Amplitude of a slow wave of the speed, as a share of it."""
    swell_hz: float = 0.8
    flutter: float = 0.08
    """Standard deviation of what is irregular in the speed, as a share of it."""
    sway_deg: float = 4
    """Standard deviation of the azimuth; the elevation's is .6 of it."""
    turbulence: float = 0
    """Standard deviation of each component of the swirls, as a share of the speed."""
    swirl_m: float = 0.15
    """Distance over which swirls are alike."""
    swirl_secs: float = 0.5
    """Time over which a swirl that is carried along stays alike."""


@dataclass(frozen=True)
class Hair:
    """How a hairstyle differs from the usual one."""

    locks: int
    lengths_m: tuple[float, float] | None = None
    """From the shortest to the longest; None, in wigs only, for those of the template."""
    stiffness: float = 1
    """Factor on the bending stiffness."""
    curl_radii_m: tuple[float, float] | None = None
    """Radii of the coils, from the least to the greatest; slightly wavy if None."""
    markers: int | None = None
    """Markers a lock; one about every 4 cm if None."""


@dataclass(frozen=True)
class Cameras:
    """How well the markers are seen."""

    rate_hz: int = 120
    noise_mm: float = 0.15
    """Standard deviation per axis."""
    gaps: float = 0.05
    """Share of samples that are missing, at least."""
    swaps: int = 0
    """Pairs of markers whose labels are exchanged."""
    ghosts: int = 0
    """Trajectories without a label."""
    head_gaps: bool = False
    """Whether head markers are missing for long, twice all of them at once."""


@dataclass(frozen=True)
class Config:
    """One capture."""

    summary: str
    fan: Fan
    wig: Hair = Hair(locks=27)
    style_b: Hair = Hair(locks=36, lengths_m=(0.09, 0.46))
    motion: MotionKind = "still"
    cameras: Cameras = field(default_factory=Cameras)
    motion_of: str | None = None
    """Another capture, whose motion it shows as seen by other cameras."""
    seed_of: str | None = None
    """Another capture, whose random numbers it draws."""


def _swell(azimuth_deg: float, swell_hz: float, strength: str = "swell", **changed: float) -> Fan:
    program = f"gusting: {strength} of about {swell_hz} Hz about the set speed"
    return Fan(program, azimuth_deg, swell_hz=swell_hz, **changed)


def _swirling(azimuth_deg: float, moves: str = "", flutter: float = 0.04, **changed: float) -> Fan:
    program = "steady fan through a grid of slats: swirling" + moves
    settings = {"speed_mps": 2.2, "swell": 0, "turbulence": 0.25} | changed
    return Fan(program, azimuth_deg, flutter=flutter, **settings)


_BASE = _swell(70, 0.8, "strong swell")
_SHAKE = _swirling(20, "; the subject shakes and nods the head from about 1.4 s on")

CONFIGS: dict[str, Config] = {
    "base_gusts": Config("strong gusts from the left: what the others vary", _BASE),
    "swirl_8cm_clean": Config(
        "swirls of 8 cm, finer than the distances between locks; few gaps",
        _swirling(-30, flutter=0.03, swirl_m=0.08, swirl_secs=0.3),
        cameras=Cameras(gaps=0.03),
    ),
    "swirl_25cm_clean": Config(
        "the same locks in swirls of 25 cm; few gaps",
        _swirling(-30, flutter=0.03, swirl_m=0.25, swirl_secs=1.0),
        cameras=Cameras(gaps=0.03),
        seed_of="swirl_8cm_clean",
    ),
    "back_strong": Config(
        "strong gusts from behind, which blow the hair into the face",
        _swell(150, 0.6, speed_mps=3.4, swell=0.38, flutter=0.1),
    ),
    "weak_1mps": Config(
        "1 m/s: the hair hardly moves",
        Fan(
            "steady, weak, swirling", 40, speed_mps=1.0, swell=0, flutter=0.1, turbulence=0.25, swirl_secs=0.6
        ),
    ),
    "shake_turb": Config(
        "a person shakes and nods the head in swirls; two ghosts, two swapped pairs",
        _SHAKE,
        motion="shake",
        cameras=Cameras(swaps=2, ghosts=2),
    ),
    "walk": Config(
        "a person walks 1 m forward in a steady wind from the left",
        Fan(
            "steady; the subject walks 1 m forward from about 1.5 s on",
            80,
            speed_mps=2.0,
            swell=0,
            flutter=0.03,
        ),
        motion="walk",
    ),
    "long_wig": Config(
        "locks of 30 to 45 cm, which lie on the shoulders",
        _swell(-60, 0.7, speed_mps=2.5, swell=0.4),
        wig=Hair(locks=27, lengths_m=(0.30, 0.45)),
    ),
    "short_stiff": Config(
        "locks of 8 to 16 cm, five times as stiff",
        _swell(30, 0.9, speed_mps=3.0, swell=0.35),
        wig=Hair(locks=27, lengths_m=(0.08, 0.16), stiffness=5),
        style_b=Hair(locks=36, lengths_m=(0.08, 0.30)),
    ),
    "soft": Config(
        "locks half as stiff",
        _swell(-40, 0.9, speed_mps=2.4, swell=0.35),
        wig=Hair(locks=27, stiffness=0.5),
    ),
    "soft_swirls": Config(
        "locks a third as stiff, in swirls",
        _swirling(50, turbulence=0.2),
        wig=Hair(locks=27, stiffness=0.35),
    ),
    "stiffer": Config(
        "locks twice as stiff",
        _swell(60, 0.7, speed_mps=2.6, swell=0.35),
        wig=Hair(locks=27, stiffness=2),
    ),
    "curly": Config(
        "coils of 2 to 3 cm radius, in style B on half of the locks",
        _swell(50, 0.7, speed_mps=2.5, swell=0.3),
        wig=Hair(locks=27, curl_radii_m=(0.020, 0.030)),
        style_b=Hair(locks=36, lengths_m=(0.09, 0.46), curl_radii_m=(0.010, 0.030)),
    ),
    "few": Config(
        "only 14 locks with 4 markers each",
        _swell(-70, 0.8, "strong swell"),
        wig=Hair(locks=14, markers=4),
    ),
    "updraft": Config(
        "gusts from 30 degrees below",
        _swell(20, 0.7, elevation_deg=-30, speed_mps=2.5, swell=0.3),
    ),
    "noisy": Config(
        "noise of 0.6 mm, 12 % gaps, six swapped pairs, four ghosts",
        _swirling(-40, flutter=0.08, swell=0.15, turbulence=0.2),
        cameras=Cameras(noise_mm=0.6, gaps=0.12, swaps=6, ghosts=4),
    ),
    "hz60": Config(
        "the motion of base_gusts at 60 Hz",
        _BASE,
        cameras=Cameras(rate_hz=60),
        motion_of="base_gusts",
    ),
    "head_gaps": Config(
        "the motion of shake_turb; head markers missing for 0.5 to 1 s, twice all of them for 0.25 s",
        _SHAKE,
        motion="shake",
        cameras=Cameras(head_gaps=True),
        motion_of="shake_turb",
    ),
    "sweep_fast": Config(
        "a fan carried round from the front to the back in 3 s",
        Fan(
            "fan carried round from azimuth 0 to 180 between about 1.5 s and 4.5 s",
            0,
            azimuth_end_deg=180,
            speed_mps=2.8,
            swell=0,
            flutter=0.04,
        ),
    ),
}
