"""What flexible curves find in a residual, and what they find in noise alone."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.judgement.rest import (
    DOUBTED,
    Rest,
    common_size,
    repeated_rest,
    structured_rest,
)
from pipeline.discrepancy.judgement.structure import of_curves, of_repeats
from pipeline.discrepancy.noise.learning import learn_noise
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.search.weighing import Choice
from pipeline.physics.play_operator import play
from tests.discrepancy.made import chosen, explanation_of, followed, posed, strokes

CORRELATION, NOISE = 0.85, 0.15


def noise_of(cycle: np.ndarray, jitter: float, rng: np.random.Generator) -> np.ndarray:
    """Of a first-order autoregression, its zero drawn anew in each cycle, (n,)."""
    fresh = rng.standard_normal(len(cycle))
    slow = fresh.copy()
    for i in range(1, len(cycle)):
        slow[i] = CORRELATION * slow[i - 1] + np.sqrt(1.0 - CORRELATION**2) * fresh[i]
    return NOISE * (slow + jitter * rng.standard_normal(int(cycle.max()) + 1)[cycle])


def drawn(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """A drive that goes back and forth at random, and its cycles of 200 samples, (n,) each."""
    drive = strokes(rng.uniform(15.0, 50.0, 72) * (-1.0) ** np.arange(72), 25)
    return drive, np.arange(len(drive)) // 200


def chances(drive: np.ndarray, seen: np.ndarray) -> dict[str, float]:
    """What each family of curves finds beside calibration, as p-values."""
    problem = posed(followed(3.0 * np.arange(len(drive)), drive, seen, 1.0 / 600.0))
    ground = ground_of(problem, NoiseModel(0.05, 0.14, CORRELATION), problem.train)
    plain = Choice(evaluate(ground, ()), (0, 0, 0), 0.0)
    family = explanation_of([plain]).search.family
    noise, place = family.pick(problem.measured - plain.fit.predicted, plain.place)
    calibrated = Choice(evaluate(ground.with_noise(noise), ()), place, 0.0)
    return {r.where: r.p_value for r in structured_rest(calibrated, family)}


@pytest.mark.parametrize(("seed", "bump"), [(6, 0.0), (7, 0.0), (6, 0.4), (7, 0.4)])
def test_noise_that_is_slow_and_jitters_is_no_structure_of_the_cycles(seed: int, bump: float):
    rng = np.random.default_rng(seed)
    drive, cycle = drawn(rng)
    structure = bump * np.sin(drive / 8.0) * (cycle % 3 == 0)
    seen = 1.01 * drive + 0.3 + noise_of(cycle, 0.5, rng) + structure
    assert (chances(drive, seen)["the cycle"] < DOUBTED) == (bump > 0.0)


@pytest.mark.parametrize("lost", [0.0, 0.01])
def test_a_gain_that_falls_is_surer_over_all_cycles_than_in_each(lost: float):
    rng = np.random.default_rng(9)
    drive, cycle = drawn(rng)
    gain = 1.01 - lost * np.arange(len(drive)) / len(drive)
    found = chances(drive, gain * drive + 0.3 + noise_of(cycle, 0.0, rng))
    assert (found["the gain, which changes with time"] < 1e-7) == (lost > 0.0)
    assert found["the gain in each cycle"] > 1e-6


@pytest.mark.parametrize(("ahead", "strain"), [(0.1, 16.0), (0.1, 0.0), (0.0, 16.0)])
def test_a_zero_does_not_walk_alike_in_each_cycle(ahead: float, strain: float):
    """A loop that runs ahead in cycles of many small steps, which a walk takes for its own."""
    drive = strokes(np.tile([8.0, 0.0], 7), 191)
    loop = ahead * (drive - play(drive, 0.32, 0.0)) / 0.32
    fresh = 0.05 * np.random.default_rng(4).standard_normal(len(drive))
    seen = 1.01 * drive + 0.3 + loop + fresh
    problem = posed(followed(1.73 * np.arange(len(drive)), drive, seen, 1.0 / (1.73 * 382)))
    prior = learn_noise(problem)
    walking = replace(prior.model, walk=0.04)
    choice = Choice(evaluate(ground_of(problem, walking, problem.train), ()), (0, 0, 0), 0.0)
    found = explanation_of([choice])
    family = found.search.family
    family = replace(family, prior=prior, strain=np.full_like(family.strain, strain))
    found = replace(found, prior=prior, search=replace(found.search, family=family))
    assert repeated_rest(choice, prior).size < 0.5 * walking.deviation
    size = common_size(choice, prior)
    assert size == pytest.approx(np.std(loop), abs=0.02)
    sign = of_repeats(found, choice)
    assert (sign is not None) == (ahead > 0.0 and strain > 0.0)


def test_noise_that_is_drawn_is_as_its_model_says():
    cycle, still = np.arange(40000) // 100, np.zeros(40000, dtype=bool)
    model = NoiseModel(white=0.1, correlated=0.3, correlation=0.7, jitter=0.5)
    noise = model.drawn(cycle, still, np.random.default_rng(1)).reshape(-1, 100)
    means = noise.mean(axis=1)
    own = noise - means[:, None]
    assert np.std(means) == pytest.approx(0.5, rel=0.1)
    assert np.std(own) == pytest.approx(model.deviation, rel=0.1)
    assert np.mean(own[:, 1:] * own[:, :-1]) == pytest.approx(0.7 * 0.3**2, rel=0.15)
    walk = NoiseModel(white=0.0, walk=0.2).drawn(cycle, still, np.random.default_rng(2))
    assert np.std(np.diff(walk)) == pytest.approx(0.2, rel=0.05)


@pytest.mark.parametrize(
    ("walk", "named", "found"), [(0.01, False, True), (0.0, False, False), (0.01, True, False)]
)
def test_beside_a_zero_that_walks_the_size_of_a_rest_says_nothing_without_names(walk, named, found):
    cycle = np.repeat(np.arange(4), 100)
    drive = strokes(np.array([40.0, -40.0] * 4), 50)
    problem = posed(followed(np.arange(len(cycle), dtype=float), drive, drive, 1.0))
    ground = ground_of(problem, NoiseModel(white=NOISE, walk=walk), problem.train)
    choice = chosen(ground, 0.0, **({"backlash": [0.1]} if named else {}))
    rests = [Rest("the gain in each cycle", 52.0, 10, 1e-7, 0.1 * NOISE)]
    assert (of_curves(rests, choice) is not None) == found
