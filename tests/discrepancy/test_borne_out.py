"""Names have to hold in held-out rows, too: what those are told far better without is not told."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.judgement.borne_out import (
    borne_out,
    error_on,
    foretold,
    refuted_note,
)
from pipeline.discrepancy.judgement.mistaken import follow_the_drive
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.recording import reversals_of
from tests.discrepancy.made import (
    ANGLE,
    NOISE,
    STEPS,
    chosen,
    diagnosed,
    explained,
    explanation_of,
    posed,
    recorded,
)

FRICTION = {"width": 3.0, "reach": 2.0, "spread": 0.0}
SLIP = {"jump": 2.0, "time": 3.0 + 3.36 * (3.5 * STEPS)}
BACK = {"jump_2": -2.0, "time_2": 3.0 + 3.36 * (8.2 * STEPS)}


@pytest.mark.parametrize(
    ("hidden", "stays"),
    [
        ({}, False),
        ({"lost_steps/once": SLIP}, True),
        ({"lost_steps/twice": SLIP | BACK}, True),
    ],
    ids=["no slip", "a slip", "one that comes back in rows that were not fitted"],
)
def test_a_slip_stays_only_where_held_out_rows_bear_it_out(hidden, stays):
    seen = recorded({"friction": FRICTION} | hidden, cycles=9, gain=1.0, offset=0.0)
    problem = posed(seen)
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    friction, slip = [*FRICTION.values()], [*SLIP.values()]
    both = chosen(ground, 0.0, friction=friction, lost_steps=slip)
    plain = chosen(ground, 10.0, friction=friction)
    explanation = explanation_of([both, plain, chosen(ground, 900.0)])
    assert borne_out(problem, explanation, both) is (both if stays else plain)


def test_a_zero_that_came_back_in_held_out_rows_is_told_as_one_that_wanders():
    recording = recorded({"friction": FRICTION}, seed=3, cycles=9)
    samples = recording.samples.copy()
    samples.loc[np.isin(samples["cycle"], [6, 7]), ANGLE] += 2.0
    found = diagnosed(replace(recording, samples=samples)).diagnoses[0]
    assert {p.name for p in found.physics} == {"friction", "drift"}
    assert all(p.heldout_rmse_without > 0.9 * found.after.heldout_rmse for p in found.physics)
    assert found.after.heldout_rmse < 1.0
    assert any("Held-out rows refute" in note for note in found.notes)


def test_a_name_that_was_given_up_is_noted():
    assert refuted_note(frozenset()) == []
    (said,) = refuted_note(frozenset({"lost_steps", "drift"}))
    assert "refute the drift and lost_steps that" in said
    assert "in sight" in said


def test_rows_that_stand_off_after_reversals_follow_the_drive():
    recording = recorded({}, cycles=9)
    rng = np.random.default_rng(4)
    after = reversals_of(recording.values("pitch_command_deg"))[::2] + 1
    anywhere = rng.choice(len(recording.samples), len(after), replace=False)
    for rows, follow in ((after, True), (anywhere, False)):
        samples = recording.samples.copy()
        samples.loc[rows, ANGLE] += 20.0 * NOISE * rng.choice([-1.0, 1.0], len(rows))
        assert follow_the_drive(explained(replace(recording, samples=samples))) is follow


def test_names_of_which_each_needs_the_others_go_together_where_none_is_better():
    problem = posed(recorded({}, cycles=9, gain=1.0, offset=0.0))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    false = {
        "friction": [4.8, 2.0, 0.0],
        "lost_steps": [8.0, SLIP["time"]],
        "transmission_ripple": [4.5, 30.0, 0.0],
    }
    every, plain = chosen(ground, 0.0, **false), chosen(ground, 90.0)
    pairs = [
        chosen(ground, 50.0, **{k: v for k, v in false.items() if k != name}) for name in false
    ]
    rows = foretold(problem, explanation_of([every]), every)
    errors = [error_on(problem, choice, rows) for choice in (every, *pairs)]
    assert 1.5 * min(errors[1:]) > errors[0]
    assert borne_out(problem, explanation_of([every, *pairs, plain]), every) is plain
