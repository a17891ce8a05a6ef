"""One damper behind a spring in place of two: a rigid one, and the lag of a simulated one."""

from pipeline.discrepancy.fitting.fit import evaluate
from pipeline.discrepancy.fitting.reform import reformed
from pipeline.discrepancy.search.weighing import Choice, Search
from pipeline.physics.catalogue import LATE_DAMPER, SPRUNG


def one_damper(search: Search, choice: Choice) -> Choice:
    """The choice with a damper of its own behind a spring in place of two others, if better.

    What a simulated damper lacks behind a spring, beside a rigid damper of the same size, is one
    damper behind a spring; no swap of a single term leads from the two to the one.
    """
    rest = [p for p in choice.fit.pieces if p.term.name != SPRUNG.name]
    late = [k for k, p in enumerate(rest) if p.term.form == LATE_DAMPER.form]
    if not late or len(rest) == len(choice.fit.pieces):
        return choice
    fit = evaluate(choice.fit.ground, rest)
    return search.better(choice, reformed(fit, late[0], SPRUNG))
