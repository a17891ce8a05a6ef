"""A simulation's own course: a curve of a command that comes late, creeps, rubs or has play.

Friction may be at the drive or at the joint. Of the latter the joint's angles say what it holds
back, and so what the curve has to ask for.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre
from scipy.optimize import minimize

from pipeline.discrepancy.problem.spectrum import spectrum_at_drive, spectrum_at_joint
from pipeline.physics.arriving_late import LARGEST
from pipeline.physics.backlash import Backlash
from pipeline.physics.balance import settle
from pipeline.physics.creep import Creep
from pipeline.physics.friction import Friction
from pipeline.physics.held import STEP_AND_WAIT_S
from pipeline.physics.kinematics import SampledCurve
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.response_lag import ResponseLag
from pipeline.physics.second_order_lag import SecondOrderLag
from pipeline.physics.slip_spectrum import elements_of, shares_of
from pipeline.physics.term import Term
from pipeline.physics.yielding_play import YieldingPlay

DEGREE, KNOTS = 9, 401
EXACT, ROUGHLY, BETTER, PLAINER, ALIKE = 2e-3, 4e-3, 0.1, 2.0, 2e-4
MOST_ROWS = 20_000
SIZES, DAMPINGS = 14, (0.4, 0.7, 1.0)
SHORTEST, LONGEST, NARROWEST, WIDEST = 0.1, 0.05, 1e-3, 0.4
QUICKLY, HIGHEST, MOST_DAMPED = 0.2, 6.0, 5.0
SHARES, SLOWEST = (0.05, 0.2), 0.3
REACHES, RELEASES = (0.6, 1.2, 2.5), (0.05, 0.8)
AT_END = 0.01
FINELY = {"maxiter": 160, "xatol": 1e-4, "fatol": 1e-7}


@dataclass(frozen=True)
class Course:
    """A simulation that is a static curve of a command, and what that goes through besides.

    piece: a lag or creep behind the curve, play or friction before it, or friction at the joint.
    reproduced: (n,) all of it. otherwise: the same with friction at the other of both places.
    """

    command: str
    curve: SampledCurve
    piece: Piece
    reproduced: np.ndarray
    otherwise: "Course | None" = None


def course_of(
    commands: Mapping[str, np.ndarray], time_s: np.ndarray, simulated: np.ndarray
) -> Course | None:
    """The course of a simulation (n,), where one makes it of a command (n,) to EXACT of its range.

    Friction, of which each simulation has a law of its own, ROUGHLY so. It must leave less than a
    tenth of what a curve alone leaves; of those that leave about as little the plainest counts. The
    curve is a polynomial: a trial is linear least squares.
    """
    known = np.flatnonzero(np.isfinite(simulated))[:MOST_ROWS]
    span = float(np.ptp(simulated[known])) if len(known) else 0.0
    for name, command in commands.items():
        if span == 0.0 or np.ptp(command[known]) == 0.0 or known[-1] + 1 < DEGREE * DEGREE:
            continue
        whole = np.interp(np.arange(len(simulated)), known, simulated[known])
        trial = Trial(command, time_s, whole, known)
        alone = BETTER * trial.left(None)
        found = [
            (left, piece)
            for piece in trial.pieces()
            if (left := trial.left(piece)) < min(limit_of(piece) * span, alone)
        ]
        if found:
            enough = max(PLAINER * min(left for left, _ in found), ALIKE * span)
            piece = next(p for left, p in found if left <= enough)
            if rubs(piece):
                piece = rubbing_one(found)
            course = trial.course(name, piece)
            other = elsewhere(piece, found)
            return course if other is None else replace(course, otherwise=trial.course(name, other))
    return None


def rubbing_one(found: Sequence[tuple[float, Piece]]) -> Piece:
    """Of the pieces found, with what each leaves, the first friction that leaves about least."""
    ones = [(left, p) for left, p in found if rubs(p)]
    least = min(left for left, _ in ones)
    return next(p for left, p in ones if left <= PLAINER * least)


def elsewhere(piece: Piece, found: Sequence[tuple[float, Piece]]) -> Piece | None:
    """Of the pieces found, with what each leaves, the best friction at the other place."""
    others = [
        (left, other)
        for left, other in found
        if rubs(piece) and rubs(other) and other.term.in_balance != piece.term.in_balance
    ]
    return min(others, key=lambda one: one[0])[1] if others else None


def limit_of(piece: Piece) -> float:
    """How much of a simulation's range a piece may leave to be its own."""
    return ROUGHLY if rubs(piece) else EXACT


