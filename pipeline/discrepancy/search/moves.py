"""Moves from one explanation to another that no swap or added term makes."""

import numpy as np

from pipeline.discrepancy.fitting.fit import ITERATIONS, evaluate, improve, parameters_of
from pipeline.discrepancy.fitting.reform import reformed
from pipeline.discrepancy.fitting.screen import late, screen, started
from pipeline.discrepancy.search.choose import (
    FAINT,
    MOST_TERMS,
    Choice,
    Search,
    allowed,
    by_term,
    grown,
)
from pipeline.physics.capstan_friction import CapstanFriction
from pipeline.physics.catalogue import BEND, SHEATH_FORCES
from pipeline.physics.compliance import Compliance
from pipeline.physics.contact import Contact
from pipeline.physics.end_stop import EndStop
from pipeline.physics.friction import Friction
from pipeline.physics.mechanism import Piece
from pipeline.physics.response_lag import ResponseLag
from pipeline.physics.stiffness import Stiffness

SHEATH = CapstanFriction("pretensioned")
SPRING = Stiffness()
TOE = Compliance("toe")
HOPED = 40.0
LEAST_LEFT, FIRM = 0.05, 50.0
LEFT = ((0.65, 0.3), (0.5, 0.7))


def unpromised(search: Search, choice: Choice) -> Choice:
    """The choice with a bend of the curve besides, though no linear step promises any, if better.

    Other terms and the calibration take a bend's place; it shows only once they have moved.
    """
    fit = choice.fit
    bends = [t for t in allowed(search.terms, fit) if t.group == BEND]
    if not fit.pieces:
        return choice
    trials = [
        improve(started(fit, few), 3, fit) for few in by_term(screen(fit, search.effects, bends))
    ]
    best = min(trials, key=lambda t: t.cost, default=fit)
    if choice.score - search.hoped(best, choice.place) <= -FAINT:
        return choice
    return min(choice, search.weighed(improve(best, 8), choice.place), key=lambda c: c.score)


