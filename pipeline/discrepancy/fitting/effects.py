"""Effects: what every candidate of every term does to the nominal mechanism, beside any fit."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from pipeline.discrepancy.fitting.fit import Fit
from pipeline.discrepancy.fitting.ground import Ground
from pipeline.discrepancy.noise.serial import TOLERANCE
from pipeline.discrepancy.problem.problem import Problem
from pipeline.physics.piece import Piece
from pipeline.physics.term import Term
from pipeline.recording import branch_of

SCALES = (0.01, 8.0)
PERIOD = 1


@dataclass(frozen=True)
class Effects:
    """What every candidate of every term does to the nominal mechanism.

    places: term and values of each candidate. columns: (n, k) change of the seen angle. sized: (k,)
    whether each has a size to scale.
    """

    places: Sequence[tuple[Term, np.ndarray]]
    columns: np.ndarray
    sized: np.ndarray
    _last: list["Whitened"] = field(default_factory=list, repr=False, compare=False)

    def under(self, ground: Ground) -> "Whitened":
        """The effects under a ground's noise; those of the last one are kept."""
        if not (self._last and self._last[0].ground is ground):
            self._last[:] = [Whitened(self, ground)]
        return self._last[0]

    @cached_property
    def of_form(self) -> dict[tuple[str, str], np.ndarray]:
        """Which candidates each term and form has, by its name and form."""
        found: dict[tuple[str, str], list[int]] = {}
        for k, (term, _) in enumerate(self.places):
            found.setdefault((term.name, term.form), []).append(k)
        return {form: np.array(few) for form, few in found.items()}

    @cached_property
    def periods(self) -> dict[tuple[str, str], np.ndarray]:
        """Of each periodic term and form the candidates of each period, (periods, phases)."""
        found = {}
        for form, few in self.of_form.items():
            if self.places[few[0]][0].periodic:
                period = np.array([self.places[k][1][PERIOD] for k in few])
                found[form] = np.array([few[period == p] for p in dict.fromkeys(period.tolist())])
        return found

    def promising(
        self, fit: Fit, terms: Sequence[Term], most: int
    ) -> list[tuple[Term, np.ndarray]]:
        """The candidates of each term whose nominal effect suits a fit's residual best.

        Where the fit answers late, nominal effects have the wrong phase on either way: of what has
        one, those are kept whose period suits best in any phase.
        """
        allowed = {(t.name, t.form) for t in terms}
        wanted = [form for form in self.of_form if form in allowed]
        if not wanted:
            return []
        first, last = self.of_form[wanted[0]][0], self.of_form[wanted[-1]][-1]
        here, behind = self.under(fit.ground), bool(late(fit))
        gains = here.gains(fit, slice(first, last + 1))
        chosen: list[int] = []
        for form in wanted:
            few = self.of_form[form]
            if form in self.periods and behind:
                best = np.argsort(here.gains_in_any_phase(fit, form))[::-1][:most]
                chosen += self.periods[form][best].ravel().tolist()
            else:
                chosen += few[np.argsort(-gains[few - first], kind="stable")[:most]].tolist()
        return [self.places[k] for k in chosen]


