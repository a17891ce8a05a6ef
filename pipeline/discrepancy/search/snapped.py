"""Where a joint snaps: its edges are tried place by place, as a fit sees no slope of them."""

from pipeline.discrepancy.fitting.fit import Fit, evaluate, improve
from pipeline.physics.piece import Piece
from pipeline.physics.snapping_joint import SnappingJoint

WAYS = tuple(0.5 * k for k in range(-8, 9) if k)
TURNS, STEPS, ENOUGH = 3, 4, 1.0


def snapped_into_place(fit: Fit) -> Fit:
    """The fit with both places at which its joint snaps moved to where they suit best.

    What is dated to a sample too soon or too late leaves that sample far off: a smooth step sees
    the samples at the edge now, and not those that it passes next.
    """
    for _ in range(TURNS):
        before = fit.cost
        for upper in (True, False):
            fit = min([fit, *edge_moved(fit, upper)], key=lambda f: f.cost)
        if fit.cost > before - ENOUGH:
            break
        fit = improve(fit, STEPS)
    return fit


def edge_moved(fit: Fit, upper: bool) -> list[Fit]:
    """The fits with the upper or lower place of a snap some parts of a step elsewhere."""
    around = fit.ground.problem.around
    step = around.step * around.angle_span / max(around.drive_span, 1e-300)
    found = []
    for i, piece in enumerate(fit.pieces):
        if not isinstance(piece.term, SnappingJoint):
            continue
        for way in WAYS:
            values = piece.values.copy()
            values[1] += 0.5 * way * step
            values[2] += way * step if upper else -way * step
            if values[2] > 0.0:
                moved = Piece(piece.term, values)
                found.append(evaluate(fit.ground, (*fit.pieces[:i], moved, *fit.pieces[i + 1 :])))
    return found
