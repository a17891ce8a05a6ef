"""Which cycles of a recording train a model, and which test it."""

from collections.abc import Sequence
from itertools import combinations
from math import comb

from pipeline.config import SplitConfig
from pipeline.errors import UsageError, refusal

LEFT_OUT = 3


def split_cycles(config: SplitConfig, cycles: Sequence[int]) -> tuple[list[int], list[int]]:
    """Training and test cycles out of those recorded, by `config.kind`:

    paper            three test (six train of the paper's nine): the last three, or with `index`
                     another three, counted from the last on
    leave_three_out  `index` counts the choices of three test cycles in lexical order (84 of nine)
    k_fold           `index` is the fold, of `folds`: every folds-th cycle from that one on tests
    explicit         `train` and `test` name them

    UsageError if an index is out of range, cycles overlap, aren't there, or none are left.
    """
    cycles = sorted({int(cycle) for cycle in cycles})
    if config.kind == "explicit":
        return _explicit(config, cycles)
    if config.kind == "paper":
        return _leave_three_out(config.index, cycles, from_last=True)
    if config.kind == "leave_three_out":
        return _leave_three_out(config.index, cycles, from_last=False)
    if config.kind == "k_fold":
        return _k_fold(config, cycles)
    known = "paper, leave_three_out, k_fold, explicit"
    raise _refused("split", f"one of {known}", repr(config.kind), "Choose one of them.")


def _explicit(config: SplitConfig, cycles: list[int]) -> tuple[list[int], list[int]]:
    recorded = f"cycles out of those recorded, {cycles}"
    for key, wanted in (("split.train", config.train), ("split.test", config.test)):
        if not wanted:
            raise _refused(key, recorded, "none", f"Name some in {key}.")
        missing = sorted(set(wanted) - set(cycles))
        if missing:
            raise _refused(key, recorded, f"{missing} besides", "Name recorded ones only.")
    both = sorted(set(config.train) & set(config.test))
    if both:
        raise _refused(
            "split", "cycles that either train or test", f"{both} in both", "Take them out of one."
        )
    return sorted(set(config.train)), sorted(set(config.test))


def _leave_three_out(index: int, cycles: list[int], from_last: bool) -> tuple[list[int], list[int]]:
    choices = comb(len(cycles), LEFT_OUT)
    _check_enough(cycles, LEFT_OUT + 1)
    _check_index(index, choices, f"{LEFT_OUT} of {len(cycles)} cycles")
    place = choices - 1 - index if from_last else index
    test = next(c for i, c in enumerate(combinations(cycles, LEFT_OUT)) if i == place)
    return _rest(cycles, list(test), LEFT_OUT + 1)


def _k_fold(config: SplitConfig, cycles: list[int]) -> tuple[list[int], list[int]]:
    if config.folds < 2:
        raise _refused("split.folds", "at least 2", f"{config.folds}", "Set it to 2 or more.")
    _check_enough(cycles, config.folds)
    _check_index(config.index, config.folds, f"{config.folds} folds")
    return _rest(cycles, cycles[config.index :: config.folds], config.folds)


def _rest(cycles: list[int], test: list[int], needed: int) -> tuple[list[int], list[int]]:
    _check_enough(cycles, needed)
    return [cycle for cycle in cycles if cycle not in test], test


def _check_enough(cycles: list[int], needed: int) -> None:
    if len(cycles) < needed:
        raise _refused(
            "split",
            f"at least {needed} cycles",
            f"{len(cycles)}",
            "Record more cycles, or name them with split=explicit split.train=[...] "
            "split.test=[...].",
        )


def _check_index(index: int, choices: int, of: str) -> None:
    if not 0 <= index < choices:
        raise _refused(
            "split.index", f"0 to {choices - 1} ({of})", f"{index}", "Choose one of these."
        )


def _refused(where: str, expected: str, found: str, remedy: str) -> UsageError:
    return UsageError(refusal(where, expected, found, remedy))
