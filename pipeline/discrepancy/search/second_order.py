"""What swings after each step: a lag of second order in place of all that comes late."""

from collections.abc import Sequence

from pipeline.discrepancy.fitting.effects import late
from pipeline.discrepancy.fitting.fit import Fit, evaluate, improve
from pipeline.discrepancy.fitting.ground import Ground
from pipeline.discrepancy.fitting.screen import screen, started
from pipeline.discrepancy.search.choose import by_term, extended
from pipeline.discrepancy.search.polish import polished
from pipeline.discrepancy.search.refuted import not_noise, worth_a_polish
from pipeline.discrepancy.search.weighing import MOST_TERMS, Choice, Search, best_of_each
from pipeline.physics.frame_lag import FrameLag
from pipeline.physics.piece import Piece
from pipeline.physics.second_order_lag import SecondOrderLag

SWINGING = SecondOrderLag()
BEGUN = 4
RESOLVED = 2.0  # times the finest step that the numbers tell apart


def swinging(search: Search, choices: list[Choice]) -> list[Choice]:
    """The choices (best first), with a lag of second order where what is left may be no noise.

    At a steady pace what swings is ahead of its command or behind it by about as much all the time:
    play comes near the one, nothing without inertia the other. So no first-order lag is on the way,
    and what was added beside play to mop up the rest is polished away. The lag takes the place of
    all that comes late, or stands beside it; beside an old frame what creeps may be a swing. Where
    nothing speaks against the noise, it only takes the place of a loop, if it is better at once.
    """
    best, known = choices[0], any(t.name == SWINGING.name for t in search.terms)
    behind = late(best.fit)
    other = [p for p in behind if p.term.name != FrameLag.name]
    lagging = any(p.term.group == SWINGING.group for p in other)
    creeps = len(other) < len(behind) and any(p.term.remembers == "time" for p in other)
    resolved = best.fit.ground.noise.deviation > RESOLVED * search.family.prior.finest
    if lagging:
        return with_old_frame(search, choices)
    if not (known and resolved):
        return choices
    rest = best.fit.without(*other)
    if not (creeps or unsure(search, best)):
        swung = search.better(best, begun(best.fit.ground, rest)) if other else best
        return choices if swung is best else polished(search, best_of_each([swung, *choices]))
    for beside in (rest, best.fit.pieces)[: 1 + bool(behind)]:
        swung = search.weighed(begun(best.fit.ground, beside), best.place)
        found = [swung, *extended(search, swung)] if len(beside) < MOST_TERMS else [swung]
        choices, before = best_of_each([*found, *choices]), choices[0]
        if choices[0] is not before and worth_a_polish(search, choices[0], before):
            choices = polished(search, choices)
        if not not_noise(search, choices[0]):
            break
    return choices


def with_old_frame(search: Search, choices: list[Choice]) -> list[Choice]:
    """The choices (best first), with an old frame beside a swing where that is better.

    An old frame and a lag without inertia are one in most motions, so that no search has both. A
    swing fitted without the frame may have gone where no step leads from: it is begun anew, too.
    """
    best = choices[0]
    old = [t for t in search.terms if t.name == FrameLag.name]
    key = (SWINGING.name, SWINGING.form)
    if key not in best.fit.key or len(best.fit.pieces) == MOST_TERMS:
        return choices
    leads = by_term(screen(best.fit, search.effects, old))
    trials = [improve(started(best.fit, few)) for few in leads]
    rest = best.fit.without(*(p for p in best.fit.pieces if p.term.name == SWINGING.name))
    trials += [begun(best.fit.ground, (*rest, Piece(few[0].term, few[0].values))) for few in leads]
    both = search.better(best, min(trials, key=lambda t: t.cost, default=best.fit))
    return choices if both is best else polished(search, best_of_each([both, *choices]))


def unsure(search: Search, choice: Choice) -> bool:
    """Whether what a choice leaves may be no noise.

    Noise that walks beside what was named takes swings as readily as a drift; jitter hides that it
    is too large, but not that cycles have something of it in common.
    """
    walks = bool(choice.fit.pieces) and choice.place[2] > 0
    return walks or not_noise(search, choice)


def begun(ground: Ground, beside: Sequence[Piece]) -> Fit:
    """The best fit of a lag of second order beside some terms."""
    starts = SWINGING.candidates(ground.problem.motion, ground.problem.around)
    trials = [evaluate(ground, [*beside, Piece(SWINGING, values)]) for values in starts]
    few = sorted(trials, key=lambda t: t.cost)[:BEGUN]
    return min((improve(trial) for trial in few), key=lambda t: t.cost)
