from collections.abc import Callable

import numpy as np
import pytest
from play_loop import curve, play, play_recording, triangle

from pipeline.config import (
    STEP_RULES,
    CompensationConfig,
    ConstantConfig,
    StepRuleConfig,
    TrainingConfig,
)
from pipeline.control.inverse import (
    CLIPPED,
    CONVERGED,
    MAX_ITERATIONS,
    UNREACHABLE,
    Branches,
    State,
    directions_of,
    follow,
    invert,
    loop_branches,
    nominal_branches,
)
from pipeline.control.monotone import MonotoneBranch
from pipeline.control.trial import trial_path
from pipeline.errors import LoopgapError
from pipeline.models.loop_model import MODELS, LoopModel


def straight(offset: float, slope: float = 0.7) -> MonotoneBranch:
    command = np.linspace(-60.0, 60.0, 13)
    return MonotoneBranch(command, slope * command + offset, np.full(13, slope))


def loop() -> Branches:
    """Ascending branch 2 deg below the descending one: reaches -43 .. 41 and -41 .. 43."""
    return {1: straight(-1.0), -1: straight(1.0)}


@pytest.fixture(scope="module", params=[4, 9])
def model(request: pytest.FixtureRequest) -> LoopModel:
    recording = play_recording("pitch", 2.0, 0.3, seed=2)
    k = dict.fromkeys(MODELS, request.param)
    return LoopModel.fit(recording, "pitch", range(6), k, TrainingConfig(n_init=2), seed=0)


def test_directions_are_the_signs_of_the_desired_changes_held_where_there_is_none() -> None:
    path = [1.0, 2.0, 2.0, 1.0, 1.0, 1.0, 3.0]
    assert directions_of(path, State()) == [1, 1, 1, -1, -1, -1, 1]
    assert directions_of([-5.0, -5.0, 0.0], State()) == [-1, -1, 1]
    assert directions_of([0.0, 0.0, -1.0], State()) == [-1, -1, -1]
    assert directions_of([0.0, 0.0, 1.0], State(direction=-1)) == [-1, -1, 1]
    assert directions_of([3.0], State(target_deg=4.0)) == [-1]
    assert directions_of([0.0], State()) == [1]
    assert directions_of([], State()) == []


def test_commands_are_those_of_the_branch_of_travel() -> None:
    solutions = follow(loop(), [10.0, 20.0, 20.0, 10.0], CompensationConfig())
    expected = [11.0 / 0.7, 21.0 / 0.7, 21.0 / 0.7, 9.0 / 0.7]
    assert [s.command_deg for s in solutions] == pytest.approx(expected, abs=1e-5)
    assert [s.direction for s in solutions] == [1, 1, 1, -1]
    assert {s.status for s in solutions} == {CONVERGED}


def test_search_starts_at_the_command_before() -> None:
    solutions = follow(loop(), [10.0, 10.0, 10.0], CompensationConfig())
    assert solutions[0].iterations > 0
    assert [s.iterations for s in solutions[1:]] == [0, 0]
    assert solutions[2].command_deg == solutions[0].command_deg
    assert follow(loop(), [10.0], CompensationConfig(), State(11.0 / 0.7))[0].iterations == 0


def test_target_that_only_the_other_branch_reaches_is_clipped() -> None:
    solution = invert(loop(), 42.0, 1, 0.0, CompensationConfig())
    assert solution.status == CLIPPED
    assert (solution.command_deg, solution.model_deg) == (60.0, pytest.approx(41.0))


@pytest.mark.parametrize(("target", "bound"), [(44.0, 60.0), (-50.0, -60.0)])
def test_target_that_no_branch_reaches_is_unreachable(target: float, bound: float) -> None:
    solution = invert(loop(), target, -1, 0.0, CompensationConfig())
    assert solution.status == UNREACHABLE
    assert solution.command_deg == bound


def test_ends_of_a_branch_are_reached() -> None:
    config = CompensationConfig()
    for target, bound in ((41.0, 60.0), (-43.0, -60.0)):
        solution = invert(loop(), target, 1, 0.0, config)
        assert solution.status == CONVERGED
        assert solution.command_deg == pytest.approx(bound, abs=1e-5)


