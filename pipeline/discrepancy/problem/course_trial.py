"""What a simulation would be, were it a curve of a command that goes through given pieces."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre
from scipy.interpolate import CubicSpline

from pipeline.discrepancy.problem.spectrum import factor, spectrum_at_drive, spectrum_at_joint
from pipeline.discrepancy.problem.static_misfit import loop_misfit
from pipeline.physics.balance import settle
from pipeline.physics.friction import Friction
from pipeline.physics.kinematics import SampledCurve
from pipeline.physics.mechanism import OwnCourse
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.slip_spectrum import elements_of, shares_of

DEGREE, KNOTS = 9, 401
AT_END, MOST_COMPARED = 0.01, 3000
NOTHING = OwnCourse()


@dataclass(frozen=True)
class Course:
    """A simulation that is a static curve of a command, and what that goes through besides.

    own: a lag, creep, play or friction, or two of these. reproduced: (n,) all of it. otherwise: the
    same with friction at the other of its places, the drive and the joint. cornered: whether the
    command turned between samples.
    """

    command: str
    curve: SampledCurve
    own: OwnCourse
    reproduced: np.ndarray
    otherwise: "Course | None" = None
    cornered: bool = False


def rubs(own: OwnCourse) -> bool:
    """Whether a piece of a course is friction."""
    return any(piece.term.name == Friction.name for piece in own.pieces)


@dataclass(frozen=True)
class Trial:
    """A command, time [s] and a simulation without holes, (n,) each; known: rows that it has.

    The curve is a polynomial: whatever the pieces, it is linear least squares.
    """

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

    @property
    def thinned(self) -> "Trial":
        """The same trial, compared in about MOST_COMPARED rows."""
        step = -(-len(self.known) // MOST_COMPARED)
        return replace(self, known=np.union1d(self.known[::step], self.known[-1:]))

    @cached_property
    def loop_misfit(self) -> float:
        """How far the simulation is from one loop over the command, of its range [1]."""
        return loop_misfit(self.command[self.settled], self.simulated[self.settled])

    @cached_property
    def motion(self) -> Motion:
        return Motion(self.command, self.time_s, np.zeros(len(self.command), dtype=np.int64), {})

    @property
    def until(self) -> slice:
        """Rows up to the last one known."""
        return slice(0, self.known[-1] + 1)

    @property
    def dwell_s(self) -> float:
        """From sample to sample."""
        return float(np.median(np.diff(self.time_s)))

    def way(self, drive: np.ndarray) -> np.ndarray:
        """Where in the command's range, -1 to 1, a drive is, (n,)."""
        low, high = self.command.min(), self.command.max()
        return np.asarray(np.clip(2.0 * (drive - low) / (high - low) - 1.0, -1.0, 1.0))

    def columns(self, own: OwnCourse, rows: slice) -> np.ndarray:
        """What each polynomial comes to behind a course's pieces, (n, DEGREE + 1)."""
        motion = self.motion.rows(np.arange(len(self.command))[rows])
        drive = through(own.drive, self.command[rows], motion)
        columns = legendre.legvander(self.way(drive), DEGREE)
        if not own.curve:
            return columns
        return np.column_stack([through(own.curve, c, motion) for c in columns.T])

    def angle(self, late: tuple[Piece, ...] = ()) -> np.ndarray:
        """The simulation ahead of what comes late, (until,)."""
        angle, time_s = self.simulated[self.until], self.time_s[self.until]
        for piece in late:
            angle = ahead(angle, time_s, piece, self.known)
        return angle

    def wanted(self, own: OwnCourse) -> np.ndarray:
        """What the curve has to come to, (until,): at the joint more by what holds that back."""
        wanted = angle = self.angle(own.sensor)
        for piece in own.joint:
            reaches, holds = elements_of(piece.values)
            wanted = wanted + shares_of(angle, reaches) @ holds
        return wanted

    def compared(self, own: OwnCourse) -> tuple[np.ndarray, np.ndarray]:
        """What the polynomials come to, (k, DEGREE + 1), and what they have to (k,), in k rows."""
        rows = self.settled if rubs(own) else self.known
        return self.columns(own, self.until)[rows], self.wanted(own)[rows]

    def left(self, own: OwnCourse) -> float:
        """What the best curve leaves beside a course's pieces (RMS)."""
        return left_by(*self.compared(own))

    def left_by_mix(self, others: Sequence[np.ndarray]) -> float:
        """What the best curve and a line in other commands, (n,) each, leave (RMS)."""
        columns = np.column_stack([self.columns(NOTHING, self.until), *others])
        return left_by(columns[self.settled], self.simulated[self.settled])

    def rubbing_at_joint(self, late: OwnCourse = NOTHING) -> OwnCourse | None:
        """A course of what comes late with the slip elements that the joint has, if any.

        A joint's angles say what each element of a given reach holds back, and so do a drive's: the
        curve and the strengths are one linear problem, the strengths not negative.
        """
        curve = self.columns(late, self.until)
        found = spectrum_at_joint(curve, self.angle(late.sensor), self.settled)
        return None if found is None else replace(late, joint=(found,))

    def rubbing_at_drive(self, late: OwnCourse = NOTHING) -> OwnCourse | None:
        """The same of a drive, before the curve."""
        angle = self.angle(late.curve)
        place = 2.0 * (angle - angle.min()) / np.ptp(angle) - 1.0
        drive = through(late.drive, self.command, self.motion)[self.until]
        found = spectrum_at_drive(legendre.legvander(place, DEGREE), drive, self.settled)
        return None if found is None else replace(late, drive=(*late.drive, found))

    def off(self, own: OwnCourse) -> float:
        """How far the course is from the simulation in rows that have settled (RMS)."""
        off = self.course("", own).reproduced - self.simulated
        return float(np.sqrt(np.mean(off[self.settled] ** 2)))

    def course(self, name: str, own: OwnCourse, rows: slice | np.ndarray = slice(None)) -> Course:
        """The course of a command of that name with some pieces, as it is in some rows."""
        weights = np.linalg.lstsq(*self.compared(own), rcond=None)[0]
        low, high = float(self.command.min()), float(self.command.max())
        grid = np.linspace(low, high, KNOTS)
        angle = legendre.legval(self.way(grid), weights)
        curve = SampledCurve(low, float(grid[1] - grid[0]), angle)
        reproduced = self.columns(own, slice(None)) @ weights
        if own.joint:
            reproduced = settle(reproduced, own.joint, self.motion, curve, None, {})[0]
        reproduced = through(own.sensor, reproduced, self.motion)
        return Course(name, curve, own, reproduced[rows])


