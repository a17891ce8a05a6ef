"""Names that explain so little of a mismatch that they are the form of the others."""

from collections.abc import Container, Mapping
from typing import NamedTuple

import numpy as np

from pipeline.discrepancy.judgement.brought_about import LATE, brought_about
from pipeline.discrepancy.judgement.verdict import mean_square, without
from pipeline.discrepancy.judgement.walking_zero import walks_far
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.weighing import Choice, names
from pipeline.physics.coulomb_friction import CoulombFriction
from pipeline.physics.friction import Friction
from pipeline.physics.slack import Slack

MANY = 3
FAINT_ZERO = 0.5
ALSO = (
    "The corrected simulation also has {said} of the mismatch: {why}, not for physics of its own."
)
SO_LITTLE = "so little is taken for the form of what is named"
BESIDE_BEYOND = "beside what has no name in the catalogue, that is taken for its form"
BROUGHT_ABOUT = (
    "that what it has itself shows more or less is taken for what the others bring about"
)


class Limit(NamedTuple):
    """Up to what a name is form: its share of the mismatch, that of all, and its size.

    Shares [1] and the size, over the noise, are RMS.
    """

    share: float
    together: float
    size: float = np.inf

    def holds(self, own: float, together: float, before: float, noise: float) -> bool:
        """Of mean squares: what a name explains, what all do, of the mismatch, and of the noise."""
        within = own <= self.share**2 * before and together <= self.together**2 * before
        return within and own < self.size**2 * noise


LEAST, FAINT = Limit(0.01, 0.02), Limit(0.025, 0.025, 0.35)
LATE_INSIDE, INSIDE = Limit(0.25, 0.25, 0.75), Limit(0.06, 0.06, 0.6)
UNWITNESSED, ANY = Limit(0.035, 0.05), Limit(np.inf, np.inf)


def names_of_form(explanation: Explanation, best: Choice, beyond: bool = False) -> dict[str, float]:
    """Names of the best choice that are the form of its others, and their shares of the mismatch.

    A real wire is never quite the term: of what that leaves, many samples make names sure that are
    not there. They stay in the corrected simulation, and are not told as physics. What such a name
    explains of the mismatch, calibration apart, is within the limit LEAST, or FAINT, which is too
    little to be told from form. The one that explains least is taken out first. Of a force against
    motion only a drift is one (`faint_zero`), and `slip_elements`: beside a weight or a spring,
    friction is small. What another name brings about is one however large (`brought_about`).

    beyond: whether one of them, or a snap, is more than the catalogue has a name for. Only the name
    is told then that explains most: the form of that is farther from the real thing than a term's.

    Where the simulation is a trace with a course in time of its own, terms act on what comes out of
    that, and what they stand for acts inside of it: they have another form there (INSIDE), and come
    a little early or late (LATE_INSIDE). Where no cycle repeats another, nothing says what noise
    is: what is taken for some may be more of such a form (UNWITNESSED), but for slack, which is of
    one with what else loads the joint. A zero that walks far is most of any mean square: beside it
    no share says anything.
    """
    if explanation.problem.derivatives is not None:
        return faint_zero(explanation, best) | slip_elements(explanation, best)
    if walks_far(explanation, best):
        return {}
    before, begun = mismatch_of(explanation, best), mean_square(explanation, best)
    noise, told, found = best.fit.ground.noise.deviation**2, best, {}
    while len(named(told)) > 1:
        formal, brought = [], brought_about(explanation, told)
        left_now = mean_square(explanation, told)
        for name in named(told):
            trial = told.but_for(name) if beyond else without(explanation, told, name)
            left = mean_square(explanation, trial)
            own = max(left - left_now, 0.0)
            free = beyond or name in brought
            repeats = explanation.prior.repeats > 0
            limits = [ANY] if free else limits_of(name, explanation.problem, repeats)
            if any(most.holds(own, left - begun, before, noise) for most in limits):
                formal.append((left, name, own, trial))
        if not formal:
            break
        _, name, own, told = min(formal, key=lambda f: f[0])
        found[name] = float(np.sqrt(own / before))
    return found


