"""The effects that a case can hide: how each is set up in the plant, and how its size is turned."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from pipeline.concealed.motions import Motion
from pipeline.concealed.outside import OUTSIDE
from pipeline.concealed.plant import WIRE_STIFFNESS, Plant

Settings = dict[str, float | int | str]
CAMERA_SETTINGS = frozenset(
    {"tilt_deg", "tilt_axis_deg", "perspective", "barrel", "centre_x_mm", "centre_y_mm", "stale_s",
     "stale_frames", "wander_deg", "wander_kind", "settle_s"}
)  # fmt: skip
WHOLE_TORQUE = 2 * WIRE_STIFFNESS


@dataclass(frozen=True)
class Effect:
    """One hidden effect: settings of the plant's parts, and those that its size multiplies.

    A stop's size is how far it stands before the farthest angle. Sizes go from 0 to `largest`.
    """

    name: str
    settings: Settings
    scaled: tuple[str, ...]
    largest: float

    @property
    def fixed(self) -> bool:
        """Whether it comes in one size only."""
        return not self.scaled and "stop_reach_deg" not in self.settings


def place(plant: Plant, effect: Effect, size: float) -> Plant:
    """The plant with the effect at that size."""
    settings = dict(effect.settings)
    for name in effect.scaled:
        settings[name] = float(settings[name]) * size
    if "stop_reach_deg" in settings:
        angle = float(settings.pop("stop_reach_deg")) - size
        for side in str(settings.pop("stop_sides")).split("+"):
            settings[f"stop_{side}_deg"] = angle
    if effect.name in OUTSIDE:
        numbers = {k: float(v) for k, v in settings.items()}
        return replace(plant, outside=effect.name, outside_parameters=numbers)
    camera = {k: v for k, v in settings.items() if k in CAMERA_SETTINGS}
    parts = {k: v for k, v in settings.items() if k not in CAMERA_SETTINGS}
    return replace(plant, camera=replace(plant.camera, **camera), **parts)  # type: ignore[arg-type]


def _tossed(rng: np.random.Generator) -> bool:
    return bool(rng.random() < 0.5)


Draw = Callable[[np.random.Generator, Motion, Plant], Effect]


def lost_steps(rng: np.random.Generator, motion: Motion, plant: Plant) -> Effect:
    """Motor or wire slip once, either way, at a random sample of the second to the eighth cycle."""
    sample = int(rng.integers(230, 1580))
    sign = float(rng.choice([-1.0, 1.0]))
    settings: Settings = {"slip_deg": sign, "slip_sample": sample, "slip_on_drum": _tossed(rng)}
    return Effect("lost_steps", settings, ("slip_deg",), 30.0)


def transmission_ripple(rng: np.random.Generator, motion: Motion, plant: Plant) -> Effect:
    """An uneven gear or drum: a sine of its angle, with or without its overtone."""
    settings: Settings = {
        "mesh_deg": 1.0,
        "mesh_period_deg": float(np.exp(rng.uniform(np.log(7.0), np.log(45.0)))),
        "mesh_phase": float(rng.uniform(0, 2 * np.pi)),
        "mesh_overtone": float(rng.choice([0.0, rng.uniform(0.05, 0.3)])),
        "mesh_on_drum": _tossed(rng),
    }
    return Effect("transmission_ripple", settings, ("mesh_deg",), 20.0)


def backlash(rng: np.random.Generator, motion: Motion, plant: Plant) -> Effect:
    """A dead gap [deg] between gear and drum."""
    return Effect("backlash", {"clearance_deg": 1.0}, ("clearance_deg",), 30.0)


def friction(rng: np.random.Generator, motion: Motion, plant: Plant) -> Effect:
    """Wires that rub in their sheath: slip elements of many widths, some with a capstan."""
    low = float(rng.uniform(0.3, 1.5))
    settings: Settings = {
        "sheath_torque": WHOLE_TORQUE,
        "presliding_low_deg": low,
        "presliding_high_deg": float(low * np.exp(rng.uniform(np.log(6.0), np.log(15.0)))),
        "sheath_asymmetry": float(rng.choice([0.0, rng.uniform(-0.4, 0.4)])),
        "capstan": float(rng.choice([0.0, rng.uniform(0.0, 0.06)])),
    }
    return Effect("friction", settings, ("sheath_torque",), 15.0)


def slack(rng: np.random.Generator, motion: Motion, plant: Plant) -> Effect:
    """Wires with too little pretension that hang loose, some straightening bit by bit."""
    settings: Settings = {
        "pretension_deg": -1.0,
        "straightening_deg": float(rng.choice([0.0, rng.uniform(0.1, 0.3)])),
    }
    return Effect("slack", settings, ("pretension_deg",), 15.0)


def compliance(rng: np.random.Generator, motion: Motion, plant: Plant) -> Effect:
    """Wires that are softer than simulated until they are stretched straight."""
    settings: Settings = {
        "pretension_deg": 0.0,
        "wire_softness": 1.0,
        "toe_share": float(rng.uniform(0.1, 0.4)),
        "toe_deg": float(rng.uniform(4.0, 14.0)),
    }
    return Effect("compliance", settings, ("wire_softness",), 5.0)


def creep(rng: np.random.Generator, motion: Motion, plant: Plant) -> Effect:
    """Wires that go on stretching under load, with one dashpot or two."""
    settings: Settings = {
        "dashpot_share": 1.0,
        "dashpot_s": float(np.exp(rng.uniform(np.log(8.0), np.log(120.0)))),
    }
    scaled = ["dashpot_share"]
    if rng.random() < 0.3:
        settings["second_dashpot_share"] = float(rng.uniform(0.3, 1.0))
        settings["second_dashpot_s"] = float(settings["dashpot_s"]) * float(rng.uniform(4.0, 8.0))
        scaled.append("second_dashpot_share")
    return Effect("creep", settings, tuple(scaled), 0.5)


def response_lag(rng: np.random.Generator, motion: Motion, plant: Plant) -> Effect:
    """A viscous body that follows its wires with a time constant [s], or a tip that swings."""
    if _tossed(rng):
        damping = float(rng.uniform(0.2, 0.9))
        return Effect("response_lag", {"swing_s": 1.0, "swing_damping": damping}, ("swing_s",), 8.0)
    return Effect("response_lag", {"viscosity_s": 1.0}, ("viscosity_s",), 12.0)


def tension_loss(rng: np.random.Generator, motion: Motion, plant: Plant) -> Effect:
    """Play that grows with the way gone: from the start, ever more slowly, or later."""
    travel = float(np.abs(np.diff(motion.pitch_deg[motion.cycle < 9])).sum())
    kind = rng.choice(["steady", "steady", "settling", "late"])
    settings: Settings = {
        "clearance_deg": float(rng.choice([0.0, rng.uniform(0.2, 1.0)])),
        "wear_per_deg": 1.0 / travel,
    }
    if kind == "settling":
        settings["wear_saturation_deg"] = float(rng.uniform(0.6, 1.5) * travel)
    if kind == "late":
        settings["wear_onset_deg"] = float(rng.uniform(0.1, 0.3) * travel)
        settings["clearance_deg"] = 0.0
    return Effect("tension_loss", settings, ("clearance_deg", "wear_per_deg"), 30.0)


def gravity(rng: np.random.Generator, motion: Motion, plant: Plant) -> Effect:
    """A weight on the joint, which is mounted at some angle [rad] to the vertical."""
    settings: Settings = {"weight": 1.0, "mounting_rad": float(rng.uniform(0.9, 2.2))}
    return Effect("gravity", settings, ("weight",), 900.0)


def contact(rng: np.random.Generator, motion: Motion, plant: Plant) -> Effect:
    """A soft pad in the way on one side, behind a skin in which its stiffness grows."""
    top = float(plant.nominal.angle_deg(np.abs(motion.pitch_deg).max()))
    settings: Settings = {
        "pad_stiffness": 1.0,
        "pad_deg": float(top * rng.uniform(0.2, 0.7)),
        "pad_side": float(rng.choice([-1.0, 1.0])),
        "pad_skin_deg": float(rng.uniform(0.1, 1.5)),
    }
    return Effect("contact", settings, ("pad_stiffness",), 2.5 * WHOLE_TORQUE)


def end_stop(rng: np.random.Generator, motion: Motion, plant: Plant) -> Effect:
    """A hard stop on one side or both, before the farthest simulated angle."""
    top = float(plant.nominal.angle_deg(np.abs(motion.pitch_deg).max()))
    settings: Settings = {
        "stop_stiffness": float(WHOLE_TORQUE * rng.uniform(20.0, 80.0)),
        "stop_skin_deg": float(rng.uniform(0.05, 0.6)),
        "stop_sides": str(rng.choice(["high", "low", "high+low"])),
        "stop_reach_deg": top,
    }
    return Effect("end_stop", settings, (), 0.6 * top)


def coupling(rng: np.random.Generator, motion: Motion, plant: Plant) -> Effect:
    """The other axis's wires pull at the joint, in proportion to its way or unevenly."""
    even = float(rng.choice([0.0, rng.uniform(-0.3, 0.3)]))
    settings: Settings = {"other_lever": 1.0, "other_lever_even": even}
    return Effect("coupling", settings, ("other_lever", "other_lever_even"), 0.5)


