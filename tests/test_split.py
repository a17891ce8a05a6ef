import itertools

import pytest

from pipeline.config import SplitConfig
from pipeline.errors import UsageError
from pipeline.split import split_cycles

NINE = range(9)


def test_paper_trains_on_six_and_tests_on_the_last_three() -> None:
    assert split_cycles(SplitConfig(kind="paper"), NINE) == ([0, 1, 2, 3, 4, 5], [6, 7, 8])


def test_cycles_need_not_start_at_zero() -> None:
    assert split_cycles(SplitConfig(kind="paper"), [7, 2, 3, 5, 2]) == ([2], [3, 5, 7])


def test_leave_three_out_goes_through_all_84_choices() -> None:
    found = []
    for index in range(84):
        train, test = split_cycles(SplitConfig(kind="leave_three_out", index=index), NINE)
        assert sorted(train + test) == list(NINE)
        found.append(tuple(test))
    assert found == list(itertools.combinations(NINE, 3))


@pytest.mark.parametrize("folds", [2, 3, 9])
def test_every_cycle_tests_in_exactly_one_fold(folds: int) -> None:
    tested = []
    for index in range(folds):
        config = SplitConfig(kind="k_fold", folds=folds, index=index)
        train, test = split_cycles(config, NINE)
        assert sorted(train + test) == list(NINE)
        tested += test
    assert sorted(tested) == list(NINE)


def test_explicit_cycles_are_taken_as_named() -> None:
    config = SplitConfig(kind="explicit", train=[4, 1], test=[0])
    assert split_cycles(config, NINE) == ([1, 4], [0])


@pytest.mark.parametrize(
    ("config", "cycles", "message"),
    [
        (SplitConfig(kind="leave_three_out", index=84), NINE,
         r"split.index: expected 0 to 83 \(3 of 9 cycles\); found 84"),
        (SplitConfig(kind="leave_three_out", index=-1), NINE, "found -1"),
        (SplitConfig(kind="k_fold", folds=3, index=3), NINE, r"0 to 2 \(3 folds\); found 3"),
        (SplitConfig(kind="k_fold", folds=1), NINE, "split.folds: expected at least 2"),
        (SplitConfig(kind="k_fold", folds=4), range(3), "at least 4 cycles; found 3"),
        (SplitConfig(kind="paper"), range(3), "at least 4 cycles; found 3"),
        (SplitConfig(kind="leave_three_out"), range(3), "at least 4 cycles; found 3"),
        (SplitConfig(kind="explicit", train=[0, 1], test=[1, 2]), NINE, r"found \[1\] in both"),
        (SplitConfig(kind="explicit", train=[0, 9], test=[1]), NINE,
         r"split.train: expected cycles out of those recorded.*found \[9\] besides"),
        (SplitConfig(kind="explicit", train=[0]), NINE, "split.test: .*found none"),
        (SplitConfig(kind="random"), NINE,
         "one of paper, leave_three_out, k_fold, explicit; found 'random'"),
    ],
)  # fmt: skip
def test_impossible_splits_are_refused(config: SplitConfig, cycles: range, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        split_cycles(config, cycles)
