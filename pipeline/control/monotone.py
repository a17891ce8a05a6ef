"""A branch of a loop that only rises: what an inverse search can trust.

The mean of a mixture regression may run backwards by tenths of a degree, so that one angle has
several commands. The nearest rising curve (isotonic regression) takes its place where it does.
"""

from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import isotonic_regression

from pipeline.errors import LoopgapError, refusal
from pipeline.models.mixture import MixtureRegression

NODES = 2001
SMALLEST_SLOPE_SHARE = 1e-3


@dataclass(frozen=True)
class MonotoneBranch:
    """A rising cubic through nodes: commands, angles [deg] and slopes, each of shape (n,).

    changed_deg: by how much the mixture's mean was moved at most, to make it rise.
    """

    commands_deg: np.ndarray
    angles_deg: np.ndarray
    slopes: np.ndarray
    changed_deg: float = 0.0

    @property
    def bounds_deg(self) -> tuple[float, float]:
        """The commands between which the branch is known."""
        return float(self.commands_deg[0]), float(self.commands_deg[-1])

    @property
    def reach_deg(self) -> tuple[float, float]:
        """The angles at those two commands."""
        return float(self.angles_deg[0]), float(self.angles_deg[-1])

    def at(self, command_deg: float) -> tuple[float, float]:
        """Angle [deg] and slope at a command within the bounds."""
        commands, angles, slopes = self._lists
        i = min(max(bisect_right(commands, command_deg) - 1, 0), len(commands) - 2)
        width = commands[i + 1] - commands[i]
        t = (command_deg - commands[i]) / width
        rise = angles[i + 1] - angles[i]
        first, last = slopes[i] * width, slopes[i + 1] * width
        square, cube = 3.0 * rise - 2.0 * first - last, first + last - 2.0 * rise
        angle = angles[i] + t * (first + t * (square + t * cube))
        return angle, (first + t * (2.0 * square + t * 3.0 * cube)) / width

    @cached_property
    def _lists(self) -> tuple[list[float], list[float], list[float]]:
        """Plain lists: one point of a search costs a microsecond with them."""
        return self.commands_deg.tolist(), self.angles_deg.tolist(), self.slopes.tolist()


def monotone_branch(mixture: MixtureRegression) -> MonotoneBranch:
    """The rising branch nearest to a mixture's mean, over the commands that it was fitted to.

    Where the mean rises by itself the branch is that mean; elsewhere it is a gentle slope of a
    thousandth of the branch's own, so that every angle has one command. LoopgapError if the angle
    falls with the command.
    """
    commands = np.linspace(*mixture.range_deg, NODES)
    mean = mixture.predict(commands)[0]
    overall = (mean[-1] - mean[0]) / (commands[-1] - commands[0])
    if overall <= 0.0:
        raise LoopgapError(
            refusal(
                "inverse search",
                "an angle that rises with the command",
                f"a slope of {overall:.3g} over {commands[0]:g} to {commands[-1]:g} deg",
                "Turn the sign of the command or of the angle in the recording.",
            )
        )
    floor = SMALLEST_SLOPE_SHARE * overall
    angles = isotonic_regression(mean - floor * commands).x + floor * commands
    slopes = np.where(np.abs(angles - mean) < 1e-12, mixture.slope(commands), floor)
    # A cubic piece rises if neither end is steeper than three times its chord (Fritsch & Carlson).
    chords = np.diff(angles) / np.diff(commands)
    limit = 3.0 * np.minimum(np.append(chords, np.inf), np.append(np.inf, chords))
    slopes = np.clip(slopes, min(floor, limit.min()), limit)
    return MonotoneBranch(commands, angles, slopes, float(np.abs(angles - mean).max()))
