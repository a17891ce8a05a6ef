"""How hard a wire in its sheath is pulled, against a sheath of many segments."""

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import brentq

from pipeline.config import DiagnosisConfig
from pipeline.physics.catalogue import SHEATH_FORCES
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.sheath_force import SheathForce
from pipeline.physics.term import Surroundings
from pipeline.recording import Channel, Recording
from pipeline.stages.diagnosis import diagnose

STIFFNESS, WRAP, LOAD, PRETENSION = 3.0, 0.6, 0.7, 8.0
SWINGS = (10.0, 10.0, 6.0, 10.0, 10.0, 4.0, 10.0, 10.0)


def sheath(way: np.ndarray, wrap: float, load: float, segments: int = 64) -> np.ndarray:
    """Pulls at the near and the far end, (n, 2): each segment holds back its share of exp(wrap)."""
    share = np.exp(wrap / segments)
    held = np.full(segments, way[0])

    def follow(near):
        out, pull = held.copy(), near
        for k in range(segments):
            out[k] = pull = min(max(out[k], pull / share), pull * share)
        return out

    ends = []
    for asked in way:

        def off(near, asked=asked):
            out = follow(near)
            return (1.0 - load) * out.mean() + load * out[-1] - asked

        near = brentq(off, 1e-6, 1e3, xtol=1e-10)
        held = follow(near)
        ends.append((near, held[-1]))
    return np.array(ends)


def way_mm() -> tuple[np.ndarray, np.ndarray]:
    """Position [mm] over cycles of 60 rows, and the cycle of each."""
    phase = 2.0 * np.pi * np.arange(60) / 60
    way = np.concatenate([12.0 - swing * np.cos(phase) for swing in SWINGS])
    return way, np.repeat(np.arange(len(SWINGS)), 60)


def moved(way: np.ndarray, cycle: np.ndarray) -> Motion:
    zero = np.zeros(len(way))
    return Motion(way, 0.1 * np.arange(len(way)), cycle, kinetics=Kinetics(zero, zero, zero))


def both_ways_factor(wrap: float, load: float) -> float:
    """By what the pull at the far end differs between the two ways: wire and spring give way."""
    up, down = (load + (1.0 - load) * np.expm1(w) / w for w in (wrap, -wrap))
    return up / down


HALF = 0.5 * np.log(both_ways_factor(WRAP, LOAD))
CENTRE = (LOAD + (1.0 - LOAD) * np.expm1(WRAP) / WRAP) * np.exp(-HALF)


@pytest.mark.parametrize(
    ("form", "side", "end", "own"),
    [("near", 1.0, 0, (WRAP, LOAD, 1.0)), ("far falling", -1.0, 1, (HALF,))],
)
def test_it_is_the_sheath_of_many_segments_and_blocks_join(form, side, end, own):
    way, cycle = way_mm()
    zero, motion = np.zeros(len(way)), moved(side * way, cycle)
    term, values = SheathForce(form), np.array([STIFFNESS, *own, PRETENSION])
    out, _ = term.respond(zero, motion, values, None)
    pull = way + PRETENSION
    ends = sheath(pull, WRAP, LOAD)[:, end] * (CENTRE if end else 1.0)
    known = side * STIFFNESS * (ends - pull)
    assert out[60:] == pytest.approx(known[60:], abs=0.015 * np.ptp(known))
    first, state = term.respond(zero[:200], motion.rows(slice(0, 200)), values, None)
    rest, _ = term.respond(zero[200:], motion.rows(slice(200, None)), values, state)
    assert np.concatenate([first, rest]) == pytest.approx(out, rel=1e-9, abs=1e-9)


def test_it_is_tried_only_where_the_force_has_one_sign():
    motion = moved(*way_mm())

    def forms(low):
        around = Surroundings(
            drive_span=20.0, drive_unit="mm", angle_unit="N", angle_low=low, angle_span=50.0
        )
        return {t.form for t in SHEATH_FORCES if t.excited(motion, around)}

    assert forms(5.0) == {"near", "far"}
    assert forms(-60.0) == {"near falling", "far falling"}
    assert forms(-25.0) == set()


@pytest.mark.parametrize("end", [0, 1])
def test_friction_that_grows_with_the_pull_is_told_to_the_noise(end):
    way, cycle = way_mm()
    force = STIFFNESS * sheath(way + PRETENSION, WRAP, LOAD)[:, end]
    noise = 0.004 * np.ptp(force)
    measured = force + noise * np.random.default_rng(3).standard_normal(len(way))
    channels = (
        Channel("slider_mm", "command", "mm"),
        Channel("force_n", "measurement", "N"),
        Channel("force_sim_n", "simulation", "N", of="force_n"),
    )
    time_s = 0.1 * np.arange(len(way))
    table = pd.DataFrame(
        {"time_s": time_s, "cycle": cycle, "step": np.tile(np.arange(60), len(SWINGS)),
         "slider_mm": way, "force_n": measured, "force_sim_n": 0.0}
    )  # fmt: skip
    found = diagnose(DiagnosisConfig(), Recording(table, channels, "simulated")).diagnoses[0]
    assert {p.name for p in found.physics} == {"coulomb_friction", "stiffness"}
    assert found.after.heldout_rmse < 1.4 * noise
