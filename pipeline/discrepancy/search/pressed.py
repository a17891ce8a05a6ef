"""What a search of a force begins too plainly for: richest dry friction, a gain that is a term."""

import numpy as np

from pipeline.discrepancy.fitting.charge import absurd_calibration
from pipeline.discrepancy.fitting.fit import Fit, evaluate, improve, parameters_of
from pipeline.discrepancy.fitting.reform import reformed
from pipeline.discrepancy.search.polish import polished
from pipeline.discrepancy.search.weighing import Choice, Search, best_of_each
from pipeline.physics.catalogue import PRESSED, SPRUNG, with_richer
from pipeline.physics.coulomb_friction import CoulombFriction
from pipeline.physics.piece import Piece
from pipeline.physics.term import Term

BEYOND, SAME = 10.0, 0.3
MOST_BEGUN = 3
STATIC = frozenset({"stiffness", "contact", "gravity", "viscous_friction"})


def pressed(search: Search, choices: list[Choice]) -> list[Choice]:
    """The choices (best first); of a force also those with dry friction in its richest forms.

    They can do a part of what dampers and Stribeck's friction do, and would take their place from
    the start. Beside terms that mend what a plainer form leaves none of them promises much: so
    they are tried in the place of the best one's dry friction, beside the best one's other terms
    and without those that a form too plain draws in, and polished with all.
    """
    best = choices[0]
    if best.fit.ground.problem.motion.kinetics is None:
        return choices
    found = []
    for fit in bare(best):
        for k, piece in enumerate(fit.pieces):
            if isinstance(piece.term, CoulombFriction):
                found += [search.weighed(reformed(fit, k, t), best.place) for t in PRESSED]
    choices = best_of_each([*choices, *found])
    begun = [choices[0], *sorted(found, key=lambda c: c.score)[:MOST_BEGUN]]
    taken = min((taken_back(search, c) for c in begun), key=lambda c: c.score)
    if min(choices[0].score, taken.score) < best.score - BEYOND:
        choices = best_of_each([*choices, *polished(search, [*choices, taken])])
    return best_of_each([*choices, plainer(search, choices[0])])


def bare(choice: Choice) -> list[Fit]:
    """The fit of a choice, and that without what too plain a form of dry friction draws in."""
    fit = choice.fit
    kept = [
        p
        for p in fit.pieces
        if isinstance(p.term, CoulombFriction)
        or (p.term.name in STATIC and p.term.form != SPRUNG.form)
    ]
    if len(kept) == len(fit.pieces):
        return [fit]
    return [fit, improve(evaluate(fit.ground, kept))]


def plainer(search: Search, choice: Choice) -> Choice:
    """The choice with terms in plainer forms that their score prefers, once the others moved.

    A form is plainer that has some of the parameters, and no other.
    """
    ground, every = choice.fit.ground, with_richer((*search.terms, *PRESSED))

    def names_of(term: Term) -> set[str]:
        return {p.name for p in parameters_of(ground, term)}

    for k, piece in enumerate(choice.fit.pieces):
        own = names_of(piece.term)
        for term in (t for t in every if t.name == piece.term.name and names_of(t) < own):
            trial = search.weighed(reformed(choice.fit, k, term), choice.place)
            if trial.score < choice.score:
                return plainer(search, trial)
    return choice


def taken_back(search: Search, choice: Choice) -> Choice:
    """The choice with a term in place of a gain that no calibration has, if that is better.

    A simulation that is one term is mended by its gain as well as by that term, which no linear
    step tells apart: so where a term is most of the simulation, it begins with what the gain did.
    """
    fit = choice.fit
    ground, simulated = fit.ground, fit.ground.problem.simulated
    if absurd_calibration(fit) is None:
        return choice
    found = [choice]
    for (term, values), column in zip(search.effects.places, search.effects.columns.T, strict=True):
        own = column - column.mean()
        factor = float(own @ simulated) / max(float(own @ own), 1e-300)
        if len(values) > 1 or np.std(simulated - factor * own) > SAME * np.std(simulated):
            continue
        beside = [p for p in fit.pieces if p.term.name != term.name]
        before = sum(p.values[:1] for p in fit.pieces if p.term.name == term.name)
        piece = Piece(term, before + factor * values * (fit.nuisance[0] - 1.0))
        found.append(search.weighed(improve(evaluate(ground, [*beside, piece])), choice.place))
    return min(found, key=lambda c: c.score)
