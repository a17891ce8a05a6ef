from collections import Counter

import numpy as np
import pytest
from play_loop import play_recording

from pipeline.config import CompensationConfig, TrainingConfig
from pipeline.control.as_printed import NO_BRANCH, READINGS, follow_as_printed
from pipeline.control.inverse import (
    CONVERGED,
    MAX_ITERATIONS,
    Solution,
    State,
    follow,
    loop_branches,
)
from pipeline.control.trial import trial_path
from pipeline.errors import UsageError
from pipeline.models.loop_model import MODELS, LoopModel

TARGETS = [float(t) for t in trial_path(120, 20.0)]


@pytest.fixture(scope="module")
def model() -> LoopModel:
    recording = play_recording("pitch", 2.0, 0.3, seed=2, steps=100)
    k = dict.fromkeys(MODELS, 3)
    return LoopModel.fit(recording, "pitch", range(6), k, TrainingConfig(n_init=2), seed=0)


def run(model: LoopModel, reading: str) -> list[Solution]:
    config = CompensationConfig(algorithm=reading, max_iterations=60)
    return follow_as_printed(model, TARGETS, config)


def travel(solutions: list[Solution]) -> float:
    return float(np.abs(np.diff([s.command_deg for s in solutions])).sum())


def test_as_printed_never_moves(model: LoopModel) -> None:
    config = CompensationConfig(algorithm="as_printed")
    solutions = follow_as_printed(model, TARGETS, config, State(command_deg=7.0))
    assert {s.status for s in solutions} == {NO_BRANCH}
    assert {s.command_deg for s in solutions} == {7.0}
    assert {s.iterations for s in solutions} == {0}


def test_with_or_equal_the_descending_branch_is_never_used(model: LoopModel) -> None:
    solutions = run(model, "ascending_or_equal")
    assert {s.direction for s in solutions} == {1}
    assert {s.status for s in solutions} == {CONVERGED}


def test_previous_iterate_flips_and_does_not_always_end(model: LoopModel) -> None:
    statuses = Counter(s.status for s in run(model, "previous_iterate"))
    assert set(statuses) == {CONVERGED, MAX_ITERATIONS}
    assert statuses[MAX_ITERATIONS] > 10


def test_previous_command_drives_back_and_forth(model: LoopModel) -> None:
    printed = run(model, "previous_command")
    corrected = follow(loop_branches(model), TARGETS, CompensationConfig())
    assert {s.status for s in printed} == {CONVERGED}
    assert travel(printed) > 2.0 * travel(corrected)
    falling = printed[31:89]
    assert {s.direction for s in falling} == {1, -1}


def test_no_reading_spins(model: LoopModel) -> None:
    for reading in READINGS:
        solutions = run(model, reading)
        assert len(solutions) == len(TARGETS)
        assert max(s.iterations for s in solutions) <= 60


def test_unknown_algorithm_lists_the_known_ones(model: LoopModel) -> None:
    with pytest.raises(
        UsageError,
        match="expected one of corrected, as_printed, ascending_or_equal, previous_iterate, "
        "previous_command; found 'improved'",
    ):
        run(model, "improved")
