"""An elastic wire in a sheath against a chain of sliding nodes that comes to rest by itself."""

from itertools import pairwise

import numpy as np
import pytest
from numba import njit

from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import play
from pipeline.physics.sheath_line import PLACES, SheathLine
from pipeline.physics.term import Surroundings

RUB, WRAP, STRETCH, PRETENSION = 0.6, 0.3, 0.5, 2.0
CORNERS = [0.0, 10.0, -8.0, 6.0, -2.0, 9.0, 0.0]


def motion_of(drive: np.ndarray) -> Motion:
    return Motion(drive, np.arange(len(drive)) * 0.1, np.zeros(len(drive), dtype=int))


def swing() -> np.ndarray:
    return np.concatenate([np.linspace(a, b, 60) for a, b in pairwise(CORNERS)])


@njit
def at_rest(drive, places):  # type: ignore[no-untyped-def]
    """Where the last node is once no node is pulled by more than it rubs (Gauss and Seidel)."""
    firm, lost = places / STRETCH, np.zeros(len(drive))
    at = np.zeros(places + 1)
    for k, near in enumerate((1.0 + STRETCH) * drive):
        at[0] = near
        for _ in range(4000):
            furthest = 0.0
            for j in range(1, places + 1):
                ahead = firm * (at[j - 1] - at[j])
                behind = firm * (at[j] - at[j + 1]) if j < places else at[j]
                give = firm + (firm if j < places else 1.0)
                held = (RUB + WRAP * abs(ahead + PRETENSION)) / places
                off = ahead - behind
                moved = np.sign(off) * max(abs(off) - held, 0.0) / give
                at[j] += moved
                furthest = max(furthest, abs(moved))
            if furthest < 1e-9:
                break
        lost[k] = at[places]
    return lost


def test_a_chain_of_nodes_comes_to_rest_there():
    drive = swing()
    values = np.array([RUB, WRAP, STRETCH, PRETENSION])
    out, _ = SheathLine().respond(drive, motion_of(drive), values, None)
    np.testing.assert_allclose(out, at_rest(drive, PLACES), atol=0.02)


def test_it_goes_on_where_it_was_and_without_friction_follows():
    drive, values = swing(), np.array([RUB, WRAP, STRETCH, PRETENSION])
    whole, _ = SheathLine().respond(drive, motion_of(drive), values, None)
    first, state = SheathLine().respond(drive[:150], motion_of(drive[:150]), values, None)
    last, _ = SheathLine().respond(drive[150:], motion_of(drive[150:]), values, state)
    np.testing.assert_allclose(np.concatenate([first, last]), whole, atol=1e-4)
    free, _ = SheathLine().respond(drive, motion_of(drive), np.array([0.0, 0.0, 0.5, 0.0]), None)
    np.testing.assert_allclose(free, drive, atol=1e-4)


@pytest.mark.parametrize("rub", [1e3, 1e-9])
def test_it_answers_whatever_it_rubs(rub):
    drive = swing()
    out, _ = SheathLine().respond(drive, motion_of(drive), np.array([rub, 5.0, 5.0, -3.0]), None)
    assert np.all(np.isfinite(out))


def test_where_no_share_of_the_pull_is_lost_its_far_end_has_play():
    drive, around = swing(), Surroundings(drive_low=-10.0, drive_span=20.0)
    even, grows = (np.array([RUB, wrap, STRETCH, 0.0]) for wrap in (0.0, WRAP))
    out, _ = SheathLine().respond(drive, motion_of(drive), even, None)
    mean = 0.5 * (PLACES + 1.0) / PLACES
    half = STRETCH * RUB * mean / (1.0 + STRETCH)
    np.testing.assert_allclose(out, play(drive, half, 0.0), atol=1e-4)
    assert SheathLine().also_at(even, around) == ("backlash",)
    assert SheathLine().also_at(grows, around) == ()