def camera_tilt(rng: np.random.Generator, motion: Motion, plant: Plant) -> Effect:
    """A camera that does not look squarely at the plane of motion, in perspective."""
    settings: Settings = {
        "tilt_deg": 1.0,
        "tilt_axis_deg": float(rng.uniform(0.0, 180.0)),
        "perspective": 1.0,
    }
    return Effect("camera_tilt", settings, ("tilt_deg",), 55.0)


def lens_distortion(rng: np.random.Generator, motion: Motion, plant: Plant) -> Effect:
    """A barrel or cushion of the lens, about a centre beside the picture's [mm]."""
    settings: Settings = {
        "barrel": float(rng.choice([-1.0, 1.0])),
        "centre_x_mm": float(rng.uniform(2.0, 6.0)),
        "centre_y_mm": float(rng.uniform(-3.0, 3.0)),
    }
    return Effect("lens_distortion", settings, ("barrel",), 0.6)


def frame_lag(rng: np.random.Generator, motion: Motion, plant: Plant) -> Effect:
    """Frames late by a time, on a shaft that moves slowly all the while, or by whole frames."""
    if rng.random() < 0.35:
        return Effect("frame_lag", {"stale_frames": int(rng.integers(1, 3))}, (), 1.0)
    return Effect("frame_lag", {"stale_s": 1.0}, ("stale_s",), 12.0)


