"""Two clocks that run at different rates."""

import numpy as np
import pytest

from pipeline.physics.motion import Motion
from pipeline.physics.running_clock import RunningClock
from pipeline.physics.term import Surroundings


def sampled(first_s: float, count: int) -> Motion:
    time_s = first_s + 0.05 * np.arange(count)
    return Motion(np.sin(time_s), time_s, np.zeros(count, dtype=int))


@pytest.mark.parametrize("rate", [0.02, -0.004])
def test_what_is_seen_is_what_the_other_clock_says(rate: float) -> None:
    motion = sampled(3.0, 2000)
    seen, _ = RunningClock().respond(motion.drive, motion, np.array([0.1, rate]), None)
    there_s = motion.time_s - 0.1 - rate * (motion.time_s - 3.0)
    inside = (there_s > motion.time_s[0]) & (there_s < motion.time_s[-1])
    assert np.count_nonzero(inside) > 1900
    assert seen[inside] == pytest.approx(np.sin(there_s[inside]), abs=4e-4)  # of straight lines


def test_blocks_answer_as_if_all_had_come_at_once() -> None:
    motion, term, values = sampled(0.0, 900), RunningClock(), np.array([0.3, 0.02])
    whole, _ = term.respond(motion.drive, motion, values, None)
    first, state = term.respond(motion.drive[:400], motion.rows(slice(400)), values, None)
    rest, _ = term.respond(motion.drive[400:], motion.rows(slice(400, None)), values, state)
    assert np.concatenate([first, rest]) == pytest.approx(whole, abs=1e-12)


def test_it_is_told_by_how_much_it_falls_behind() -> None:
    around = Surroundings(cycles=8)
    said = RunningClock().sentence(np.array([0.2, -0.004]), around)
    assert "0.2 s late" in said
    assert "4 ms ahead each second" in said
    assert not RunningClock().excited(sampled(0.0, 100), Surroundings(cycles=1))