def test_search_stops_at_the_cap_with_the_best_command() -> None:
    config = CompensationConfig(step_rule=ConstantConfig(step=1e-3), max_iterations=7)
    solution = invert(loop(), 10.0, 1, 0.0, config)
    assert solution.status == MAX_ITERATIONS
    assert solution.iterations == 7
    assert 0.0 < solution.command_deg < 11.0 / 0.7
    assert solution.model_deg == pytest.approx(0.7 * solution.command_deg - 1.0)


@pytest.mark.parametrize("step", [1e3, 1e9])
def test_wild_steps_are_held_by_the_bracket(step: float) -> None:
    config = CompensationConfig(step_rule=ConstantConfig(step=step))
    solution = invert(loop(), 12.3, -1, -60.0, config)
    assert solution.status == CONVERGED


@pytest.mark.parametrize("rule", STEP_RULES.values())
def test_every_rule_reaches_a_millionth_of_a_degree_in_the_model(
    model: LoopModel, rule: Callable[[], StepRuleConfig]
) -> None:
    targets = trial_path(200, 38.0)
    config = CompensationConfig(step_rule=rule())
    solutions = follow(loop_branches(model), list(targets), config)
    assert {s.status for s in solutions} == {CONVERGED}
    assert max(abs(s.model_deg - s.target_deg) for s in solutions) <= 1e-6
    assert max(s.iterations for s in solutions) <= config.max_iterations


def test_command_fulfils_the_mixture_where_it_rises_by_itself(model: LoopModel) -> None:
    branches = loop_branches(model)
    for s in follow(branches, list(trial_path(100, 38.0)), CompensationConfig()):
        mean = model.predict(np.array([s.command_deg]), s.direction)[0][0]
        assert abs(mean - s.target_deg) <= 2e-6 + 1.01 * branches[s.direction].changed_deg


@pytest.mark.parametrize("seed", range(5))
def test_any_path_gets_a_status_for_every_target(model: LoopModel, seed: int) -> None:
    targets = np.random.default_rng(seed).uniform(-60.0, 60.0, 100)
    solutions = follow(loop_branches(model), list(targets), CompensationConfig())
    for s in solutions:
        assert s.status in (CONVERGED, CLIPPED, UNREACHABLE)
        assert (abs(s.model_deg - s.target_deg) <= 1e-6) == (s.status == CONVERGED)
        assert -60.0 <= s.command_deg <= 60.0


def test_compensated_commands_land_and_nominal_ones_do_not(model: LoopModel) -> None:
    """The plant itself, on its full loop, driven by both inverses."""
    targets = trial_path(100, 38.0)

    def landing_error(branches: Branches) -> float:
        commands = [s.command_deg for s in follow(branches, list(targets), CompensationConfig())]
        driven = np.concatenate([triangle(1, 60.0, 200), [0.0], commands])
        landed = curve(play(driven, 2.0))[-len(targets) :]
        return float(np.sqrt(np.mean((landed - targets) ** 2)))

    compensated, nominal = (
        landing_error(loop_branches(model)),
        landing_error(nominal_branches(model)),
    )
    assert nominal > 1.2
    assert compensated < 0.15 * nominal


def test_travel_is_what_the_path_needs() -> None:
    """Rising, then falling: the shaft goes out and back once, and crosses the loop's width once."""
    targets = [10.0, 20.0, 30.0, 20.0, 10.0]
    commands = [s.command_deg for s in follow(loop(), targets, CompensationConfig())]
    needed = (31.0 - 11.0) / 0.7 + (31.0 - 9.0) / 0.7
    assert np.abs(np.diff(commands)).sum() == pytest.approx(needed, abs=1e-4)


def test_target_that_is_no_number_is_refused() -> None:
    with pytest.raises(LoopgapError, match="target 1: expected an angle in degrees; found nan"):
        follow(loop(), [1.0, float("nan")], CompensationConfig())
