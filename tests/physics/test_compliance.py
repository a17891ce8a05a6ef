"""What gives way with the bend, against what can be worked out by hand."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pytest

from pipeline.physics.compliance import Compliance
from pipeline.physics.contact import Contact
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.soft_wire import SoftWire
from pipeline.physics.softer_side import SofterSide
from pipeline.physics.stiffening_joint import StiffeningJoint
from pipeline.physics.term import Surroundings

AROUND = Surroundings()


def asked(angle: np.ndarray, term: Compliance, *values: float) -> np.ndarray:
    """The joint's angles, (n,), for a drive of `angle`."""
    motion = Motion(angle, np.arange(len(angle), dtype=float), np.zeros(len(angle), dtype=int))
    return Mechanism(pieces=(Piece(term, np.array(values)),)).respond(motion)[0]


def test_a_progressive_joint_stiffens_in_proportion_to_its_bend():
    drive = np.linspace(-40.0, 40.0, 801)
    theta = asked(drive, StiffeningJoint("progressive"), 0.006, 0.1, 0.01)
    np.testing.assert_allclose(1.1 * theta + 0.006 * theta * np.abs(theta), drive, atol=1e-3)


@pytest.mark.parametrize(("form", "side"), [("upper", 1.0), ("lower", -1.0)])
def test_the_softer_of_two_wires_takes_over_gradually(form, side):
    drive = np.linspace(-40.0, 40.0, 801)
    theta = asked(drive, SofterSide(form), 0.3, 2.0, 6.0)
    lost = side * 0.3 * 6.0 * np.log1p(np.exp(side * (theta - 2.0) / 6.0))
    np.testing.assert_allclose(theta + lost, drive, atol=1e-5)


@pytest.mark.parametrize("form", ["upper", "lower hardening"])
def test_a_contact_that_can_be_met_no_more_gradually_may_be_the_softer_wire(form):
    motion = Motion(np.zeros(2), np.arange(2.0), np.zeros(2, dtype=int))
    contact, widest = Contact(form), Contact(form).parameters(AROUND)[2].high
    tail = [0.0] * (len(contact.parameters(AROUND)) - 3)
    (told,) = contact.instead(np.array([0.3, 1.0, widest, *tail]), motion, AROUND)
    assert [(t.name, t.form) for t, _ in told] == [("compliance", form.split()[0])]
    assert not contact.instead(np.array([0.3, 1.0, 0.5 * widest, *tail]), motion, AROUND)


def test_a_contact_beyond_which_a_wire_hangs_slack_may_be_the_softer_wire():
    motion = Motion(np.zeros(2), np.arange(2.0), np.zeros(2, dtype=int))
    contact = Contact("lower unloading")
    (told,) = contact.instead(np.array([0.1, 4.7, 0.07, 1.0]), motion, AROUND)
    ((softer, values),) = told
    assert (softer.name, softer.form) == ("compliance", "lower")
    assert values[2] >= softer.parameters(AROUND)[2].low


@dataclass(frozen=True)
class Known:
    """What is shown of a soft wire: its reach to some accuracy, where a step goes 1.0."""

    longest: float
    step: float = 1.0

    def worth(self, size: int, course: Sequence[int] = ()) -> bool:
        return True

    def most(self, size: int, course: Sequence[int] = ()) -> float:
        return self.longest

    def sharp(self, reach: int) -> bool:
        return False


@pytest.mark.parametrize(("form", "longest", "may"), [("wire", 1.5, True), ("wire", 0.9, False),
                                                      ("toe", 1.5, False)])  # fmt: skip
def test_a_wire_that_looks_slack_may_be_soft_where_it_may_reach_over_a_step(form, longest, may):
    values, shown = np.array([0.3, 0.8, 0.0, 0.1]), Known(longest)
    assert SoftWire(form).plainer(values, shown) == ("compliance" if form == "toe" else "slack")
    assert SoftWire(form).may_be_itself(values, AROUND, shown) == may
