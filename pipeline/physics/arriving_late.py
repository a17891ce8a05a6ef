"""What laws of creep share: part of the motion arrives late."""

from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term

LARGEST = 0.8
TIMES = (0.6, 1.5, 4.0, 10.0, 25.0, 60.0)


class ArrivingLate(Term):
    """A `share` of the motion that arrives late, with a `time_constant`: the laws named creep.

    Each has a file of its own: linear, rising with the pull, helped by stress.
    """

    name = "creep"
    site = "transmission"
    place = 70.0
    remembers = "time"
    timed = True
    far_apart = True
    means = "part of the motion arrives late, and depends on the dwell"

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.drive_span > 0.0 and around.dwell_s > 0.0


def share_and_time(around: Surroundings) -> tuple[Parameter, Parameter]:
    """How much arrives late, and with what time constant: of some dwells, or hours [s]."""
    dwell_s = max(around.dwell_s, 1e-9)
    longest_s = max(around.end_s - around.start_s, 10.0 * dwell_s)
    return (
        Parameter("share", "", 0.0, LARGEST, 0.1, 0.1),
        Parameter("time_constant", "s", 0.2 * dwell_s, longest_s, 5.0 * dwell_s, 0.0),
    )