def drift(rng: np.random.Generator, motion: Motion, plant: Plant) -> Effect:
    """A zero that wanders over the recording: evenly, settling, or in stairs."""
    span = float(motion.time_s[motion.cycle < 9][-1])
    settings: Settings = {
        "wander_deg": float(rng.choice([-1.0, 1.0])),
        "wander_kind": str(rng.choice(["linear", "linear", "settling", "stairs"])),
        "settle_s": float(span * rng.uniform(0.3, 0.8)),
    }
    return Effect("drift", settings, ("wander_deg",), 30.0)


def outside_effect(rng: np.random.Generator, motion: Motion, name: str) -> Effect:
    """One of the effects that the catalogue has no name for."""
    cycle_s = float(motion.time_s[motion.cycle == 0][-1])
    top = 0.7 * float(np.abs(motion.pitch_deg).max())
    shapes: dict[str, Settings] = {
        "thermal_gain": {
            "strength": 1.0,
            "period_s": cycle_s * float(rng.uniform(1.3, 3.2)),
            "phase": float(rng.uniform(0, 6.28)),
        },
        "sticky_spots": {
            "strength": 1.0,
            "spots": float(rng.integers(1, 10**6)),
            "level": float(rng.uniform(0.1, 0.9)),
        },
        "snap_through": {
            "strength": float(rng.choice([-1.0, 1.0])),
            "up_deg": float(top * rng.uniform(0.1, 0.4)),
            "down_deg": float(-top * rng.uniform(0.1, 0.4)),
            "fold": float(rng.uniform(2.0, 4.0)),
        },
        "swing_memory": {"strength": float(rng.choice([-1.0, 1.0]))},
        "parity_bump": {"strength": 1.0, "period_deg": float(rng.uniform(15.0, 35.0))},
        "delayed_echo": {"strength": 1.0, "delay_s": cycle_s * float(rng.uniform(0.12, 0.4))},
        "rough_guide": {
            "strength": 1.0,
            "profile": float(rng.integers(1, 10**6)),
            "grain_deg": float(rng.uniform(2.0, 6.0)),
        },
        "wearing_gain": {"strength": 1.0},
        "step_resonance": {
            "strength": 1.0,
            "resonant_step_deg": float(rng.uniform(0.5, 0.9)),
            "phase": float(rng.uniform(0, 6.28)),
        },
    }
    return Effect(name, shapes[name], ("strength",), 10.0)


CATALOGUE: dict[str, Draw] = {
    f.__name__: f
    for f in (
        lost_steps, transmission_ripple, backlash, friction, slack, compliance, creep,
        response_lag, tension_loss, gravity, contact, end_stop, coupling, camera_tilt,
        lens_distortion, frame_lag, drift,
    )
}  # fmt: skip
