"""Play whose width goes with the pose: its response, and what a search makes of it."""

import numpy as np
import pytest

from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import play, varying_play
from pipeline.physics.term import Surroundings
from pipeline.physics.uneven_play import FORMS, OPENING, TAPERED, WORN, UnevenPlay
from tests.discrepancy.made import diagnosed, names
from tests.discrepancy.test_beyond import moved, recorded

VALUES = {TAPERED: [4.0, 0.5, 0.0, 60.0], WORN: [6.0, 0.4, -8.0, 15.0]}


def swept(steps: int = 400) -> Motion:
    phase = np.arange(steps) / steps * 4.0
    drive = 60.0 * np.where(phase < 1, phase, np.where(phase < 3, 2 - phase, phase - 4))
    return Motion(drive=drive, time_s=3.36 * np.arange(steps), cycle=np.zeros(steps, dtype=int))


def answer(form: str, values: list[float], motion: Motion) -> np.ndarray:
    return UnevenPlay(form).respond(motion.drive, motion, np.array(values), None)[0]


def test_a_gap_that_tapers_loses_half_of_its_own_width_wherever_it_is_pushed():
    motion = swept()
    u = motion.drive
    lost = u - answer(TAPERED, VALUES[TAPERED], motion)
    half = 0.5 * 4.0 * (1.0 + 0.5 * u / 60.0)
    down = slice(110, 300)
    np.testing.assert_allclose(lost[20:101], half[20:101])
    np.testing.assert_allclose(lost[down], -half[down])


def test_teeth_worn_round_a_place_lose_the_more_the_nearer_to_it_they_are():
    motion = swept()
    lost = motion.drive - answer(WORN, VALUES[WORN], motion)
    at_place, far_off = np.argmin(np.abs(motion.drive[100:300] + 8.0)) + 100, 299
    assert lost[at_place] == pytest.approx(-3.0, abs=0.01)
    assert lost[far_off] == pytest.approx(-3.0 * 0.4, abs=0.01)


EVEN = [(TAPERED, [0.0, 0.0, 60.0]), (WORN, [1.0, 0.0, 9.0]), (OPENING, [0.0, 5.0, 9.0])]


@pytest.mark.parametrize(("form", "even"), EVEN)
def test_where_nothing_differs_it_is_plain_play(form, even):
    motion = swept()
    expected = play(motion.drive, 2.5, motion.drive[0])
    np.testing.assert_allclose(answer(form, [5.0, *even], motion), expected)


WIDTHS = {
    TAPERED: lambda u: 5.0 * (1.0 + 0.4 * u / 55.0),
    WORN: lambda u: 3.0 * (0.5 + 0.5 * np.exp(-(((u + 6.0) / 16.0) ** 2))),
}


@pytest.mark.parametrize("form", FORMS)
def test_from_noise_it_is_play_and_its_widths_are_found(form):
    command = recorded({}).values("pitch_command_deg")
    result = diagnosed(moved(varying_play(command, 0.5 * WIDTHS[form](command), command[0])))
    (found,) = result.diagnoses
    assert found.verdict == ("ambiguous" if form == "tapered" else "explained")
    assert (found.physics[0].alternatives[0] == "friction") == (form == "tapered")
    assert names(result) == {"backlash"}
    (piece,) = [p for m in result.models for p in m.mechanism.pieces]
    assert piece.term.form == form
    asked = np.linspace(-50.0, 50.0, 11)
    np.testing.assert_allclose(piece.term.gap(asked, piece.values), WIDTHS[form](asked), atol=0.4)


def test_play_on_one_side_is_found_in_place_of_what_mops_it_up_and_told_as_more_than_play():
    command = recorded({}).values("pitch_command_deg")
    gap = np.where(command > 5.0, 4.0, 0.0)
    result = diagnosed(moved(varying_play(command, 0.5 * gap, command[0])))
    (found,) = result.diagnoses
    assert found.verdict == "partly_explained"
    assert names(result) == {"backlash"}
    (piece,) = [p for m in result.models for p in m.mechanism.pieces]
    assert piece.term.form == OPENING
    asked = np.array([-40.0, -10.0, 20.0, 50.0])
    expected = [0.0, 0.0, 4.0, 4.0]
    np.testing.assert_allclose(piece.term.gap(asked, piece.values), expected, atol=0.4)


def test_play_that_is_none_on_one_side_is_said_to_be_none():
    around = Surroundings(drive_span=120.0, drive_low=-60.0, drive_unit="deg")
    told = UnevenPlay(OPENING).sentence(np.array([2.0, 1.0, 0.0, 5.0]), around)
    assert "4 deg of it at 60 deg, 0 deg at -60 deg" in told
