"""Couplings with a cube, tried last: on its way a search would bend them for much else."""

from pipeline.discrepancy.fitting.reform import reformed
from pipeline.discrepancy.search.weighing import Choice, Search
from pipeline.physics.coupling import Coupling


def cubed(search: Search, choice: Choice) -> Choice:
    """The choice with the cube of another axis's command in its couplings, if that is better."""
    for place, piece in enumerate(choice.fit.pieces):
        term = piece.term.with_cube if isinstance(piece.term, Coupling) else None
        if term is not None:
            choice = search.better(choice, reformed(choice.fit, place, term))
    return choice
