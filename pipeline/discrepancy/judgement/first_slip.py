"""A slip at the very start: it says how a wire lay there, not that a shaft slipped."""

import numpy as np

from pipeline.discrepancy.fitting.fit import Fit
from pipeline.number_words import worded
from pipeline.physics.lost_steps import LostSteps
from pipeline.physics.piece import Piece
from pipeline.recording import reversals_of


def is_start(fit: Fit, piece: Piece) -> bool:
    """Whether a piece is slips before the drive first turns, beside a term that remembers its way.

    Friction and play begin unstressed, in the middle; where a wire lay otherwise, a slip takes the
    drive there. Until it turns, nothing tells one from a shaft that slipped.
    """
    remembered = any(p.term.remembers == "way" for p in fit.pieces)
    if not (isinstance(piece.term, LostSteps) and remembered):
        return False
    motion = fit.ground.problem.motion
    turns = reversals_of(motion.drive)
    return bool(len(turns) and np.all(piece.values[1::2] <= motion.time_s[turns[0]]))


def start_note(fit: Fit) -> list[str]:
    """How far a wire lay off at the start, for each such slip."""
    unit = fit.ground.problem.around.drive_unit
    found = [sum(p.values[0::2]) for p in fit.pieces if is_start(fit, p)]
    return [
        f"At the start the wire lay as if the drive had come from {worded(abs(jump))} {unit} off."
        for jump in found
    ]
