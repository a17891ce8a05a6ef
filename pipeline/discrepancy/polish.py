"""Polish: deletions, swaps and richer forms of the best choice, and moves that no swap makes."""

import numpy as np

from pipeline.discrepancy.choose import (
    FAINT,
    MOST_TERMS,
    SAME,
    Choice,
    Key,
    Search,
    allowed,
    best_of_each,
    by_term,
    extended,
    grown,
)
from pipeline.discrepancy.fit import ITERATIONS, evaluate, improve, parameters_of
from pipeline.discrepancy.reform import reformed
from pipeline.discrepancy.screen import screen, started
from pipeline.physics.capstan_friction import CapstanFriction
from pipeline.physics.friction import Friction
from pipeline.physics.mechanism import Piece
from pipeline.physics.response_lag import ResponseLag

SHEATH = CapstanFriction("pretensioned")
WORTH, BEND = 150.0, "bend"
HOPED = 40.0
LEFT = ((0.65, 0.3), (0.5, 0.7))


def polished(search: Search, choices: list[Choice]) -> list[Choice]:
    """Richer forms, deletions and swaps of the best as long as it gets better.

    Where friction that is a share of the pull suits the best better than friction of one width, it
    is polished so as well: what mends the one form's error would hide the other.
    """
    best = min(choices, key=lambda c: c.score)
    alone = next((c for c in choices if c.fit.names == ("friction",)), best)
    found = _polished(search, best_of_each([*choices, loosened(search, alone)]))
    plain = min(
        (c for c in found if set(c.fit.names) == set(best.fit.names)), key=lambda c: c.score
    )
    sheath = sheathed(search, plain)
    if sheath is plain:
        return found
    return best_of_each([*found, *_polished(search, [*choices, sheath])])


def _polished(search: Search, choices: list[Choice]) -> list[Choice]:
    """A swap begins from the rest refitted, and from the rest as it stood beside the old term."""
    found = {c.fit.key: c for c in choices}
    tried: set[Key] = set()
    for _ in range(3):
        best = min(found.values(), key=lambda c: c.score)
        richest = loosened(search, lagging(search, merged(search, grown(search, best))))
        if richest is not best:
            found[richest.fit.key] = best = richest
        for piece in best.fit.pieces:
            rest = [p for p in best.fit.pieces if p is not piece]
            key = frozenset((p.term.name, p.term.form) for p in rest)
            if key in tried:
                continue
            tried.add(key)
            fit = improve(evaluate(best.fit.ground, rest))
            without = search.weighed(fit, best.place)
            if without.score < best.score + WORTH:
                without = grown(search, without)
            found[without.fit.key] = without
            if without.fit.key != key:
                found.setdefault(key, without)
            unmoved = evaluate(without.fit.ground, rest)
            for child in extended(search, without, 5, begun=[unmoved]):
                if child.fit.key not in found or child.score < found[child.fit.key].score:
                    found[child.fit.key] = child
        if min(found.values(), key=lambda c: c.score) is best:
            bent = unpromised(search, best)
            if bent is best:
                break
            found[bent.fit.key] = bent
    else:
        fewest = thinned(search, min(found.values(), key=lambda c: c.score))
        found[fewest.fit.key] = fewest
    return sorted(found.values(), key=lambda c: c.score)


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


def thinned(search: Search, choice: Choice) -> Choice:
    """The choice without the terms that earn nothing any more beside the others."""
    for piece in choice.fit.pieces:
        rest = [p for p in choice.fit.pieces if p is not piece]
        fewer = search.weighed(improve(evaluate(choice.fit.ground, rest)), choice.place)
        if fewer.score < choice.score:
            return thinned(search, fewer)
    return choice


def merged(search: Search, choice: Choice) -> Choice:
    """The choice with its lag, or all that comes late, as one lag of another form, if better.

    A creep beside a lag can follow what is one lag of second order, a frame that is old what a
    swinging joint beside a creep does, and one beside play a motor that is late; no swap of terms
    leads there.
    """
    late = [p for p in choice.fit.pieces if p.term.group == "lag" or p.term.name == "creep"]
    lag = next((p for p in late if p.term.group == "lag"), None)
    if lag is None or len(choice.fit.pieces) == 1:
        return choice
    alone = [p for p in choice.fit.pieces if p is lag or p not in late]
    for rest in (alone, choice.fit.pieces)[: len(late)]:
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
    if abs(search.plain.get(key, np.inf) - choice.score) < SAME:
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
        search.plain[key] = choice.score
    return choice


def sheathed(search: Search, choice: Choice) -> Choice:
    """The choice with friction of one width replaced by a share of the pull, if that is better."""
    for i, piece in enumerate(choice.fit.pieces):
        key = choice.fit.key | {(piece.term.name, SHEATH.form)}
        tried = abs(search.plain.get(key, np.inf) - choice.score) < SAME
        if isinstance(piece.term, Friction) and not tried:
            trial = search.weighed(reformed(choice.fit, i, SHEATH), choice.place)
            if trial.score < choice.score:
                return trial
            search.plain[key] = choice.score
    return choice
