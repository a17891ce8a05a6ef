"""A zero that walks: noise, until it goes by many times the noise; then it is a drift."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.judgement.cycle_zero import leaves_less
from pipeline.discrepancy.judgement.proof import counted_errors, strained
from pipeline.discrepancy.judgement.walking_zero import (
    walk_in_a_cycle,
    walks_far,
    witnessed,
    zero_that_walks,
)
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.search.explain import Explanation
from tests.discrepancy.made import (
    ANGLE,
    NOISE,
    STEPS,
    changed,
    chosen,
    diagnosed,
    explanation_of,
    posed,
    recorded,
)

PLAY = {"backlash": {"width": 4.0}}


def walked(
    times: float, *, repeats: int = 6, strain: float = 0.0, walk: float = 0.1
) -> Explanation:
    """What has found play beside a zero that goes `times` deviations of the noise to and fro."""
    recording = recorded(PLAY, cycles=9)
    zero = times * NOISE * np.sqrt(2.0) * np.sin(np.arange(9 * STEPS) / 150.0)
    problem = posed(changed(recording, **{ANGLE: recording.values(ANGLE) + zero}))
    noise = NoiseModel(white=NOISE, walk=walk * NOISE)
    choice = chosen(ground_of(problem, noise, problem.train), 0.0, backlash=[4.0])
    return explanation_of([choice], repeats=repeats, strain=strain)


@pytest.mark.parametrize(("times", "far"), [(2.0, False), (4.0, True)])
def test_beside_names_it_is_a_drift_from_three_times_the_noise_on(times, far):
    explanation = walked(times)
    (choice,) = explanation.choices
    assert walks_far(explanation, choice) == far
    alone = replace(choice, fit=replace(choice.fit, pieces=()))
    assert not walks_far(explanation, alone) or times > 5.0


def test_it_does_not_hide_that_names_are_wrong():
    explanation = walked(4.0)
    (choice,) = explanation.choices
    wrong = chosen(choice.fit.ground, 0.0, backlash=[70.0])
    assert witnessed(explanation, wrong)
    assert not walks_far(explanation, wrong)


def test_calibration_alone_hides_no_names():
    """A zero that wanders may lead it off, as it leads names off that are not there."""
    (choice,) = walked(4.0).choices
    off = np.array([1.6, 0.0])
    wrong, alone = (replace(choice.fit, pieces=p, nuisance=off) for p in (choice.fit.pieces, ()))
    assert leaves_less(replace(choice, fit=alone))
    assert not leaves_less(replace(choice, fit=wrong))


@pytest.mark.parametrize(
    "said", [{"repeats": 0}, {"strain": 100.0}, {"walk": 0.0}], ids=["none", "against", "still"]
)
def test_cycles_that_repeat_have_to_bear_it_out(said):
    explanation = walked(8.0, **said)
    assert not witnessed(explanation, explanation.choices[0])
    assert not walks_far(explanation, explanation.choices[0])


def test_held_out_cycles_are_judged_about_zeros_of_their_own():
    """One that walks is elsewhere there, which refutes no names; nor is it a rest beside them."""
    explanation = walked(8.0)
    problem, (choice,) = explanation.problem, explanation.choices
    off, counted = counted_errors(problem, explanation, choice, choice.fit.predicted)
    for cycle in np.unique(problem.cycle):
        rows = counted & (problem.cycle == cycle) & np.isfinite(off)
        assert np.mean(off[rows]) == pytest.approx(0.0, abs=1e-9)
    noise = choice.fit.ground.noise
    assert strained(problem, off, counted, noise, np.inf) is None
    assert strained(problem, 5.0 * off, counted, noise) is not None


def test_how_far_it_walks_in_a_cycle():
    explanation = walked(4.0, walk=0.2)
    expected = 0.2 * NOISE * np.sqrt(STEPS)
    assert walk_in_a_cycle(explanation.choices[0]) == pytest.approx(expected)


@pytest.mark.parametrize("times", [2.0, 4.0])
def test_it_is_told_as_a_drift_with_how_far_it_walks_in_a_cycle(times):
    explanation = walked(times, walk=0.2)
    (evidence,) = diagnosed(recorded(PLAY, cycles=9)).evidence
    told = zero_that_walks(explanation, explanation.choices[0], evidence)
    if times < 3.0:
        assert told is None
        return
    assert told is not None
    assert (told.name, told.alternatives) == ("drift", ())
    (size,) = told.parameters
    assert size.name == "walk_in_a_cycle"
    assert size.low < size.value == walk_in_a_cycle(explanation.choices[0]) < size.high


@pytest.mark.long
def test_of_zeros_that_walk_few_are_told_as_drifts_and_of_drifts_as_large_most():
    rng = np.random.default_rng(11)
    even = np.linspace(-1.0, 1.0, 9 * STEPS) / np.std(np.linspace(-1.0, 1.0, 9 * STEPS))
    walks = drifts = 0
    for seed in range(25):
        recording = recorded({}, seed=300 + seed, cycles=9)
        noise, size = recording.values(ANGLE), NOISE * rng.uniform(0.7, 2.0)
        walk = np.cumsum(rng.standard_normal(9 * STEPS)) / np.sqrt(9 * STEPS)
        told = [
            diagnosed(changed(recording, **{ANGLE: noise + size * zero})).diagnoses[0]
            for zero in (walk, rng.choice([-1.0, 1.0]) * even)
        ]
        walks += bool(told[0].physics)
        drifts += [p.name for p in told[1].physics] == ["drift"]
    assert walks <= 2
    assert drifts >= 23
