"""Viscous friction: a force against the motion that grows with its speed."""

from typing import ClassVar

import numpy as np
from numba import njit

from pipeline.number_words import worded
from pipeline.physics.decay import decayed
from pipeline.physics.force_term import ASYMMETRY, ForceTerm, both_ways, per, resistance
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.pre_sliding import weighted
from pipeline.physics.term import Parameter, Surroundings

SHARES, MOST_CYCLES = (0.01, 0.03, 0.1, 0.3), 0.5
EXPONENTS, POWER = (0.4, 0.7, 1.5), (0.2, 2.0)
TWO_THINGS, SELDOM = 3.0, 12.0  # damper and spring; of hundreds that also rub dry one has a valve


def relaxation_of(around: Surroundings) -> Parameter:
    """The time in which a damper lets go of the spring that it stands behind.

    In half a cycle at most: else that is a spring, and what it still lets go of a drift.
    """
    sample_s = max(around.dwell_s, 1e-9)
    longest_s = max(MOST_CYCLES * around.period_s, sample_s)
    return Parameter("relaxation", "s", 0.2 * sample_s, longest_s, 0.1 * around.period_s, 0.0,
                     relative=True)  # fmt: skip


def begun_at(around: Surroundings) -> Parameter:
    """What speed a damper behind a spring resists at the first sample: not all begin at rest."""
    top = max(around.top_speed, 1e-12)
    return Parameter("begun", f"{around.drive_unit}/s", -2.0 * top, 2.0 * top, 0.0, top, weak=True)


def square_of(around: Surroundings) -> Parameter:
    """What the square of the speed adds; less than nothing would be another law of friction."""
    top = max(around.top_speed, 1e-12)
    most, usual = 4.0 * around.angle_span / top**2, 0.2 * around.angle_span / top**2
    unit = f"{around.angle_unit} s^2/{around.drive_unit}^2"
    return Parameter("square", unit, 0.0, most, usual, usual)


class ViscousFriction(ForceTerm):
    """F = damping * v.

    Form "asymmetric" differs for the two directions: damping * v (1 + asymmetry sgn v). Form
    "square" is (damping + square |v|) v, as of oil in an orifice, or of the air; "asymmetric
    square" is both; "power" is damping |v|^exponent sgn v, as of a damper's valve. Form "sprung"
    has a spring of damping / relaxation in series: F + relaxation F' = damping * v, as oil that
    gives, a soft mount, rubber; at first it resists the speed `begun`. Source: Stokes (1851); one
    coefficient for each direction as in Hamon, Gautier and Garrec, IROS 2010; Newton (1687;
    square); Constantinou and Symans, Struct. Des. Tall Build. 2 (1993) 93 (power); Maxwell, Phil.
    Trans. 157 (1867) 49 (sprung).
    """

    name = "viscous_friction"
    place = 120.0
    directed = True
    grows: ClassVar = {
        "": ("asymmetric", "square"),
        "asymmetric": ("asymmetric square",),
        "square": ("asymmetric square",),
    }
    means = "a force against the motion that grows with its speed"
    says = "Friction that grows with the speed holds back by {damping}."

    def __init__(self, form: str = "") -> None:
        self.form = form
        self.unlikely = {"sprung": TWO_THINGS, "power": SELDOM}.get(form, 0.0)
        self.also = ("creep", "response_lag") if form == "sprung" else ()

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        top = max(around.top_speed, 1e-12)
        if self.form == "power":
            most = 4.0 * around.angle_span / min(top**exponent for exponent in POWER)
            by_speed = f"{around.angle_unit} per {around.drive_unit}/s to the exponent"
            own = resistance("damping", by_speed, most, around)
            return own, Parameter("exponent", "", *POWER, 1.0, 0.5)
        own = resistance("damping", per(around, 1), 4.0 * around.angle_span / top, around)
        if self.form == "sprung":
            return (own, relaxation_of(around), begun_at(around))
        asymmetry = (ASYMMETRY,) if "asymmetric" in self.form else ()
        square = (square_of(around),) if "square" in self.form else ()
        return (own, *asymmetry, *square)

    def asymmetry(self, values: np.ndarray) -> float:
        """How much more it holds back while the position rises."""
        return float(values[1]) if "asymmetric" in self.form else 0.0

    def square(self, values: np.ndarray) -> float:
        """The force by the square of the speed."""
        return float(values[-1]) if "square" in self.form else 0.0

    def force(
        self, motion: Motion, kinetics: Kinetics, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray | None]:
        if self.form == "sprung":
            pulled, after = _sprung(motion, float(values[1]), float(values[2]), state)
            return values[0] * pulled, after
        if self.form == "power":
            speed = np.abs(kinetics.velocity)
            return values[0] * np.sign(kinetics.velocity) * speed ** values[1], state
        v, square = kinetics.velocity, self.square(values)
        return weighted((values[0] + square * np.abs(v)) * v, self.asymmetry(values)), state

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        if self.form == "power":
            top, size = max(around.top_speed, 1e-12), 0.05 * around.angle_span
            return np.array([[size / top**exponent, exponent] for exponent in EXPONENTS])
        found = super().candidates(motion, around)
        if self.form == "sprung":
            found = np.repeat(found, len(SHARES), axis=0)
            found[:, 1] = np.array(SHARES) * around.period_s
        return found

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        out = super().scaled(values, factor)
        if "square" in self.form:
            out[-1] *= factor
        return out

    def void(self, values: np.ndarray) -> bool:
        return bool(values[0] == 0.0 and self.square(values) == 0.0)

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        told = "Friction that grows with the speed holds back by"
        if self.form == "sprung":
            size = both_ways(float(values[0]), 0.0, per(around, 1))
            return f"{told} {size} behind a spring that it lets go of in {worded(values[1])} s."
        if self.form == "power":
            one = f"1 {around.drive_unit}/s"
            return (
                f"{told} {worded(values[0])} {around.angle_unit} at {one}, and goes with the speed "
                f"to the power of {values[1]:.2g}."
            )
        asymmetry = self.asymmetry(values)
        ways = both_ways(float(values[0]), asymmetry, per(around, 1))
        if "square" not in self.form:
            return f"{told} {ways}."
        unit = self.parameters(around)[-1].unit
        by_square = f"{both_ways(self.square(values), asymmetry, unit)} with its square"
        return f"{told} {by_square if values[0] == 0.0 else f'{ways}, and by {by_square}'}."


def _sprung(
    motion: Motion, relaxation_s: float, begun: float, state: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """The speed that a damper behind a spring resists, (n,), and the state to carry.

    `begun` at the first sample; exact where the position moves evenly from sample to sample.
    """
    position, time_s = np.ascontiguousarray(motion.drive), motion.time_s
    before = np.array([position[0], time_s[0], begun]) if state is None else state
    out = _followed(position, time_s, relaxation_s, *before)
    return out, np.array([position[-1], time_s[-1], out[-1]])


@njit(cache=True, error_model="numpy")
def _followed(position, time_s, relaxation_s, at, then_s, speed):  # type: ignore[no-untyped-def]
    out = np.empty(position.size)
    for i in range(position.size):
        past_s = time_s[i] - then_s
        if past_s > 0.0:
            left = decayed(past_s / relaxation_s)
            speed = left * speed + (1.0 - left) * (position[i] - at) / past_s
        at, then_s = position[i], time_s[i]
        out[i] = speed
    return out
