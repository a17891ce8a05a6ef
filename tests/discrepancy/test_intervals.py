"""Intervals: what a command's own way takes of a lag, and where a size is told."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from pipeline.config import DiagnosisConfig, ToleranceConfig
from pipeline.discrepancy.model.intervals import LONGEST_MOVE, arrival_s, estimates, stated
from pipeline.number_words import worded
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from pipeline.stages.diagnosis import diagnose
from tests.discrepancy.made import recorded
from tests.discrepancy.test_fit import fitted, widened

DWELL_S = 3.0


def late(asked: np.ndarray, lag_s: float, move_s: float) -> np.ndarray:
    """A first-order lag at the end of each dwell (n,), the command running for the first move_s."""
    out, at, before = np.empty(len(asked)), asked[0], asked[0]
    for k, u in enumerate(asked):
        if move_s > 0.0:
            speed = (u - before) / move_s
            fade = np.exp(-move_s / lag_s)
            at = u - speed * lag_s + (at - before + speed * lag_s) * fade
        at = u - (u - at) * np.exp(-(DWELL_S - move_s) / lag_s)
        out[k], before = at, u
    return out


@pytest.mark.parametrize("lag_s", [1.0, 3.0, 12.0])
def test_a_lag_takes_the_longer_it_is_the_more_of_the_way_of_a_command(lag_s):
    asked = 30.0 * np.sin(np.linspace(0.0, 20.0, 400))
    seen = late(asked, lag_s, 0.05 * DWELL_S)
    found = minimize_scalar(
        lambda lag: np.sum((late(asked, lag, 0.0) - seen) ** 2),
        bounds=(0.5 * lag_s, 2.0 * lag_s),
        method="bounded",
        options={"xatol": 1e-6},
    ).x
    longest = np.sqrt(3.0) * arrival_s(DWELL_S, lag_s)
    assert (found - lag_s) * LONGEST_MOVE / 0.05 == pytest.approx(longest, rel=0.15)


def test_an_old_frame_is_told_as_narrowly_as_it_is_known():
    begun = (Piece(term("frame_lag"), np.array([2.0])),)
    fit = fitted(3, {"frame_lag": {"lag": 2.0}}, begun)
    covariance = widened(fit)
    lag = estimates(fit, covariance)[0][1][0]
    reach = 1.96 * np.sqrt(covariance[len(fit.nuisance), len(fit.nuisance)])
    assert lag.high - lag.value == pytest.approx(reach)


def test_a_friction_that_the_drive_bends_is_told_at_the_joint():
    driven = term("friction", "driven")
    fit = fitted(3, {"friction/driven": {"width": 6.0, "reach": 4.0, "release": 1.0}},
                 (Piece(driven, np.array([5.0, 4.0, 1.0])),))  # fmt: skip
    around = fit.ground.problem.around
    slope = around.angle_span / around.drive_span
    assert slope != pytest.approx(1.0, abs=0.1)
    width, reach = estimates(fit, widened(fit))[0][1][:2]
    assert width.value == pytest.approx(6.0 * slope, rel=0.03)
    assert width.low < width.value < width.high < 6.0 * slope * 1.1
    assert stated(fit, fit.pieces[0])[:2] == pytest.approx([width.value, reach.value])
    assert {width.unit, reach.unit} == {around.angle_unit}


@pytest.mark.parametrize("shape_deg", [0.0, 0.3])
def test_a_stop_is_told_as_the_measurement_reads_there_too(shape_deg: float):
    """An affine calibration (gain 1.02, offset 1.5) parts the two; a smooth error takes part."""
    recording = recorded({"end_stop/upper": {"angle": 25.0}}, cycles=9, offset=1.5)
    tolerance = ToleranceConfig(shape=shape_deg)
    (told,) = diagnose(DiagnosisConfig(tolerance=tolerance), recording).diagnoses
    (stop,) = told.physics
    found = {e.name: e for e in stop.parameters}
    read = found["angle measured"]
    assert read.low < 1.02 * 25.0 + 1.5 < read.high
    assert read.high - read.low < 1.2
    assert not found["angle"].low < read.value < found["angle"].high
    assert f"The measurement reads {worded(read.value)} deg there." in stop.says


@pytest.mark.parametrize(("beside", "told"), [("gravity", True), ("camera_tilt", False)])
def test_a_sensor_that_bends_leaves_no_reading_that_calibration_tells(beside: str, told: bool):
    bends = np.array([0.5, 0.2])
    stop = Piece(term("end_stop", "upper"), np.array([26.0, 0.3, 0.02]))
    fit = fitted(3, {"end_stop/upper": {"angle": 25.0}}, (stop, Piece(term(beside), bends)))
    names = {e.name for _, own in estimates(fit, widened(fit)) for e in own}
    assert ("angle measured" in names) == told
