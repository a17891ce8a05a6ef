"""Slack of the drive, against what can be worked out by hand."""

from collections.abc import Sequence

import numpy as np
import pytest

from pipeline.physics.backlash import Backlash
from pipeline.physics.driven_slack import DrivenSlack, driven_as
from pipeline.physics.driven_stretch import DrivenStretch
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.soft_wire import SoftWire
from pipeline.physics.term import Surroundings

DRIVE = np.linspace(-40.0, 40.0, 801)
MOTION = Motion(DRIVE, np.arange(801.0), np.zeros(801, dtype=int))


def answer(drive: np.ndarray, *values: float, form: str = "driven") -> np.ndarray:
    """What comes of a drive, (n,)."""
    return DrivenSlack(form).respond(drive, MOTION, np.array(values), None)[0]


@pytest.mark.parametrize("kept", [0.0, 0.4])
def test_half_the_width_is_lost_on_either_side_but_for_what_is_kept(kept):
    lost = np.clip(DRIVE, -3.0, 3.0) * (1.0 - kept)
    np.testing.assert_allclose(answer(DRIVE, 6.0, 0.01, kept), DRIVE - lost, atol=0.01)


def test_off_home_its_middle_is_another_drive():
    lost = np.clip(DRIVE - 5.0, -3.0, 3.0)
    out = answer(DRIVE, 6.0, 0.01, 0.0, 5.0, form="driven off home")
    np.testing.assert_allclose(out, DRIVE - lost, atol=0.01)


def test_rounded_wider_than_it_is_it_saturates_as_a_hyperbolic_tangent():
    width, rounding = 0.02, 3.0
    lost = 0.5 * width * np.tanh(DRIVE / (2.0 * rounding))
    np.testing.assert_allclose(DRIVE - answer(DRIVE, width, rounding, 0.0), lost, atol=1e-7)


def test_ahead_of_play_the_play_is_as_wide_within_the_slack_as_elsewhere():
    drive = np.concatenate([np.linspace(0.0, 20.0, 101), np.linspace(19.8, -20.0, 200)])
    motion = Motion(drive, np.arange(len(drive) * 1.0), np.zeros(len(drive), dtype=int))
    slack, play = np.array([6.0, 0.01, 0.0]), Piece(Backlash(), np.array([2.0]))

    def beside(form: str) -> np.ndarray:
        return Mechanism(pieces=(Piece(DrivenSlack(form), slack), play)).respond(motion)[0]

    taken_up = answer(drive, *slack)
    alone = Mechanism(pieces=(play,)).respond(Motion(taken_up, motion.time_s, motion.cycle))[0]
    np.testing.assert_allclose(beside("ahead of play"), alone, atol=1e-9)
    assert np.max(np.abs(beside("driven") - alone)) > 0.9


@pytest.mark.parametrize("wire", [DrivenStretch(), SoftWire("wire"), SoftWire("toe")])
def test_wire_that_soon_loses_all_that_it_does_may_be_slack_instead(wire):
    around, more = Surroundings(), [2.0, 0.0] if wire.form == "driven" else [0.0, 0.1]
    told = [one for few in wire.instead(np.array([0.4, 3.0, *more]), MOTION, around) for one in few]
    assert {t.name for t, _ in told} == {"slack"}
    assert {t.form for t, _ in told} >= {"driven", "ahead of play"}
    assert not wire.instead(np.array([0.4, 40.0, *more]), MOTION, around)


@pytest.mark.parametrize("centre", [0.0, -4.0])
def test_slack_begun_from_wire_loses_as_much_far_out_on_either_side_of_its_middle(centre: float):
    told = driven_as(1.2, 3.0, centre)
    assert {t.form for t, _ in told} == {
        f"{form} off home" if centre else form for form in ("driven", "ahead of play")
    }
    for term, values in told:
        lost = DRIVE - term.respond(DRIVE, MOTION, values, None)[0]
        np.testing.assert_allclose(lost[[0, -1]], [-1.2, 1.2], rtol=1e-6)


class Clear:
    """A recording that shows every parameter."""

    step = 1.0

    def worth(self, size: int, course: Sequence[int] = ()) -> bool:
        return True

    def sharp(self, reach: int) -> bool:
        return False


@pytest.mark.parametrize(
    ("width", "rounding", "kept", "name"),
    [
        (4.0, 0.5, 0.0, "slack"),
        (4.0, 0.1, 0.6, "slack"),
        (1.7, 3.7, 0.0, "compliance"),
        (4.0, 1.9, 0.0, "compliance"),
    ],
)
def test_what_lets_most_come_through_in_its_middle_is_soft_wire(width, rounding, kept, name):
    assert DrivenSlack().plainer(np.array([width, rounding, kept]), Clear()) == name