def rubs(piece: Piece) -> bool:
    """Whether a piece is friction."""
    return piece.term.name == Friction.name


@dataclass(frozen=True)
class Trial:
    """A command, time [s] and a simulation without holes, (n,) each; known: rows that it has."""

    command: np.ndarray
    time_s: np.ndarray
    simulated: np.ndarray
    known: np.ndarray

    @cached_property
    def settled(self) -> np.ndarray:
        """The rows known by which the command was at both ends, if that is at least half of them.

        By then friction has forgotten what was before the recording: the widest motion wipes out
        all that it remembers (Mayergoyz, Mathematical Models of Hysteresis (1991)).
        """
        command, near = self.command, AT_END * np.ptp(self.command[self.known])
        low, high = command[self.known].min(), command[self.known].max()
        first = max(int(np.argmax(end)) for end in (command >= high - near, command <= low + near))
        later = self.known[self.known >= first]
        return later if 2 * len(later) >= len(self.known) else self.known

    def compared(self, piece: Piece | None) -> np.ndarray:
        """The rows that a piece has to suit."""
        return self.settled if piece is not None and rubs(piece) else self.known

    @property
    def until(self) -> slice:
        """Rows up to the last one known."""
        return slice(0, self.known[-1] + 1)

    @property
    def motion(self) -> Motion:
        return Motion(self.command, self.time_s, np.zeros(len(self.command), dtype=np.int64), {})

    def way(self, drive: np.ndarray) -> np.ndarray:
        """Where in the command's range, -1 to 1, a drive is, (n,)."""
        low, high = self.command.min(), self.command.max()
        return np.asarray(np.clip(2.0 * (drive - low) / (high - low) - 1.0, -1.0, 1.0))

    def columns(self, piece: Piece | None, rows: slice) -> np.ndarray:
        """What each polynomial comes to behind a piece, (n, DEGREE + 1)."""
        drive, motion = self.command[rows], self.motion.rows(np.arange(len(self.command))[rows])
        if piece is not None and piece.term.before_curve:
            drive = piece.term.respond(drive, motion, piece.values, None)[0]
        columns = legendre.legvander(self.way(drive), DEGREE)
        if piece is None or piece.term.before_curve or piece.term.in_balance:
            return columns
        late = [piece.term.respond(c, motion, piece.values, None)[0] for c in columns.T]
        return np.column_stack(late)

    def wanted(self, piece: Piece | None) -> np.ndarray:
        """What the curve has to come to, (until,): at the joint more by what holds that back."""
        angle = self.simulated[self.until]
        if piece is None or not piece.term.in_balance:
            return angle
        reaches, holds = elements_of(piece.values)
        return np.asarray(angle + shares_of(angle, reaches) @ holds)

    def weights(self, piece: Piece | None) -> tuple[np.ndarray, float]:
        """Of the polynomials, those that suit the simulation best, and what they leave (RMS)."""
        rows = self.compared(piece)
        columns = self.columns(piece, self.until)[rows]
        wanted = self.wanted(piece)[rows]
        weights = np.linalg.lstsq(columns, wanted, rcond=None)[0]
        return weights, float(np.sqrt(np.mean((wanted - columns @ weights) ** 2)))

    def left(self, piece: Piece | None) -> float:
        """What the best curve leaves beside a piece (RMS)."""
        return self.weights(piece)[1]

    def pieces(self) -> Iterator[Piece]:
        """The best piece of each kind, the plainest first."""
        dwell_s = float(np.median(np.diff(self.time_s)))
        lasted_s = float(self.time_s[-1] - self.time_s[0])
        lags = np.geomspace(SHORTEST * max(dwell_s, 1e-9), LONGEST * max(lasted_s, 1e-9), SIZES)
        widths = np.ptp(self.command) * np.geomspace(NARROWEST, WIDEST, SIZES)
        forms = ["whole"] if dwell_s >= STEP_AND_WAIT_S else ["running", "whole"]
        for form in forms:
            yield self.best(ResponseLag(form), lags[:, None], lambda x: x)
        yield self.best(Backlash(), widths[:, None], lambda x: x)
        if dwell_s < STEP_AND_WAIT_S:
            given = np.array([[width, QUICKLY * dwell_s] for width in widths])
            yield self.best(YieldingPlay(), given, lambda x: x)
        moving, most = float(dwell_s < STEP_AND_WAIT_S), HIGHEST / max(dwell_s, 1e-9)
        paces = np.array([[1.0 / lag, damping] for lag in lags for damping in DAMPINGS])
        yield self.best(
            SecondOrderLag(), paces,
            lambda x: np.array([min(x[0], most), min(x[1], MOST_DAMPED), moving]),
        )  # fmt: skip
        yield self.best(Friction("driven"), rubbing(widths, RELEASES), lambda x: within(x, 1.0))
        slow = np.geomspace(max(dwell_s, 1e-9), SLOWEST * max(lasted_s, 1e-9), SIZES // 2)
        parts = np.array([[share, late_s] for share in SHARES for late_s in slow])
        yield self.best(Creep(forms[0]), parts, lambda x: np.array([min(x[0], LARGEST), x[1]]))
        yield from self.spectra()

    def spectra(self) -> Iterator[Piece]:
        """The slip elements of friction at the drive and at the joint, if there are any."""
        angle, drive = self.simulated[self.until], self.command[self.until]
        place = 2.0 * (angle - angle.min()) / np.ptp(angle) - 1.0
        curve, inverse = (legendre.legvander(way, DEGREE) for way in (self.way(drive), place))
        at_joint = spectrum_at_joint(curve, angle, self.settled)
        at_drive = spectrum_at_drive(inverse, drive, self.settled)
        yield from (piece for piece in (at_drive, at_joint) if piece is not None)

    def best(
        self, term: Term, starts: np.ndarray, told: Callable[[np.ndarray], np.ndarray]
    ) -> Piece:
        """A term with the sizes (positive) that leave least: the best start, (k, p), refined."""

        def piece(logs: np.ndarray) -> Piece:
            return Piece(term, told(np.exp(logs)))

        begun = min(np.log(starts), key=lambda logs: self.left(piece(logs)))
        found = minimize(lambda logs: self.left(piece(logs)), begun, method="Nelder-Mead",
                         options=FINELY)  # fmt: skip
        return piece(found.x)

    def course(self, name: str, piece: Piece) -> Course:
        """The course with a piece, through all rows."""
        weights = self.weights(piece)[0]
        low, high = float(self.command.min()), float(self.command.max())
        grid = np.linspace(low, high, KNOTS)
        angle = legendre.legval(self.way(grid), weights)
        curve = SampledCurve(low, float(grid[1] - grid[0]), angle)
        reproduced = self.columns(piece, slice(None)) @ weights
        if piece.term.in_balance:
            reproduced = settle(reproduced, [piece], self.motion, curve, None, {})[0]
        return Course(name, curve, piece, reproduced)


def rubbing(widths: np.ndarray, shapes: tuple[float, ...]) -> np.ndarray:
    """Widths, reaches and shapes of friction to begin from, (k, 3), from few of some widths."""
    return np.array([[w, share * w, s] for w in widths[::2] for share in REACHES for s in shapes])


def within(sizes: np.ndarray, most: float) -> np.ndarray:
    """Sizes (k,) of which the last one is no larger than can be."""
    return np.append(sizes[:-1], min(sizes[-1], most))
