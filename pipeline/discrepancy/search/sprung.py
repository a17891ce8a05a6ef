"""A damper behind a spring in place of dry friction: one remembers time, the other travel."""

from pipeline.discrepancy.fitting.reform import reformed
from pipeline.discrepancy.search.choose import choose, extended
from pipeline.discrepancy.search.polish import polished
from pipeline.discrepancy.search.weighing import Choice, Search, among, best_of_each
from pipeline.physics.catalogue import LATE_DAMPER, SPRUNG
from pipeline.physics.coulomb_friction import CoulombFriction


def sprung(search: Search, choices: list[Choice]) -> list[Choice]:
    """The choices (best first); of a force also those with a damper behind a spring.

    At one speed it is a bristle, so either takes the other's place at the first step of a search
    and no later step leads back: it is looked for without dry friction, and in the place of the
    best one's damper, and polished with all. A damper that is simulated may stand behind one, too:
    that is looked for beside dry friction as well.
    """
    base = next(c for c in choices if not c.fit.pieces)
    problem = base.fit.ground.problem
    if problem.motion.kinetics is None:
        return choices
    without = tuple(t for t in search.terms if t.remembers != "way")
    dampers = tuple(t for t in (SPRUNG, LATE_DAMPER) if t.excited(problem.motion, problem.around))
    found = choose(among(search, problem, (*without, *dampers)), base.fit.ground)
    best = choices[0]
    for k, piece in enumerate(best.fit.pieces):
        if piece.term.name == SPRUNG.name:
            found = [*found, search.weighed(reformed(best.fit, k, SPRUNG), best.place)]
    if LATE_DAMPER in dampers:
        late = among(search, problem, (LATE_DAMPER,))
        for parent in extended(among(search, problem, (CoulombFriction(),)), base):
            found += extended(late, parent)
    both = polished(among(search, problem, (*search.terms, *dampers)), found)
    return best_of_each([*choices, *both])
