"""From terms named in a configuration to pieces of a mechanism."""

from collections.abc import Mapping

from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from pipeline.physics.term import Surroundings, values_of


def pieces_of(
    named: Mapping[str, Mapping[str, float]],
    around: Surroundings,
    usual: Surroundings | None = None,
) -> list[Piece]:
    """A piece for each entry: the catalogue's name (or name/form) and its parameters by name.

    Parameters that aren't given stand at their starts (see `values_of`). Raises TermError for a
    term or parameter that physics does not have.
    """
    pieces = []
    for key, given in named.items():
        name, _, form = key.partition("/")
        physics = term(name, form, list(around.other_span))
        pieces.append(Piece(physics, values_of(physics, around, given, usual)))
    return pieces