@dataclass(frozen=True)
class Whitened:
    """Effects under a ground's noise."""

    effects: Effects
    ground: Ground

    @cached_property
    def columns(self) -> np.ndarray:
        """The effects, whitened, (count, k)."""
        return self.ground.whiten(self.effects.columns)

    @cached_property
    def squares(self) -> np.ndarray:
        """Their squared lengths, (k,)."""
        return squares_of(self.columns)

    @cached_property
    def ways(self) -> dict[tuple[str, str], tuple[np.ndarray, np.ndarray]]:
        """Of each periodic term its waves on either way of the drive alone, whitened.

        By name and form: columns (count, periods * w), and their inner products by period,
        (periods, w, w). A wave and one in quadrature have every phase: every other phase will do.
        """
        up = branch_of(self.ground.problem.motion.drive)[:, None] > 0
        found = {}
        for form, alike in self.effects.periods.items():
            columns = self.effects.columns[:, alike[:, ::2].ravel()]
            both = np.stack([columns * up, columns * ~up], axis=2).reshape(len(up), -1)
            white = self.ground.whiten(both)
            parts = white.reshape(len(white), len(alike), -1).transpose(1, 2, 0)
            found[form] = white, parts @ parts.transpose(0, 2, 1)
        return found

    def gains(self, fit: Fit, span: slice) -> np.ndarray:
        """How much each of some effects could gain beside a fit, (k,)."""
        sized, columns = self.effects.sized[span], self.columns[:, span]
        return stepped_along(fit, sized, columns, self.squares[span], float(fit.nuisance[0]))[0]

    def gains_in_any_phase(self, fit: Fit, form: tuple[str, str]) -> np.ndarray:
        """How much each period of a periodic term could gain, each way in its own phase.

        A late answer to a wave is that wave in another phase on either way of the drive.
        """
        white, inner = self.ways[form]
        taken, along = beside(fit, white)
        parts = taken.reshape(len(taken), len(inner), -1).transpose(1, 2, 0)
        left = inner - parts @ parts.transpose(0, 2, 1)
        lengths = np.sqrt(np.maximum(np.diagonal(left, axis1=1, axis2=2), np.finfo(float).tiny))
        values, vectors = np.linalg.eigh(left / (lengths[:, :, None] * lengths[:, None, :]))
        turned = ((along.reshape(lengths.shape) / lengths)[:, None, :] @ vectors)[:, 0]
        strong = values > TOLERANCE
        return np.asarray(
            np.sum(np.where(strong, turned**2 / np.where(strong, values, 1.0), 0.0), axis=1)
        )


def effects_of(problem: Problem, terms: Sequence[Term]) -> Effects:
    """The nominal effects of all candidates of some terms."""
    nominal = problem.trace(()).seen
    places = [(t, v) for t in terms for v in t.candidates(problem.motion, problem.around)]
    columns = np.empty((len(nominal), len(places)))
    for k, (term, values) in enumerate(places):
        columns[:, k] = problem.trace((Piece(term, values),)).seen - nominal
    return Effects(places, columns, sized_of(places))


def late(fit: Fit) -> list[Piece]:
    """The pieces behind which its answer comes late on either way."""
    return [p for p in fit.pieces if p.term.remembers and not p.term.adds]


def gains_of(fit: Fit, sized: np.ndarray, columns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Fall of the cost by one step along each column (n, k), and that step's factor."""
    white = fit.ground.whiten(columns)
    return stepped_along(fit, sized, white, squares_of(white))


def stepped_along(
    fit: Fit, sized: np.ndarray, white: np.ndarray, squares: np.ndarray, scale: float = 1.0
) -> tuple[np.ndarray, np.ndarray]:
    """Fall of the cost by one step along each whitened column times scale, and that step's factor.

    The factor is the step's coefficient as far as a term can follow it, 1 where it has no size.
    squares: (k,) the columns' squared lengths.
    """
    taken, along = beside(fit, white)
    size = scale**2 * (squares - squares_of(taken))
    along = scale * along
    moves = size > 1e-9
    coefficient = along / np.where(moves, size, 1.0)
    followed = np.where(coefficient > 0.0, 1.0, -1.0) * np.clip(np.abs(coefficient), *SCALES)
    factor = np.where(sized & moves, followed, 1.0)
    return np.where(moves, 2.0 * factor * along - factor**2 * size, 0.0), factor


def beside(fit: Fit, white: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Parts of whitened columns (count, k) along what a fit can follow already, and its residual.

    The latter of what is left of them beside the former: (m, k) and (k,).
    """
    basis, known = fit.takes_over
    taken = basis.T @ white
    return taken, fit.innovations @ white - known @ taken


def squares_of(columns: np.ndarray) -> np.ndarray:
    """Squared length of each column of (m, k), (k,)."""
    return np.asarray(np.einsum("ij,ij->j", columns, columns))


def sized_of(places: Sequence[tuple[Term, np.ndarray]]) -> np.ndarray:
    """Whether each term with its values has a size to scale, a mask."""
    same = [np.array_equal(term.scaled(values, 2.0), values) for term, values in places]
    return ~np.array(same, dtype=bool)
