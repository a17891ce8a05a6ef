"""A term with its parameters: what a mechanism is made of."""

from dataclasses import dataclass

import numpy as np

from pipeline.physics.term import Term


@dataclass(frozen=True, eq=False)
class Piece:
    """A term with its parameters, shape (p,), in the term's order; equal to itself alone."""

    term: Term
    values: np.ndarray

    @property
    def key(self) -> str:
        """Under which name its state is carried."""
        return f"{self.term.name}/{self.term.form}"