def named(choice: Choice) -> set[str]:
    """The names of a choice's pieces, but of what has none."""
    return {p.term.name for p in choice.fit.pieces if not p.term.nameless}


def limits_of(name: str, problem: Problem, repeats: bool) -> list[Limit]:
    """Within any of which a name is form beside others; repeats: whether any cycles repeat."""
    unwitnessed = [] if repeats or name == Slack.name else [UNWITNESSED]
    inside = [INSIDE] if moves_by_itself(problem) else []
    late = [LATE_INSIDE] if name in LATE and comes_late_by_itself(problem) else []
    return [LEAST, FAINT, *unwitnessed, *inside, *late]


def slip_elements(explanation: Explanation, best: Choice) -> dict[str, float]:
    """Slip elements of a force beside dry friction, which are that, and their share (RMS)."""
    if not {Friction.name, CoulombFriction.name} <= names(best):
        return {}
    own = mean_square(explanation, best.but_for(Friction.name)) - mean_square(explanation, best)
    before = max(mismatch_of(explanation, best), best.fit.ground.noise.deviation**2)
    return {Friction.name: float(np.sqrt(max(own, 0.0) / before))}


def faint_zero(explanation: Explanation, best: Choice) -> dict[str, float]:
    """A force's drift that explains less than FAINT_ZERO of a sample's noise (RMS), and its share.

    Noise of a force is not known by repeats: where the zero differs a little from cycle to cycle,
    any slow course follows some of that, and many samples make it sure.
    """
    blocks = explanation.problem.averaged
    noise = best.fit.ground.noise.deviation * np.sqrt(blocks.size if blocks is not None else 1)
    before, found = mismatch_of(explanation, best), {}
    for name in best.fit.slow:
        trial = best.but_for(name)
        own = mean_square(explanation, trial) - mean_square(explanation, best)
        if own < (FAINT_ZERO * noise) ** 2:
            found[name] = float(np.sqrt(max(own, 0.0) / max(before, noise**2)))
    return found


def moves_by_itself(problem: Problem) -> bool:
    """Whether the simulation has a course in time of its own."""
    return not problem.static or problem.own > 0.0 or problem.course is not None


def comes_late_by_itself(problem: Problem) -> bool:
    """Whether that course may be one in time: play and friction go by the way alone."""
    if problem.course is None:
        return moves_by_itself(problem)
    return any(piece.term.remembers == "time" for piece in problem.course.pieces)


def one_for_many(explanation: Explanation, best: Choice) -> Choice:
    """The best choice, or one name where that leaves hardly more than MANY names leave together.

    Beyond what they leave it leaves less than LEAST's share of the mismatch (RMS): its form, which
    they mop up, each in a course of its own.
    """
    if explanation.problem.derivatives is not None or len(names(best)) < MANY:
        return best
    most = mean_square(explanation, best) + LEAST.share**2 * mismatch_of(explanation, best)
    ones = [c for c in explanation.choices if len(names(c)) == 1]
    enough = [c for c in ones if mean_square(explanation, c) < most]
    return min(enough, key=lambda c: c.score, default=best)


def mismatch_of(explanation: Explanation, best: Choice) -> float:
    """Mean square of the mismatch that calibration leaves, beyond the noise beside the best."""
    base = next(c for c in explanation.choices if not c.fit.pieces)
    return mean_square(explanation, base) - best.fit.ground.noise.deviation**2


def form_note(
    formal: Mapping[str, float], about: Container[str], beyond: bool = False
) -> list[str]:
    """What the corrected simulation follows besides what is named, and by how much.

    about: names of what others bring about.
    """
    brought = {n: share for n, share in formal.items() if n in about}
    little = {n: share for n, share in formal.items() if n not in about}
    why = BESIDE_BEYOND if beyond else SO_LITTLE
    told = ((little, why), (brought, BROUGHT_ABOUT))
    return [ALSO.format(said=shares_in_words(some), why=why) for some, why in told if some]


def shares_in_words(shares: Mapping[str, float]) -> str:
    """Names with their shares of the mismatch."""
    return " and ".join(f"{name} ({100.0 * share:.1f} %)" for name, share in shares.items())
