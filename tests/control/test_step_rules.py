import itertools

import pytest

from pipeline.config import (
    STEP_RULES,
    ArmijoConfig,
    BarzilaiBorweinConfig,
    ConstantConfig,
    DiminishingConfig,
    NewtonConfig,
    StepRuleConfig,
)
from pipeline.control.step_rules import RULES, Point, StepRule, step_rule
from pipeline.errors import UsageError


def line(slope: float, root: float = 3.0):
    """Point of a straight branch with its target at the command `root`."""
    return lambda command: Point(command, slope * (command - root), slope)


def errors(rule: StepRule, slope: float, steps: int) -> list[float]:
    point_at = line(slope)
    here = point_at(13.0)
    found = [here.error_deg]
    for _ in range(steps):
        here = point_at(rule.propose(here, point_at))
        found.append(here.error_deg)
    return found


def test_cost_and_gradient() -> None:
    point = Point(1.0, 0.5, 2.0)
    assert (point.cost, point.gradient) == (0.125, 1.0)


def test_newton_meets_a_straight_branch_at_once() -> None:
    assert errors(step_rule(NewtonConfig()), 0.013, 1)[1] == pytest.approx(0.0, abs=1e-12)


def test_constant_step_shrinks_the_error_by_one_factor() -> None:
    found = errors(step_rule(ConstantConfig(step=0.5)), 0.7, 6)
    for before, after in itertools.pairwise(found):
        assert after / before == pytest.approx(1.0 - 0.5 * 0.7**2)


def test_diminishing_step_follows_its_power() -> None:
    found = errors(step_rule(DiminishingConfig(initial=1.2, power=0.5)), 0.7, 6)
    for n, (before, after) in enumerate(itertools.pairwise(found), start=1):
        assert after / before == pytest.approx(1.0 - 1.2 / n**0.5 * 0.7**2)


def test_barzilai_borwein_needs_two_steps_on_a_straight_branch() -> None:
    found = errors(step_rule(BarzilaiBorweinConfig(initial=0.1)), 0.3, 2)
    assert abs(found[1]) > 0.1
    assert found[2] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("slope", [0.05, 0.3, 0.7, 1.0, 4.0, 90.0])
def test_armijo_at_least_halves_the_error_once_its_step_has_grown(slope: float) -> None:
    found = errors(step_rule(ArmijoConfig()), slope, 40)
    halved = [abs(after) <= 0.5 * abs(before) for before, after in itertools.pairwise(found)]
    first = halved.index(True)
    assert first <= 9
    assert all(halved[first:])
    assert abs(found[-1]) < 1e-6


def test_armijo_takes_no_step_without_enough_fall() -> None:
    """A branch that turns round just beside the point: any long step is refused."""

    def point_at(command: float) -> Point:
        return Point(command, 1.0 if abs(command) > 1e-3 else 1.0 - command, 1.0)

    proposal = step_rule(ArmijoConfig(initial=1.0)).propose(Point(0.0, 1.0, 1.0), point_at)
    assert abs(proposal) < 1e-3


def test_every_rule_has_its_schema() -> None:
    assert sorted(RULES) == sorted(STEP_RULES)
    assert {name: schema().name for name, schema in STEP_RULES.items()} == {n: n for n in RULES}


def test_unknown_rule_lists_the_known_ones() -> None:
    known = ", ".join(sorted(RULES))
    with pytest.raises(
        UsageError, match=f"compensation.step_rule: expected one of {known}; found 'wolfe'"
    ):
        step_rule(StepRuleConfig(name="wolfe"))
