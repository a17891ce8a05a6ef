"""Terms in their plainest forms to begin from again, where richer ones went astray."""

from pipeline.discrepancy.fitting.fit import ITERATIONS, Fit, improve
from pipeline.discrepancy.fitting.reform import reformed
from pipeline.discrepancy.search.polish import polished
from pipeline.discrepancy.search.refuted import refuted
from pipeline.discrepancy.search.weighing import Choice, Search, best_of_each


def begun_plainly(search: Search, choices: list[Choice]) -> list[Choice]:
    """The choices (best first), and what the best one's names lead to from their plainest forms.

    A form that grew beside too few terms does a part of what others would, and noise that walks
    the rest: no single swap leads from there. So they are begun again where the zero walks beside
    rich forms, under noise that does not; not where repeats say that no noise is what is left.
    """
    best = choices[0]
    forced = best.fit.ground.problem.derivatives is not None
    if best.place[2] == 0 or forced or refuted(search, best):
        return choices
    plain = in_plain_forms(search, best.fit)
    if plain is best.fit:
        return choices
    still = search.weighed(improve(plain, 2 * ITERATIONS), (best.place[0], 0, 0))
    return best_of_each([*choices, *polished(search, [still])])


def in_plain_forms(search: Search, fit: Fit) -> Fit:
    """The fit with each term in that form which a search begins with and that suits it best."""
    usual = {(t.name, t.form) for t in search.terms}
    for k, piece in enumerate(fit.pieces):
        own = [t for t in search.terms if (t.name, t.side) == (piece.term.name, piece.term.side)]
        if own and (piece.term.name, piece.term.form) not in usual:
            fit = min((reformed(fit, k, term) for term in own), key=lambda f: f.cost)
    return fit