def ahead(signal: np.ndarray, time_s: np.ndarray, late: Piece, known: np.ndarray) -> np.ndarray:
    """What a signal (n,), known in some rows, was ahead of a lag.

    Of a command that is held, each sample says it; else the lag's own equation, the signal's
    derivatives being those of a spline.
    """
    term, values = late.term, late.values
    if term.form == "whole":
        fade = np.exp(-np.diff(time_s) / values[0])
        return np.append(signal[:1], (signal[1:] - fade * signal[:-1]) / (1.0 - fade))
    spline = CubicSpline(time_s[known], signal[known])
    if term.form == "running":
        return np.asarray(signal + values[0] * spline(time_s, 1))
    frequency, damping = values[:2]
    bent = spline(time_s, 2) / frequency**2
    return np.asarray(signal + 2.0 * damping / frequency * spline(time_s, 1) + bent)


def left_by(columns: np.ndarray, wanted: np.ndarray) -> float:
    """What the best of columns (k, m) leaves of (k,) values (RMS)."""
    return float(factor(np.column_stack([columns, wanted]))[-1, -1] / np.sqrt(len(wanted)))


def through(pieces: tuple[Piece, ...], signal: np.ndarray, motion: Motion) -> np.ndarray:
    """A signal (n,) behind some pieces, from their first state."""
    for piece in pieces:
        signal = piece.term.respond(signal, motion, piece.values, None)[0]
    return signal
