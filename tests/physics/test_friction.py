"""Friction with rounded corners, and what has none."""

import numpy as np
import pytest

from pipeline.physics.friction import Friction
from tests.physics.test_driven_slack import Clear


@pytest.mark.parametrize(
    ("form", "reach", "name"),
    [("symmetric", 0.05, "backlash"), ("symmetric", 0.5, "friction"), ("driven", 0.05, "friction")],
)
def test_corners_that_are_far_smaller_than_the_loop_are_those_of_play(form, reach, name):
    assert Friction(form).plainer(np.array([10.0, reach, 0.5]), Clear()) == name
