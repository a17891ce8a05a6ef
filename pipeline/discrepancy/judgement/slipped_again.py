"""A slip after the last row that was fitted, where slips are named: no command foretells it."""

from dataclasses import dataclass, replace

import numpy as np

from pipeline.discrepancy.judgement.rivals import mechanism_of
from pipeline.discrepancy.model.intervals import undated
from pipeline.discrepancy.model.result import Evidence, root_mean
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.weighing import Choice
from pipeline.number_words import worded
from pipeline.physics.lost_steps import LostSteps
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.piece import Piece

SURE, FEWEST, MOST, TURNS, FIRST_JUMP = 10.0, 10, 0.5, 3, 0.01
WORTH_SAYING = 0.8
NEARLY, USUAL = 1.25, 1.4826


@dataclass(frozen=True)
class Slip:
    """A slip as a piece (jump [drive unit], time [s]); predicted: (n,) with it."""

    piece: Piece
    predicted: np.ndarray


def slipped_again(problem: Problem, choice: Choice, predicted: np.ndarray) -> Slip | None:
    """One more slip in the rows after those fitted, if slips are named and these rows say so.

    It slips once more where a level of what a prediction (n,) leaves there, from some row on, is
    worth SURE of its noises. Such a slip refutes no name: it bears one out. Its jump is fitted to
    what it moves, its moment is that row's. Not where most held-out rows come last: they are then
    all that the proof has; nor where more than the noise is left.
    """
    slips = next((p.term for p in choice.fit.pieces if isinstance(p.term, LostSteps)), None)
    off = problem.measured - predicted
    last = int(np.flatnonzero(problem.train)[-1])
    heldout = np.flatnonzero(problem.heldout & np.isfinite(off))
    after = heldout[heldout > last]
    if slips is None or not FEWEST <= len(after) <= MOST * len(heldout):
        return None
    behind = np.cumsum(off[after][::-1])[::-1]
    worth = np.abs(behind) / np.sqrt(np.arange(len(after), 0, -1))
    first = int(np.argmax(worth[: 1 - FEWEST]))
    noise = choice.fit.ground.noise.deviation
    if worth[first] < SURE * noise:
        return None
    rows, time_s = after[first:], float(problem.motion.time_s[after[first]]) - 1e-6
    mechanism = mechanism_of(problem, choice)
    form = f"once {slips.form.partition(' ')[2]}".strip()
    jump = FIRST_JUMP * problem.around.drive_span
    slip = with_slip(problem, mechanism, form, jump, time_s)
    for _ in range(TURNS):
        slope = (slip.predicted - predicted)[rows] / jump
        jump = float(slope @ off[rows]) / max(float(slope @ slope), 1e-300)
        if jump == 0.0:
            return None
        slip = with_slip(problem, mechanism, form, jump, time_s)
    left = USUAL * float(np.median(np.abs(problem.measured - slip.predicted)[after]))
    return slip if left < NEARLY * noise else None


def with_slip(
    problem: Problem, mechanism: Mechanism, form: str, jump: float, time_s: float
) -> Slip:
    """What a mechanism answers with a slip more."""
    piece = Piece(LostSteps(form), np.array([jump, time_s]))
    slipping = replace(mechanism, pieces=(*mechanism.pieces, piece))
    return Slip(piece, slipping.respond(problem.motion)[0])


def slip_note(problem: Problem, choice: Choice, predicted: np.ndarray) -> list[str]:
    """That it slipped once more in held-out rows, in words; nothing where it did not."""
    again = slipped_again(problem, choice, predicted)
    if again is None:
        return []
    jump, time_s = again.piece.values
    return [
        f"In held-out rows it slips once more, by {worded(abs(jump))} "
        f"{problem.around.drive_unit} at {worded(time_s)} s: no command foretells that. The "
        "held-out error counts it, the verdict does not."
    ]


def undated_note(choice: Choice, evidence: Evidence) -> list[str]:
    """That a slip lies somewhere in held-out rows, and how far the others err; else nothing."""
    off, time_s = evidence.measured - evidence.after, evidence.motion.time_s
    heldout = evidence.heldout & evidence.used & np.isfinite(off)
    somewhere = heldout & undated(choice.fit, time_s)
    error, other = (root_mean(off[rows] ** 2) for rows in (heldout, heldout & ~somewhere))
    if not somewhere.any() or not other < WORTH_SAYING * error:
        return []
    first_s, last_s = time_s[somewhere][[0, -1]]
    return [
        f"A slip lies somewhere in held-out rows, from {worded(first_s)} s to {worded(last_s)} s: "
        "they err by it where it is told too early or too late. The other held-out rows err by "
        f"{worded(other)}, all of them by {worded(error)}."
    ]
