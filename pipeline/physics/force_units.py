"""Which units measure a force, which a position, and which a velocity."""

import numpy as np
from scipy.integrate import cumulative_trapezoid

FORCES = frozenset({
    "N", "n", "kN", "kn", "mN", "mn", "MN", "uN", "daN", "kgf", "gf", "lbf",
    "Nm", "N m", "N*m", "N·m", "kNm", "kN m", "mNm", "mN m", "Nmm", "N mm",
    "V", "v", "mV", "A", "a", "mA", "ma",
})  # fmt: skip
LENGTHS = frozenset({"m", "mm", "cm", "um", "µm", "in", "inch"})
ANGLES = frozenset({"deg", "°", "rad", "mrad", "rev", "turn", "turns", "qc", "counts"})
PER_SECOND = {
    "m/s": ("m", 1.0), "mm/s": ("mm", 1.0), "cm/s": ("cm", 1.0), "um/s": ("um", 1.0),
    "in/s": ("in", 1.0), "deg/s": ("deg", 1.0), "rad/s": ("rad", 1.0), "rpm": ("rev", 1.0 / 60.0),
}  # fmt: skip
RADIAN = {
    "rad": 1.0, "mrad": 1e3, "deg": np.rad2deg(1.0), "°": np.rad2deg(1.0),
    "rev": 0.5 / np.pi, "turn": 0.5 / np.pi, "turns": 0.5 / np.pi,
}  # fmt: skip
QUARTER_TURN = 0.5 * np.pi
LOWER_TORQUE = "nm"


def is_force(unit: str, position_unit: str) -> bool:
    """Whether a unit is one of force, torque, voltage or current; `nm` is against an angle."""
    return unit in FORCES or (unit == LOWER_TORQUE and position_unit in ANGLES)


def is_position(unit: str) -> bool:
    """Whether a unit is one of length or angle."""
    return unit in LENGTHS or unit in ANGLES


def is_velocity(unit: str) -> bool:
    """Whether a unit is one of velocity, of a length or an angle."""
    return unit in PER_SECOND


def radian_in(unit: str, span: float) -> float:
    """How many of a unit a radian has, where values in it span so much.

    Of a unit that is no angle, or one of unknown size as encoder counts are, a quarter turn is
    taken for the span: what goes by the sine of a pose then bends the same in each such unit.
    """
    return RADIAN.get(unit, max(span, 1e-300) / QUARTER_TURN)


def position_unit(unit: str) -> str:
    """The unit of the position behind a command: its own, or what a velocity's integral has."""
    return PER_SECOND[unit][0] if is_velocity(unit) else unit


def position_behind(time_s: np.ndarray, command: np.ndarray, unit: str) -> np.ndarray:
    """The position (n,) behind a command (n,): the command, or a velocity's trapezoid integral.

    The integral begins at 0.
    """
    if not is_velocity(unit):
        return command
    return PER_SECOND[unit][1] * np.asarray(cumulative_trapezoid(command, time_s, initial=0.0))
