"""Moves from one explanation to another that no swap or added term makes."""

from collections.abc import Sequence
from itertools import combinations

from pipeline.discrepancy.fitting.effects import late
from pipeline.discrepancy.fitting.fit import ITERATIONS, Fit, evaluate, improve
from pipeline.discrepancy.fitting.reform import reformed
from pipeline.discrepancy.fitting.screen import screen, started
from pipeline.discrepancy.search.choose import allowed, by_term
from pipeline.discrepancy.search.growth import simpler
from pipeline.discrepancy.search.weighing import MOST_TERMS, Choice, Search
from pipeline.physics.capstan_friction import CapstanFriction
from pipeline.physics.catalogue import BEND, CARRYING, OFF_CENTRE, SHEATH_FORCES
from pipeline.physics.driven_slack import DrivenSlack
from pipeline.physics.friction import Friction
from pipeline.physics.lost_steps import TIMES, LostSteps
from pipeline.physics.piece import Piece
from pipeline.physics.second_order_lag import SecondOrderLag
from pipeline.physics.slack import Slack
from pipeline.physics.stiffness import Stiffness
from pipeline.physics.term import Term

SHEATH = CapstanFriction("pretensioned")
SPRING = Stiffness()
NEAR, AT_ONCE = 30.0, 0.01
STEPS = 3


def unpromised(search: Search, choice: Choice) -> Choice:
    """The choice with a bend of the curve besides, though no linear step promises any, if better.

    Other terms and the calibration take a bend's place; it shows only once they have moved.
    """
    fit = choice.fit
    bends = [t for t in search.terms if t.group == BEND]
    if not fit.pieces:
        return choice
    best = begun_with(search, fit, bends)
    return search.better(choice, improve(best, 8)) if search.may_beat(choice, best) else choice


def recurved(search: Search, choice: Choice) -> Choice:
    """The choice with another term in place of one or two that draw a static curve, if better.

    Two together come near what one draws, be it another bend or what neither resembles: beside the
    other of the two it gains little. And without a bend the other terms go astray before another
    takes its place; so they stay as they are until it has. Nor is a plain ripple on the way from it
    and a bend beside it to the wheel off its centre that both together draw.
    """
    found, off = choice, OFF_CENTRE.form
    curved = [p for p in choice.fit.pieces if curves(p.term)]
    for left_out in (*combinations(curved, 1), *combinations(curved, 2)):
        rest = choice.fit.without(*left_out)
        fit = evaluate(choice.fit.ground, rest)
        gone = {(p.term.name, p.term.form) for p in left_out}
        others = [t for t in search.terms if curves(t) and (t.name, t.form) not in gone]
        found = search.better(found, improve(begun_with(search, fit, others), 2 * ITERATIONS))
        turning = [k for k, p in enumerate(rest) if p.term.periodic and p.term.form != off]
        if turning and fit.ground.problem.derivatives is None:
            found = search.better(found, reformed(improve(fit), turning[0], OFF_CENTRE))
    return found


def unshifted(search: Search, choice: Choice) -> Choice:
    """The choice with a bend in place of a slip before nearly all rows, if that is better.

    Such a slip shifts a curve along its command, and so draws much of what a bend does: beside it
    no bend gains much, and one that stands there is the wrong one.
    """
    found, fit = choice, choice.fit
    times_s = fit.ground.problem.motion.time_s[fit.ground.used]
    first_s = times_s[int(AT_ONCE * len(times_s))]
    bends = [t for t in search.terms if t.group == BEND]
    for piece in fit.pieces:
        if not isinstance(piece.term, LostSteps):
            continue
        slips = piece.values.reshape(-1, 2)
        later = slips[slips[:, 1] > first_s]
        if len(later) == len(slips):
            continue
        pieces = [p for p in fit.without(piece) if p.term.group != BEND]
        if len(later):
            behind = piece.term.form.partition(" ")[2]
            form = f"{list(TIMES)[len(later) - 1]} {behind}".strip()
            pieces.append(Piece(LostSteps(form), later.ravel()))
        trial = begun_with(search, evaluate(fit.ground, pieces), bends)
        found = search.better(found, improve(trial, 2 * ITERATIONS))
    return found


