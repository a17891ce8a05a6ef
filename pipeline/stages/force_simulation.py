"""What a list of terms makes of a position, as force."""

from dataclasses import replace

import numpy as np

from pipeline.config import SimulationConfig
from pipeline.errors import UsageError, refusal
from pipeline.physics.assembly import pieces_of
from pipeline.physics.force_motion import force_motion
from pipeline.physics.force_units import position_unit
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.term import Surroundings, TermError
from pipeline.recording import Recording

BOUNDLESS = 1e12


def force_answer(
    config: SimulationConfig,
    recording: Recording,
    name: str,
    position: str,
    cutoff_hz: float | None = None,
) -> np.ndarray:
    """The force that a mechanism's terms make of a position, (n,); 0 where none is named.

    Raises UsageError for a nominal curve, which a force has not.
    """
    nothing = np.zeros(len(recording.samples))
    if name not in config.axes:
        return nothing
    axis = config.axes[name]
    if axis.gain != 1.0 or axis.cubic != 0.0:
        raise UsageError(
            refusal(f"simulation.axes.{name}", "terms alone: a force has no nominal curve",
                    f"gain {axis.gain:g}, cubic {axis.cubic:g}", "Say `stiffness` instead.")
        )  # fmt: skip
    motion, found = force_motion(recording, axis.command, nothing, cutoff_hz)
    around = Surroundings(
        drive_span=float(np.ptp(motion.drive)),
        angle_span=BOUNDLESS,
        top_speed=float(np.max(np.abs(found.velocity))),
        top_acceleration=float(np.max(np.abs(found.acceleration))),
        drive_unit=position_unit(recording.channel(position).unit),
        angle_unit=recording.channel(name).unit,
    )
    measured = recording.values(name)[np.isfinite(recording.values(name))]
    usual = replace(around, angle_span=max(float(np.ptp(measured)), 1e-9) if measured.size else 1.0)
    try:
        pieces = pieces_of(axis.terms, around, usual)
    except TermError as error:
        raise UsageError(f"simulation of {name!r}, {error}") from error
    return Mechanism(pieces=pieces).respond(motion)[0]
