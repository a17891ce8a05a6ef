"""Couplings with a cube, tried last: on its way a search would bend them for much else."""

from pipeline.discrepancy.fitting.reform import reformed
from pipeline.discrepancy.search.weighing import Choice, Search
from pipeline.physics.coupling import Coupling


def cubed(search: Search, choices: list[Choice]) -> list[Choice]:
    """The choices (best first), the best with the cube of another axis's command, if better."""
    best = choices[0]
    for place, piece in enumerate(best.fit.pieces):
        term = piece.term.with_cube if isinstance(piece.term, Coupling) else None
        if term is not None:
            best = search.better(best, reformed(best.fit, place, term))
    return choices if best is choices[0] else [best, *choices]