def merged(search: Search, choice: Choice) -> Choice:
    """The choice with its lag, or all that comes late, as one lag of another form, if better.

    A creep or play beside a lag can follow what is one lag of second order, a frame that is old
    what a swinging joint beside a creep does, and one beside play a motor that is late; no swap of
    terms leads there.
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
                trial = search.weighed(reformed(fit, place, ResponseLag(form)), choice.place)
                choice = min(choice, trial, key=lambda c: c.score)
    return choice


def lagging(search: Search, choice: Choice) -> Choice:
    """The choice with a lag in place of a creep at the largest of its shares, if that is better.

    Such a creep, with what mends it, is a lag of the whole motion; no swap of one term leads there.
    """
    for creep in (p for p in choice.fit.pieces if p.term.name == "creep"):
        if creep.values[0] >= parameters_of(choice.fit.ground, creep.term)[0].high:
            rest = [p for p in choice.fit.pieces if p is not creep and p.term.group != "lag"]
            lag = Piece(ResponseLag(), creep.values[1:2])
            fit = improve(evaluate(choice.fit.ground, [*rest, lag]))
            return min(choice, search.weighed(fit, choice.place), key=lambda c: c.score)
    return choice


def stopped(search: Search, choice: Choice) -> Choice:
    """The choice with end stops in place of all contacts as stiff as one can be, if better.

    Where a stop is met beside other terms that were fitted to the contact, no swap leads there. A
    contact on the other side may prove as stiff only then.
    """
    fit = choice.fit
    motion, around = fit.ground.problem.motion, fit.ground.problem.around
    for contact in choice.fit.pieces:
        if isinstance(contact.term, Contact) and contact.term.limit(contact.values):
            stop = EndStop("upper" if contact.term.side > 0.0 else "lower")
            if (stop.name, stop.form) in fit.key:
                return choice
            rest = [p for p in fit.pieces if p.term is not contact.term]
            starts = stop.candidates(motion, around)
            met = np.vstack([starts, [contact.values[1], *starts[0, 1:]]])
            trials = [evaluate(fit.ground, [*rest, Piece(stop, values)]) for values in met]
            best = sorted(trials, key=lambda t: t.cost)[:3]
            fit = min((improve(t, ITERATIONS) for t in best), key=lambda f: f.cost)
    if fit is choice.fit:
        return choice
    trial = search.weighed(fit, choice.place)
    return stopped(search, trial) if trial.score < choice.score else choice


def tautened(search: Search, choice: Choice) -> Choice:
    """The choice with a toe in place of slack in whose middle the wires still pull, if better.

    They are no more than soft there; no swap of one term leads to the toe that is as soft.
    """
    bent = any(p.term.group == BEND for p in choice.fit.pieces)
    for slack in (p for p in choice.fit.pieces if p.term.name == "slack" and not bent):
        width, rounding, own = slack.values[0], slack.values[-2], slack.values[-1]
        left = 2.0 / (1.0 + np.exp(min(0.5 * width / max(rounding, 1e-12), FIRM)))
        if left > LEAST_LEFT:
            slope = abs(choice.fit.ground.problem.curve.slope)
            pull = slope * rounding * (np.log(2.0) - np.log1p(np.exp(-width / rounding)))
            softness = 2.0 * own * (1.0 - left) / left
            toe = np.array([softness, pull / (2.0 * own * np.log(2.0)), own, 2.0 * own])
            rest = [p for p in choice.fit.pieces if p is not slack]
            box = choice.fit.ground.box(TOE)
            wire = Piece(TOE, np.clip(toe, box.low, box.high))
            fit = improve(evaluate(choice.fit.ground, [*rest, wire]), 2 * ITERATIONS)
            return min(choice, search.weighed(fit, choice.place), key=lambda c: c.score)
    return choice


def loosened(search: Search, choice: Choice) -> Choice:
    """The choice with a part of its friction's loop left to slack, if that is better.

    Friction holds the joint between its loose wires: about as much as these are slack, the loop is
    wider. No small step leads from friction alone to both.
    """
    slack = next((t for t in search.terms if t.name == "slack"), None)
    full = len(choice.fit.pieces) >= MOST_TERMS
    if slack is None or full or "slack" in choice.fit.names:
        return choice
    ground, key = choice.fit.ground, choice.fit.key | {("slack", slack.form)}
    if search.tried_in_vain(key, choice):
        return choice
    problem = ground.problem
    for friction in (p for p in choice.fit.pieces if isinstance(p.term, Friction)):
        rest = [p for p in choice.fit.pieces if p is not friction]
        width, reach = friction.values[:2]
        trials = []
        for own, spread in LEFT:
            loose = slack.candidates(problem.motion, problem.around)[0]
            loose[0] = 1.4 * (1.0 - own) * width / max(abs(problem.curve.slope), 1e-12)
            loose[-1] = 0.02
            held = Piece(Friction(), np.array([own * width, own * reach, spread]))
            trials.append(improve(evaluate(ground, [*rest, held, Piece(slack, loose)]), 4))
        fit = improve(min(trials, key=lambda t: t.cost), 2 * ITERATIONS)
        if fit.cost < choice.fit.cost + HOPED:
            trial = grown(search, search.weighed(fit, choice.place))
            if trial.score < choice.score:
                return trial
        search.vain[key] = choice.score
    return choice


def sheathed(search: Search, choice: Choice) -> Choice:
    """The choice with friction of one width replaced by a share of the pull, if that is better."""
    if choice.fit.ground.problem.derivatives is not None:
        return sheathed_force(search, choice)
    for i, piece in enumerate(choice.fit.pieces):
        key = choice.fit.key | {(piece.term.name, SHEATH.form)}
        if isinstance(piece.term, Friction) and not search.tried_in_vain(key, choice):
            trial = search.weighed(reformed(choice.fit, i, SHEATH), choice.place)
            if trial.score < choice.score:
                return trial
            search.vain[key] = choice.score
    return choice


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
