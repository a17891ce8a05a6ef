"""The motion that a force is measured against, out of a recording."""

import numpy as np

from pipeline.errors import LoopgapError, refusal
from pipeline.physics.differentiation import Derivatives, differentiate
from pipeline.physics.force_units import (
    PER_SECOND,
    RADIAN,
    is_force,
    is_position,
    is_velocity,
    position_behind,
    position_unit,
)
from pipeline.physics.motion import Kinetics, Motion, turned_between
from pipeline.recording import Recording

ALIKE = 0.02


class MotionError(LoopgapError):
    """A recording's motion can't be differentiated."""


def position_of(recording: Recording, measurement: str) -> str | None:
    """The command that a force was measured against; None where it is no force against motion.

    That is where the measurement has a unit of force, torque, voltage or current and a command one
    of length or angle, or else of velocity; but behind a command of its own unit a force comes as
    an angle does behind another, whatever else is commanded. Of several such commands it is the one
    whose name begins alike, or the first.
    """
    unit = recording.channel(measurement).unit
    if any(c.unit == unit for c in recording.with_role("command")):
        return None
    commands = [c for c in recording.with_role("command") if is_force(unit, position_unit(c.unit))]
    for fits in (is_position, is_velocity):
        found = [c.name for c in commands if fits(c.unit)]
        kin = [name for name in found if name.split("_")[0] == measurement.split("_")[0]]
        if found:
            return [*kin, *found][0]
    return None


def force_motion(
    recording: Recording, position: str, simulated: np.ndarray, cutoff_hz: float | None = None
) -> tuple[Motion, Derivatives]:
    """The motion of the command `position` with its derivatives, see `differentiate`.

    A command that is a velocity is integrated first, see `position_behind`; its velocity is that,
    or that of a command beside it, see `speed_beside`.
    simulated: (n,) force of the simulation; where it says nothing of a row, a line between its
    neighbours stands (0 where it says nothing at all).
    """
    time_s = recording.values("time_s")
    unit, told = recording.channel(position).unit, recording.values(position)
    try:
        way = position_behind(time_s, told, unit)
        found = differentiate(time_s, way, cutoff_hz, speed_beside(recording, position, way))
    except ValueError as problem:
        raise MotionError(
            refusal(f"command {position!r}", f"{problem}, to differentiate it",
                    f"{len(time_s)} samples, {int(np.sum(np.diff(time_s) <= 0.0))} of them at the "
                    "time of the one before", "Remove repeated rows, or record more.")
        ) from problem  # fmt: skip
    motion = Motion(
        drive=np.ascontiguousarray(found.position),
        time_s=time_s,
        cycle=recording.values("cycle").astype(np.int64),
        radian=RADIAN.get(position_unit(unit), 1.0),
        kinetics=Kinetics(
            found.velocity,
            found.acceleration,
            _whole(simulated),
            turned_between(time_s, found.position, found.velocity),
        ),
    )
    return motion, found


def speed_beside(recording: Recording, position: str, way: np.ndarray) -> np.ndarray | None:
    """The command (n,) that is the velocity of a position's `way` (n,); None where none is.

    It is in the position's unit per second, and goes as the way's own differences do.
    """
    unit, between = position_unit(recording.channel(position).unit), np.diff(way)
    passed_s = np.diff(recording.values("time_s"))
    for command in recording.with_role("command"):
        base, size = PER_SECOND.get(command.unit, ("", 1.0))
        if base != unit:
            continue
        speed = size * recording.values(command.name)
        gone = 0.5 * (speed[1:] + speed[:-1]) * passed_s
        if np.sum((between - gone) ** 2) < ALIKE * np.sum(between**2):
            return np.asarray(speed)
    return None


def _whole(simulated: np.ndarray) -> np.ndarray:
    rows, said = np.arange(len(simulated)), np.isfinite(simulated)
    return np.interp(rows, rows[said], simulated[said]) if said.any() else np.zeros(len(rows))
