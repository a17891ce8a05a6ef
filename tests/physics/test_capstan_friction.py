"""Friction of a wire in a sheath, against a sheath of many segments."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from pipeline.config import DiagnosisConfig
from pipeline.physics.capstan_friction import CapstanFriction
from pipeline.physics.motion import Motion
from pipeline.recording import load_recording
from pipeline.stages.diagnosis import diagnose

WRAP, NOISE_N = 0.25, 0.2


def sheath(pull_n: np.ndarray, wrap: float | np.ndarray, segments: int = 40) -> np.ndarray:
    """Pull at the far end: each segment holds back at most its share of exp(wrap)."""
    held = np.full(segments, pull_n[0])
    out = []
    for pull, share in zip(pull_n, np.exp(wrap / segments + 0.0 * pull_n), strict=True):
        for k in range(segments):
            held[k] = pull = min(max(held[k], pull / share), pull * share)
        out.append(pull)
    return np.array(out)


def pulls_n() -> tuple[np.ndarray, np.ndarray]:
    swings = (18.0, 18.0, 12.0, 18.0, 8.0, 18.0, 15.0, 18.0, 18.0)
    phase = 2.0 * np.pi * np.arange(120) / 120
    pull = np.concatenate([22.0 - swing * np.cos(phase) for swing in swings])
    return pull, np.repeat(np.arange(len(swings)), 120)


def test_it_is_the_sheath_of_many_segments_and_blocks_join():
    pull, cycle = pulls_n()
    motion = Motion(pull, np.arange(len(pull)) * 0.1, cycle)
    values = np.array([WRAP, WRAP, 0.0])
    out, _ = CapstanFriction().respond(pull, motion, values, None)
    known = sheath(pull, WRAP)
    assert out[120:] == pytest.approx(known[120:], rel=1e-9)
    first, state = CapstanFriction().respond(pull[:300], motion.rows(slice(0, 300)), values, None)
    rest, _ = CapstanFriction().respond(pull[300:], motion.rows(slice(300, None)), values, state)
    assert np.concatenate([first, rest]) == pytest.approx(out, rel=1e-12)


def test_it_begins_as_it_was_tightened():
    pull, cycle = pulls_n()
    motion = Motion(pull, np.arange(len(pull)) * 0.1, cycle)
    for values in (np.array([WRAP, WRAP, 0.0]), np.array([WRAP, 5.0, 0.8])):
        form = "capstan" if values[1] == WRAP else "capstan bristle"
        out, _ = CapstanFriction(form).respond(pull, motion, values, None)
        assert out[0] == pytest.approx(pull[0] * np.exp(-WRAP))


def test_it_begins_where_it_was_left():
    pull, cycle = pulls_n()
    motion = Motion(pull, np.arange(len(pull)) * 0.1, cycle)
    for begun in (1.0, 0.3, -1.0):
        values = np.array([WRAP, WRAP, 0.0, begun])
        out, _ = CapstanFriction("capstan begun").respond(pull, motion, values, None)
        assert out[0] == pytest.approx(pull[0] * np.exp(-begun * WRAP))


def diagnosed(folder: Path, asked: np.ndarray, out: np.ndarray, cycle: np.ndarray, unit: str,
              line: bool = False):  # fmt: skip
    """The diagnosis of what a sheath makes (n,) of what is asked (n,), which is the simulation.

    line: the simulation is a line fitted to the measurement instead.
    """
    rng = np.random.default_rng(4)
    measured = 1.02 * out + 0.3 + NOISE_N * rng.standard_normal(len(asked))
    simulated = np.polyval(np.polyfit(asked, measured, 1), asked) if line else asked
    table = pd.DataFrame(
        {"time_s": 0.1 * np.arange(len(asked)), "cycle": cycle, "pull": asked, "out": measured,
         "out_sim": simulated}
    )  # fmt: skip
    table.to_csv(folder / "samples.csv", index=False)
    channels = [
        {"name": "pull", "role": "command", "unit": unit},
        {"name": "out", "role": "measurement", "unit": unit},
        {"name": "out_sim", "role": "simulation", "unit": unit, "of": "out"},
    ]
    head = {"schema": "loopgap.recording/1", "source": "sheath", "channels": channels}
    (folder / "recording.json").write_text(json.dumps(head))
    return diagnose(DiagnosisConfig(), load_recording(folder)).diagnoses[0]


def test_a_pretensioned_wire_is_held_back_the_more_the_further_it_is_pulled(tmp_path: Path):
    pull, cycle = pulls_n()
    found = diagnosed(tmp_path, pull - 22.0, sheath(pull, 0.1) - 22.0, cycle, "mm")
    assert (found.verdict, [p.name for p in found.physics]) == ("explained", ["friction"])
    own = {p.name: p for p in found.physics[0].parameters}
    assert own["wrap"].value == pytest.approx(0.1, rel=0.05)
    assert own["pretension"].value == pytest.approx(22.0, rel=0.05)
    assert found.after.heldout_rmse < 1.1 * NOISE_N


def test_a_sheath_that_is_bent_anew_is_friction_and_no_other_name(tmp_path: Path):
    pull, cycle = pulls_n()
    bent = 0.3 * np.clip((np.arange(len(pull)) - 500) / 60, 0.0, 1.0)
    found = diagnosed(tmp_path, pull, sheath(pull, 0.1 + bent), cycle, "N")
    assert [p.name for p in found.physics] == ["friction"]
    own = {p.name: p for p in found.physics[0].parameters}
    assert own["wrap"].value == pytest.approx(0.1, rel=0.05)
    assert own["later"].value == pytest.approx(0.4, rel=0.05)
    assert own["bent"].value == pytest.approx(50.0, abs=2.0)
    assert found.after.heldout_rmse < 1.1 * NOISE_N


def test_a_sheath_that_is_not_bent_anew_stays_what_it_was_and_blocks_join():
    pull, cycle = pulls_n()
    motion = Motion(pull, np.arange(len(pull)) * 0.1, cycle)
    term, still = CapstanFriction("capstan bent"), np.array([WRAP, WRAP, 0.1, WRAP, 30.0, 5.0])
    same = CapstanFriction().respond(pull, motion, still[:3], None)[0]
    assert term.respond(pull, motion, still, None)[0] == pytest.approx(same)
    values = np.array([WRAP, WRAP, 0.1, 0.5, 20.0, 30.0])
    out, _ = term.respond(pull, motion, values, None)
    first, state = term.respond(pull[:300], motion.rows(slice(0, 300)), values, None)
    rest, _ = term.respond(pull[300:], motion.rows(slice(300, None)), values, state)
    assert np.concatenate([first, rest]) == pytest.approx(out, rel=1e-12)


@pytest.mark.parametrize("bent", [WRAP, 3 * WRAP])
def test_a_sheath_is_named_and_its_wrap_found(tmp_path: Path, bent: float):
    pull, cycle = pulls_n()
    found = diagnosed(tmp_path, pull, sheath(pull, bent), cycle, "N")
    assert (found.verdict, [p.name for p in found.physics]) == ("explained", ["friction"])
    wrap = found.physics[0].parameters[0]
    assert wrap.low < bent < wrap.high
    assert found.after.heldout_rmse < 1.1 * NOISE_N


@pytest.mark.parametrize("begun", [20, 90])
def test_beside_a_fitted_line_the_pull_is_what_friction_takes_its_share_of(
    tmp_path: Path, begun: int
):
    pull, cycle = (np.roll(column, -begun) for column in pulls_n())
    cycle = np.where(np.arange(len(cycle)) >= len(cycle) - begun, 8, cycle)
    found = diagnosed(tmp_path, pull, sheath(pull, 2 * WRAP), cycle, "N", line=True)
    assert [p.name for p in found.physics] == ["friction"]
    assert found.physics[0].parameters[0].value == pytest.approx(2 * WRAP, rel=0.03)
    assert found.after.heldout_rmse < 1.1 * NOISE_N


def test_a_wire_that_was_let_go_before_the_first_sample_is_no_other_physics(tmp_path: Path):
    rng = np.random.default_rng(2)
    swing = np.convolve(rng.standard_normal(900), np.hanning(60), "valid")[:600]
    pull = 18.0 + 12.0 * swing / np.abs(swing).max()
    out = sheath(np.concatenate([[pull[0] * np.exp(0.5 * WRAP)], pull]), WRAP, 1)[1:]
    found = diagnosed(tmp_path, pull, out, np.arange(600) // 150, "N", line=True)
    assert (found.verdict, [p.name for p in found.physics]) == ("explained", ["friction"])
    assert found.after.heldout_rmse < 1.1 * NOISE_N
