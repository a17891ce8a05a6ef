"""A wire that rubs, by more with each cycle or with the way."""

import numpy as np
import pytest

from pipeline.physics.motion import Motion
from pipeline.physics.pre_sliding import dragging
from pipeline.physics.tension_loss import TensionLoss
from pipeline.physics.term import Surroundings

DRIVE = 40.0 * np.sin(np.linspace(0.0, 8.0 * np.pi, 801))
MOTION = Motion(DRIVE, np.arange(801.0), np.arange(801) // 200)
REACH = 9.0


def answer(form, values):
    return TensionLoss(form).respond(DRIVE, MOTION, np.array(values), None)[0]


def test_it_is_held_back_by_a_bristle_that_grows_with_each_cycle():
    share = dragging(DRIVE, REACH, 1.0, None)[0]
    held = 0.5 * (1.0 + 0.6 * MOTION.cycle) * share
    np.testing.assert_allclose(answer("cycle dragged", [0.6, 1.0, REACH]), DRIVE - held, atol=1e-9)


def test_it_grows_with_the_way():
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(DRIVE)))])
    held = 0.5 * (1.0 + 0.004 * way) * dragging(DRIVE, REACH, 1.0, None)[0]
    np.testing.assert_allclose(answer("dragged", [0.004, 1.0, REACH]), DRIVE - held, atol=1e-9)


@pytest.mark.parametrize("reach", [0.0, 1.0])
def test_it_never_moves_against_the_drive(reach):
    out = answer("dragged", [0.0, 12.0, reach])
    assert np.all(np.diff(out) * np.diff(DRIVE) >= -1e-12)


def test_a_wire_that_hardly_slips_is_told_otherwise():
    around = Surroundings(drive_span=80.0)
    assert TensionLoss("dragged").slight(np.array([0.004, 1.0, 30.0]), around)
    assert not TensionLoss("dragged").slight(np.array([0.004, 1.0, 10.0]), around)
    assert not TensionLoss("late").slight(np.array([0.004, 1.0, 300.0]), around)
