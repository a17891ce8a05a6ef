"""An elastic wire that rubs: its equation, its limit, its memory."""

import numpy as np
import pytest

from pipeline.physics.catalogue import term
from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import play

WIDTH = 3.0


def motion_of(drive: np.ndarray) -> Motion:
    n = len(drive)
    return Motion(drive, 0.02 * np.arange(n), np.zeros(n, dtype=int))


def far_end(form: str, drive: np.ndarray, reach: float, shape: float) -> np.ndarray:
    """Where the far end of the wire is, (n,)."""
    values = np.array([WIDTH, reach, shape])
    return term("friction", form).respond(drive, motion_of(drive), values, None)[0]


SWING = np.linspace(20.0, 8.0, 4000) * np.sin(np.arange(4000) / 200.0)


def test_a_wire_that_gives_way_at_once_is_play():
    expected = play(SWING, 0.5 * WIDTH, 0.0)
    np.testing.assert_allclose(far_end("ahead", SWING, 1e-6, 0.0), expected, atol=1e-5)


def test_a_bristle_holds_the_far_end_as_dahls_equation_says():
    reach, released = 0.4, 1.0
    x = far_end("bristle ahead", SWING, reach, released)
    held = (SWING - x) / (0.5 * WIDTH)
    z = np.zeros(len(x))
    for k in range(1, len(x)):
        z[k] = z[k - 1]
        for _ in range(20):
            step = (x[k] - x[k - 1]) / 20
            z[k] += step / reach * (1.0 - z[k] * np.sign(step))
    np.testing.assert_allclose(held, z, atol=2e-3)


@pytest.mark.parametrize("form", ["ahead", "bristle ahead"])
def test_a_block_goes_on_where_the_one_before_ended(form):
    values, wire = np.array([WIDTH, 0.4, 0.7]), term("friction", form)
    whole, _ = wire.respond(SWING, motion_of(SWING), values, None)
    first, state = wire.respond(SWING[:1500], motion_of(SWING[:1500]), values, None)
    second, _ = wire.respond(SWING[1500:], motion_of(SWING[1500:]), values, state)
    np.testing.assert_allclose(np.concatenate([first, second]), whole, atol=1e-7)
