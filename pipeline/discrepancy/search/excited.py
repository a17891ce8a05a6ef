"""What a recording could have shown: the terms to look for, and the names that it could not."""

from pipeline.discrepancy.problem.problem import Problem
from pipeline.physics.catalogue import LATE, force_terms, further_force_terms, terms
from pipeline.physics.own_amount import OWN_AMOUNTS
from pipeline.physics.term import Term


def excited_terms(problem: Problem) -> tuple[Term, ...]:
    """Terms that these commands could have shown; outliers are found otherwise.

    What depends on a shaft's angle can't be put into a trace that mixes several of them.
    """
    angle = problem.motion.kinetics is None
    every = (*terms(problem.motion.others), *OWN_AMOUNTS) if angle else force_terms()
    return tuple(
        t
        for t in every
        if t.excited(problem.motion, problem.around)
        and t.name != "marker_outliers"
        and not (problem.mixed and t.periodic)
    )


def further_terms(problem: Problem) -> tuple[Term, ...]:
    """Those of `further_force_terms` that a force's motion could have shown; none of an angle."""
    found = further_force_terms() if problem.motion.kinetics is not None else ()
    return tuple(t for t in found if t.excited(problem.motion, problem.around))


def not_excited(problem: Problem) -> tuple[str, ...]:
    """Names of the catalogue that this recording could not have shown."""
    every = {t.name for t in (*terms(problem.motion.others), *force_terms())} | {"coupling"}
    shown = {t.name for t in (*excited_terms(problem), *further_terms(problem))}
    shown |= {"marker_outliers", *(t.name for t in LATE if problem.motion.kinetics is not None)}
    return tuple(sorted(every - shown))
