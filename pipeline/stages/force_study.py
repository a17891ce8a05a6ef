"""A study of force against motion: how far the diagnosis and simpler laws are off, in one table."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pandas as pd
from scipy.signal import decimate

from pipeline.discrepancy.model.model import CorrectedModel
from pipeline.discrepancy.model.result import Diagnosis, Evidence
from pipeline.discrepancy.problem.rows import Averaged, averaged_evenly
from pipeline.models.force_laws import LAWS, Features, stops_of, symmetric_weights
from pipeline.physics.force_motion import force_motion
from pipeline.physics.motion import Motion
from pipeline.recording import Recording
from pipeline.stages.comparison import comparison
from pipeline.stages.prediction import motion_for

DECIMATION = 10
ENDS = 5
DIAGNOSED = "diagnosis"
Z = 1.96


def relative_error(measured: np.ndarray, predicted: np.ndarray, rows: np.ndarray) -> float:
    """||measured - predicted|| / ||measured|| [%] over some rows, as the benchmark has it.

    Both are low-passed without delay and decimated ten times first (the parallel filter; Chebyshev
    of order 8 at 0.8 of the new Nyquist frequency), and five rows at each end are left out. rows:
    (n,) mask; a decimated row counts where its sample does. Source: Janot, Gautier and Brunot, Data
    set and reference models of EMPS, Nonlinear System Identification Benchmarks (2019).
    """
    coarse = [decimate(v, DECIMATION, zero_phase=True) for v in (measured - predicted, measured)]
    wanted = rows[::DECIMATION].copy()
    wanted[:ENDS] = wanted[-ENDS:] = False
    off, force = (v[wanted] for v in coarse)
    return 100.0 * float(np.linalg.norm(off) / np.linalg.norm(force))


def errors_table(
    model: CorrectedModel,
    evidence: Evidence,
    fitted: Recording,
    other: Recording,
    cutoff_hz: float | None,
) -> pd.DataFrame:
    """Relative error [%] of the diagnosis and of each law: fitted recording, its held-out cycles,
    another recording.

    Laws are fitted to the rows that the diagnosis was, as means over ten samples; they know of no
    delay.
    """
    name = model.measurement
    recordings = (fitted, other)
    diagnosed = [model.mechanism.respond(motion_for(model, r, cutoff_hz))[0] for r in recordings]
    motions = [motion_for(replace(model, delay_s=0.0), r, cutoff_hz) for r in recordings]
    forces = [r.values(name) for r in recordings]
    span = float(np.ptp(motions[0].drive))
    blocks = averaged_evenly(motions[0], DECIMATION)
    rows = blocks.mean(evidence.train.astype(float)) == 1.0
    learnt = _features(motions[0], span, blocks, rows)
    force = blocks.mean(forces[0])[rows]
    whole = [_features(m, span) for m in motions]
    answers = {DIAGNOSED: diagnosed}
    for law, fit in LAWS.items():
        answer = fit(learnt, force)
        answers[law] = [answer(f) for f in whole]
    masks = {
        "fitted recording (%)": (0, np.ones(len(forces[0]), dtype=bool)),
        "its held-out cycles (%)": (0, evidence.heldout),
        "other recording (%)": (1, np.ones(len(forces[1]), dtype=bool)),
    }

    def judge(place: int, wanted: np.ndarray) -> Callable[[list[np.ndarray]], float]:
        return lambda said: relative_error(forces[place], said[place], wanted)

    return comparison(answers.items(), {name: judge(*where) for name, where in masks.items()})


def parameters_table(
    model: CorrectedModel,
    diagnosis: Diagnosis,
    evidence: Evidence,
    fitted: Recording,
    mass: float,
    published: Mapping[str, float],
    cutoff_hz: float | None,
) -> pd.DataFrame:
    """Each parameter with its 95 % interval beside the published one and plain least squares.

    mass: that the simulation has; what the calibration's gain and an inertia make of it is what
    the recording shows. Least squares of the published model goes over all rows of the recording.
    """
    found = {
        f"{p.name}.{e.name}": (e.value, e.low, e.high, e.unit)
        for p in diagnosis.physics
        for e in p.parameters
    }
    extra = found.pop("inertia.mass", (0.0, 0.0, 0.0, "kg"))
    gain, offset = (
        [value + reach * np.sqrt(model.covariance[k, k]) for reach in (0.0, -Z, Z)]
        for k, value in enumerate((diagnosis.calibration.gain, diagnosis.calibration.offset))
    )
    moved = [g * mass + e for g, e in zip(gain, extra[:3], strict=True)]
    found = {"inertia.mass": (*moved, extra[3]), **found, "offset": (*offset, diagnosis.unit)}
    delay = diagnosis.calibration.delay_s
    found["delay"] = (np.nan if delay is None else delay, np.nan, np.nan, "s")
    name = diagnosis.measurement
    motion = force_motion(fitted, evidence.drive, np.zeros(len(fitted.samples)), cutoff_hz)[0]
    blocks = averaged_evenly(motion, DECIMATION)
    every = np.ones(len(motion) // DECIMATION, dtype=bool)
    features = _features(motion, float(np.ptp(motion.drive)), blocks, every)
    plain = dict(zip(
        ("inertia.mass", "viscous_friction.damping", "coulomb_friction.force", "offset"),
        symmetric_weights(features, blocks.mean(fitted.values(name))), strict=True,
    ))  # fmt: skip
    return pd.DataFrame(
        [
            {
                "parameter": key, "found": value, "low": low, "high": high, "unit": unit,
                "published": published.get(key, np.nan),
                "off (%)": _off(key, value, published),
                "symmetric least squares": plain.get(key, np.nan),
            }
            for key, (value, low, high, unit) in found.items()
        ]
    )  # fmt: skip


def _off(key: str, value: float, published: Mapping[str, float]) -> float:
    """Percent; of an offset it says nothing, for friction that differs by direction holds it."""
    known = key in published and key != "offset"
    return 100.0 * (value / published[key] - 1.0) if known else np.nan


def _features(
    motion: Motion, span: float, blocks: Averaged | None = None, rows: np.ndarray | None = None
) -> Features:
    """A motion's features, or their means over blocks on some of these."""
    kinetics = motion.kinetics
    assert kinetics is not None
    columns = [motion.drive, kinetics.velocity, kinetics.acceleration, kinetics.simulated]
    stops = stops_of(motion.drive, span)
    if blocks is not None and rows is not None:
        columns = [blocks.mean(c)[rows] for c in columns]
        stops = np.column_stack([blocks.mean(c)[rows] for c in stops.T])
    position, velocity, acceleration, simulated = columns
    return Features(position, velocity, acceleration, simulated, stops)
