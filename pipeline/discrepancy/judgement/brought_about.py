"""What other names bring about: more or less of a loop that the simulation runs itself."""

from pipeline.discrepancy.judgement.verdict import mean_square
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.equivalents import equivalents
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.weighing import Choice, names
from pipeline.physics.own_amount import OwnAmount

FIRM, MUCH_MORE = 0.7, 10.0
LATE = frozenset({"creep", "frame_lag", "response_lag"})
LOOPS = LATE | {"friction"}
GIVE_WAY = frozenset({"compliance", "slack"})


def brought_about(explanation: Explanation, choice: Choice) -> frozenset[str]:
    """Names by which a simulation's own loop is wider or narrower, as others bring about.

    A wire that gives way more or less, or hangs slack, lets the same friction, creep or lag show
    more or less, if it surely does. And what comes late in another way than the simulation's takes
    the place of that.
    """
    told = names(choice)
    found = {n for n in told if told - {n} and follows_from_others(n, choice)}
    if told & GIVE_WAY:
        most = by_giving_way(explanation, choice)
        found = {n for n in found if explained_by(explanation, choice, n) < most}
    return frozenset(found)


def by_giving_way(explanation: Explanation, choice: Choice) -> float:
    """The most of a loop (mean square) that a wire which gives way or hangs slack may bring about.

    A loop is much more visible than what a wire does by itself, which calibration takes the most
    of, but no more than MUCH_MORE (RMS). Nothing where that is less than FIRM of the noise: it may
    itself be the form of more friction or lag.
    """
    some = names(choice) & GIVE_WAY
    most = max(explained_by(explanation, choice, name) for name in some)
    firm = most > (FIRM * choice.fit.ground.noise.deviation) ** 2
    return MUCH_MORE**2 * most if firm else 0.0


def explained_by(explanation: Explanation, choice: Choice, name: str) -> float:
    """What a name explains beside the others (mean square)."""
    left = mean_square(explanation, choice.but_for(name))
    return left - mean_square(explanation, choice)


def follows_from_others(name: str, choice: Choice) -> bool:
    """Whether others of a choice may bring about what is told by a name."""
    told = [p for p in choice.fit.pieces if p.term.name == name]
    others = names(choice) - {name}
    own = all(isinstance(p.term, OwnAmount) for p in told)
    if others & GIVE_WAY:
        return own or more_of_its_own(name, choice.fit.ground.problem)
    less = own and all(p.values[0] < 0.0 for p in told)
    return bool(less and name in LATE and others & LATE)


def more_of_its_own(name: str, problem: Problem) -> bool:
    """Whether a simulation has something of that name itself, or what is like it in such data."""
    has = set() if problem.course is None else {p.term.name for p in problem.course.pieces}
    like = {name, *equivalents(name, problem)} | (LATE if name in LATE else set())
    return bool(has & like & LOOPS and name in LOOPS)
