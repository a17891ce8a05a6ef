"""How close together the positions of a drive lie."""

import numpy as np
import pytest

from pipeline.discrepancy.problem.spacing import spacing_of


def test_equal_steps_lie_a_step_apart_however_often_they_are_made():
    cycle = 50.0 - np.abs(np.arange(800) % 160 - 80.0) * 1.25
    assert spacing_of(cycle, 1.25) == pytest.approx(1.25)


def test_jumps_about_the_range_have_been_everywhere():
    jumps = np.random.default_rng(0).uniform(-50.0, 50.0, 2000)
    step = float(np.median(np.abs(np.diff(jumps))))
    assert step > 25.0
    assert 0.2 < spacing_of(jumps, step) < 0.6


def test_a_drive_that_stands_still_or_is_empty_has_the_step_given():
    assert spacing_of(np.zeros(5), 0.0) == 0.0
    assert spacing_of(np.zeros(0), 0.0) == 0.0