def parted(search: Search, choice: Choice) -> Choice:
    """The choice with slack (and a bend) in place of what draws a static curve, if better.

    Together they are a curve that one ripple or bend of its own form comes near, so that neither
    gains much beside it, nor in its place without the other. Nor does slack at the joint where
    other loads move that, if it is the drive's.
    """
    fit, found, problem = choice.fit, choice, choice.fit.ground.problem
    slack = [t for t in search.terms if t.name == Slack.name]
    if Slack.name in fit.names or not slack:
        return choice
    bends = [t for t in search.terms if t.group == BEND]
    driven = [t for t in (DrivenSlack(),) if t.excited(problem.motion, problem.around)]
    for place, piece in enumerate(fit.pieces):
        if not curves(piece.term):
            continue
        rest = evaluate(fit.ground, fit.without(piece))
        alone = begun_with(search, rest, slack, [reformed(fit, place, t) for t in driven])
        both = begun_with(search, alone, bends) if len(fit.pieces) < MOST_TERMS else alone
        for trial in {id(t): t for t in (alone, both)}.values():
            found = search.better(found, improve(trial, 2 * ITERATIONS))
    return found


def begun_with(search: Search, fit: Fit, terms: Sequence[Term], other: Sequence[Fit] = ()) -> Fit:
    """The fit with the one of some terms that suits it best; it as it is where none may stand."""
    trials = trials_with(search, fit, terms, room=True)
    return min((*trials, *other), key=lambda t: t.cost, default=fit)


def trials_with(search: Search, fit: Fit, terms: Sequence[Term], room: bool = False) -> list[Fit]:
    """The fit with each of some terms that may stand there, after a few steps (see `started`)."""
    leads = by_term(screen(fit, search.effects, allowed(terms, fit)))
    return [improve(started(fit, few, room), STEPS, fit) for few in leads]


def curves(term: Term) -> bool:
    """Whether a term changes the static curve, as a bend, what holds the joint, or a ripple."""
    return term.group == BEND or term.name == Slack.name or term.holds or term.periodic


def merged(search: Search, choice: Choice) -> Choice:
    """The choice with its lag, or all that comes late, as one lag of another form, if better.

    A creep or play beside a lag can follow what is one lag of second order, a frame that is old
    what a swinging joint beside a creep does, and one beside play a motor that is late; no swap of
    terms leads there. What else was grown beside the lag of the old form may be plainer then.
    """
    behind = late(choice.fit)
    lag = next((p for p in behind if p.term.group == "lag"), None)
    if lag is None or len(choice.fit.pieces) == 1:
        return choice
    alone = [p for p in choice.fit.pieces if p is lag or p not in behind]
    for rest in (alone, choice.fit.pieces)[: len(behind)]:
        fit, place = evaluate(choice.fit.ground, rest), [p is lag for p in rest].index(True)
        for form in ("second", "motor"):
            if lag.term.form != form:
                trial = search.weighed(reformed(fit, place, SecondOrderLag(form)), choice.place)
                if trial.score < choice.score + NEAR:
                    trial = simpler(search, trial)
                choice = min(choice, trial, key=lambda c: c.score)
    return choice


def sheathed(search: Search, choice: Choice) -> Choice:
    """The choice with friction of one width replaced by a share of the pull, if that is better.

    Or by a bristle at the drive that carries the joint on: begun with, it would hide what else is
    there, as it comes near lags and play beside friction.
    """
    if choice.fit.ground.problem.derivatives is not None:
        return sheathed_force(search, choice)
    found = choice
    for i, piece in enumerate(choice.fit.pieces):
        for term in (SHEATH, CARRYING) if isinstance(piece.term, Friction) else ():
            key = choice.fit.key | {(piece.term.name, term.form)}
            if not search.tried_in_vain(key, choice):
                trial = search.weighed(reformed(choice.fit, i, term), choice.place)
                if trial.score >= choice.score:
                    search.vain[key] = choice.score, trial.score - choice.score
                found = min(found, trial, key=lambda c: c.score)
    return found


def sheathed_force(search: Search, choice: Choice) -> Choice:
    """The choice with a sheath's friction beside a spring in place of dry friction, if better.

    Neither is of use without the other where nothing simulated stands for the spring.
    """
    ground = choice.fit.ground
    motion, around = ground.problem.motion, ground.problem.around
    rest = [
        p for p in choice.fit.pieces if p.term.remembers != "way" and p.term.name != SPRING.name
    ]
    trials = []
    for term in (t for t in SHEATH_FORCES if t.excited(motion, around)):
        starts = [
            evaluate(ground, [*rest, Piece(term, values), Piece(SPRING, share * values[:1])])
            for values in term.candidates(motion, around)
            for share in (0.0, 1.0)
        ]
        starts.sort(key=lambda t: t.cost)
        trials += [improve(t, ITERATIONS) for t in starts[:3]]
    if not trials:
        return choice
    fit = improve(min(trials, key=lambda t: t.cost), 2 * ITERATIONS)
    return min(choice, search.weighed(fit, choice.place), key=lambda c: c.score)
