"""Growth: a choice with its terms in the forms that suit it, richer or plainer."""

from collections.abc import Container, Sequence

from pipeline.discrepancy.fitting.charge import complexity
from pipeline.discrepancy.fitting.reform import reformed
from pipeline.discrepancy.search.weighing import Choice, Search
from pipeline.physics.catalogue import richer, with_richer
from pipeline.physics.term import Term

EVEN = 1e-3


def grown(search: Search, choice: Choice, but: Container[str] = ()) -> Choice:
    """The choice with each term in the richer form that its score prefers, if any.

    but: names whose forms stay. A form that fits no better can't be worth its parameters; one that
    is better by rounding (EVEN) is as good. What is scanned for is looked for beside the form as it
    was: another one may have taken a part of it.
    """
    problem = choice.fit.ground.problem
    for i, piece in enumerate(choice.fit.pieces):
        begun = choice.fit
        for term in () if piece.term.name in but else richer(piece.term):
            key = choice.fit.key - {(piece.term.name, piece.term.form)} | {(term.name, term.form)}
            if search.tried_in_vain(key, choice):
                continue
            if not term.excited(problem.motion, problem.around):
                continue
            fit = reformed(begun if term.scanned else choice.fit, i, term)
            trial, behind = choice, max(complexity(fit) - complexity(choice.fit), 0.0)
            if fit.cost < choice.fit.cost - EVEN:
                trial = search.weighed(fit, choice.place)
                behind = trial.score - choice.score
            if trial.score < choice.score - EVEN:
                choice = trial
            else:
                search.vain[key] = choice.score, behind
    return choice


def simpler(search: Search, choice: Choice) -> Choice:
    """The choice with each term in a plainer form that its score prefers, if any.

    A form grown beside fewer terms may hold what another one explains by now.
    """
    for i, piece in enumerate(choice.fit.pieces):
        for term in plainer(search.terms, piece.term):
            key = choice.fit.key - {(piece.term.name, piece.term.form)} | {(term.name, term.form)}
            if search.tried_in_vain(key, choice):
                continue
            trial = search.weighed(reformed(choice.fit, i, term), choice.place)
            if trial.score < choice.score - EVEN:
                return simpler(search, trial)
            search.vain[key] = choice.score, trial.score - choice.score
    return choice


def plainer(terms: Sequence[Term], term: Term) -> list[Term]:
    """Forms of the same name, among some terms and what they grow to, that a term grew from."""
    known = with_richer(t for t in terms if t.name == term.name)
    return [t for t in known if any(r.form == term.form for r in richer(t) if r.name == t.name)]
