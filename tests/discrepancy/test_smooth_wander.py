"""A zero that wanders smoothly is a drift; a gain or play that wanders is none."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from pipeline.discrepancy.fitting.fit import evaluate
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.judgement import decision, smooth_wander
from pipeline.discrepancy.judgement.mistaken import late_by
from pipeline.discrepancy.judgement.smooth_wander import (
    beside,
    carriers,
    direction,
    follows_commands,
    may_wander,
    smoother_than_a_walk,
    wandering,
    zero_that_wanders,
)
from pipeline.discrepancy.noise.learning import NoisePrior
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.search.explain import Explanation
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from pipeline.recording import Recording
from tests.discrepancy.made import (
    ANGLE,
    NOISE,
    SIMULATED,
    STEPS,
    changed,
    chosen,
    diagnosed,
    explained,
    explanation_of,
    followed,
    posed,
    recorded,
)

CYCLES = 9
PLAY = {"backlash": {"width": 4.0}}


def wander(seed: int, width: float = 0.15) -> np.ndarray:
    """What goes smoothly to and fro, of size 1 (RMS); width: over the cycle."""
    steps = np.random.default_rng(seed).standard_normal(CYCLES * STEPS)
    smooth = gaussian_filter1d(np.cumsum(steps), width * STEPS, mode="nearest")
    smooth -= smooth.mean()
    return smooth / np.std(smooth)


def made(hidden: dict, seed: int, size: float, carrier: str = "zero") -> Recording:
    """A recording in which something wanders by `size` times the noise."""
    recording = recorded(hidden, cycles=CYCLES, seed=seed)
    drive = recording.values("pitch_command_deg")
    place = (drive - drive.mean()) / np.std(drive)
    carried = {
        "zero": np.ones(len(drive)),
        "gain": place,
        "one side": np.sqrt(2.0) * np.maximum(place, 0.0),
        "beyond an end": (place + 2.2) / np.sqrt(1.0 + 2.2**2),
        "play": direction(place, 0.2),
    }[carrier]
    off = size * NOISE * wander(seed) * carried
    return changed(recording, **{ANGLE: recording.values(ANGLE) + off})


@pytest.mark.parametrize("hidden", [{}, PLAY], ids=["alone", "beside play"])
@pytest.mark.parametrize("seed", [6, 9])
@pytest.mark.long
def test_it_is_named_as_a_drift_with_its_size(hidden, seed):
    (told,) = diagnosed(made(hidden, seed, 6.0)).diagnoses
    assert told.verdict == "explained"
    assert {p.name for p in told.physics} == {"drift", *hidden}
    (drift,) = (p for p in told.physics if p.name == "drift")
    (size,) = drift.parameters
    assert (size.name, size.unit) == ("deviation", "deg")
    assert size.low < 6.0 * NOISE < size.high
    assert told.noise == pytest.approx(NOISE, rel=0.1)


def test_beside_it_no_frame_is_taken_for_mistaken():
    """It is farther from zero than the noise is, in a few rows very far."""
    recording = recorded({}, cycles=CYCLES, seed=4)
    moved = recording.values(ANGLE) + 30.0 * NOISE * wander(4, 0.3)
    (told,) = diagnosed(changed(recording, **{ANGLE: moved})).diagnoses
    assert {p.name for p in told.physics} == {"drift"}


@pytest.mark.parametrize("told", [True, False], ids=["where it is known", "where it is not"])
def test_frames_are_late_only_from_where_the_zero_is(told):
    """A zero that moves by a step of the joint in every other row looks as late frames do."""
    recording = recorded({}, cycles=CYCLES)
    simulated = recording.values(SIMULATED)
    step = np.diff(simulated, prepend=simulated[0])
    zero = -step * (np.random.default_rng(3).random(len(step)) < 0.4)
    problem = posed(changed(recording, **{ANGLE: recording.values(ANGLE) + zero}))
    choice = chosen(ground_of(problem, NoiseModel(white=NOISE), problem.train), 0.0)
    explanation = explanation_of([choice])
    explanation = replace(explanation, zero=zero) if told else explanation
    assert bool(late_by(explanation, choice).late.any()) is not told


def test_its_calibration_is_about_where_it_is_on_average_not_at_first():
    recording = recorded({}, cycles=CYCLES, seed=1)
    coming = 30.0 * NOISE * (wander(1, 0.3) - 3.0 * np.exp(-np.arange(CYCLES * STEPS) / STEPS))
    found = explained(changed(recording, **{ANGLE: recording.values(ANGLE) + coming}))
    told = decision.decided(found.problem, found)
    assert told.wander is not None
    left = (found.problem.measured - told.choice.fit.predicted)[found.used]
    assert abs(np.mean(left)) < 1e-6
    assert abs(np.mean(found.problem.measured - told.wander.fit.predicted)) > NOISE


@pytest.mark.parametrize("carrier", ["gain", "one side", "beyond an end", "play"])
@pytest.mark.parametrize("size", [4.0, 8.0])
@pytest.mark.long
def test_what_wanders_with_the_commands_is_no_drift(carrier, size):
    (told,) = diagnosed(made({}, 9, size, carrier)).diagnoses
    assert told.verdict in ("unknown_physics", "partly_explained")


def unrepeated(carrier: str) -> Recording:
    """Steps of any size, no two of them alike, while a zero or gain wanders by 4 of the noise."""
    rng, rows = np.random.default_rng(1), CYCLES * STEPS
    drive = np.repeat(rng.uniform(-20.0, 20.0, rows // 20), 20)
    carried = {"zero": 1.0, "gain": drive / 12.0}[carrier]
    off = 4.0 * NOISE * wander(1) * carried + NOISE * rng.standard_normal(rows)
    return followed(0.1 * np.arange(rows), drive, drive + off, 0.1)


def test_it_is_a_drift_too_where_no_cycle_repeats_another():
    (told,) = diagnosed(unrepeated("zero")).diagnoses
    assert told.verdict == "explained"
    assert [p.name for p in told.physics] == ["drift"]
    assert told.noise == pytest.approx(NOISE, rel=0.1)


@pytest.mark.long
def test_a_gain_that_wanders_is_none_there_either():
    (told,) = diagnosed(unrepeated("gain")).diagnoses
    assert "drift" not in {p.name for p in told.physics}


@pytest.fixture(scope="module")
def drifting() -> Explanation:
    return explained(made(PLAY, 9, 6.0))


@pytest.mark.long
def test_its_names_are_weighed_anew(drifting):
    found = wandering(drifting, drifting.choices[0])
    assert found is not None
    explanation, zero = found
    scores = [c.score for c in explanation.choices]
    assert scores == sorted(scores)
    assert explanation.choices[0].fit is zero.fit
    assert zero.fit.names == ("backlash",)
    assert not any("drift" in c.fit.names for c in explanation.choices)
    assert zero.size == pytest.approx(6.0 * NOISE, rel=0.2)


def test_cycles_have_to_be_as_loud(drifting):
    best = drifting.choices[0]
    model = drifting.prior.model
    quiet = replace(model, white=0.3 * NOISE, correlated=0.0)
    assert wandering(replace(drifting, prior=replace(drifting.prior, model=quiet)), best) is None


def test_nothing_left_beside_it_may_follow_the_commands(drifting, monkeypatch):
    """Without the play, the loop is left: no zero may take that."""
    base, play = (
        next(c for c in drifting.choices if c.fit.names == told) for told in ((), ("backlash",))
    )
    assert follows_commands(drifting, beside(base.fit))
    assert not follows_commands(drifting, beside(play.fit))
    few = replace(drifting, prior=replace(drifting.prior, groups=()))
    assert follows_commands(few, beside(base.fit))
    monkeypatch.setattr(smooth_wander, "follows_commands", lambda *_: True)
    assert wandering(drifting, drifting.choices[0]) is None


def test_noise_that_walks_hides_no_smooth_drift_where_cycles_repeat():
    """By less than three times the noise: a walk would explain it, and nothing be told."""
    (told,) = diagnosed(made(PLAY, 6, 2.5)).diagnoses
    assert {p.name for p in told.physics} == {"backlash", "drift"}


@pytest.mark.parametrize(
    ("course", "size", "smooth"),
    [("smooth", 2.5, True), ("smooth", 0.8, False), ("at random", 2.5, False)],
)
def test_a_walk_at_random_is_none_nor_what_is_near_the_noise(course, size, smooth):
    steps = np.random.default_rng(4).standard_normal(CYCLES * STEPS)
    walk = np.cumsum(steps) - np.mean(np.cumsum(steps))
    zero = wander(6) if course == "smooth" else walk / np.std(walk)
    recording = recorded(PLAY, cycles=CYCLES)
    moved = recording.values(ANGLE) + size * NOISE * zero
    problem = posed(changed(recording, **{ANGLE: moved}))
    noise = NoiseModel(white=NOISE, walk=size * NOISE / np.std(walk))
    choice = chosen(ground_of(problem, noise, problem.train), 0.0, backlash=[4.0])
    assert smoother_than_a_walk(choice) == smooth


def test_a_smooth_change_that_is_no_zero_is_structure_where_a_walk_would_take_it(monkeypatch):
    explanation = explained(made(PLAY, 6, 2.5))
    assert decision.decided(explanation.problem, explanation).wander is not None
    monkeypatch.setattr(decision, "beside_a_wander", lambda *_: None)
    told = decision.decided(explanation.problem, explanation)
    assert told.structure.found
    assert told.structure.where == decision.SMOOTHLY
    best = explanation.choices[0]
    slight = Piece(term("camera_tilt"), np.array([0.2, 0.8]))
    more = replace(best, fit=evaluate(best.fit.ground, (*best.fit.pieces, slight)))
    for choice in (best, more):
        decided = decision.decided_on(explanation.problem, explanation, choice)
        assert decided.structure.where == decision.SMOOTHLY
        assert decided.choice.fit.names == ("backlash",)


@pytest.mark.parametrize(("cycles_a_swing", "drifts"), [(1.37, False), (6.4, True)])
@pytest.mark.long
def test_what_swings_with_one_period_time_and_again_is_no_drift(cycles_a_swing, drifts):
    """A shaking table or a breath, as slow as a drift where pictures are taken seldom."""
    recording = recorded({}, cycles=CYCLES)
    swing = np.sin(2.0 * np.pi * np.arange(CYCLES * STEPS) / (cycles_a_swing * STEPS) + 0.4)
    moved = recording.values(ANGLE) + 6.0 * NOISE * swing
    (told,) = diagnosed(changed(recording, **{ANGLE: moved})).diagnoses
    if drifts:
        assert [p.name for p in told.physics] == ["drift"]
    else:
        assert told.verdict == "unknown_physics"
        assert "again and again every" in told.unexplained.where


@pytest.mark.parametrize("carrier", ["zero", "gain"])
def test_an_offset_that_is_off_leads_no_wander_astray(carrier):
    """Noise that walks leaves any offset: what goes with the commands could not follow that."""
    fit = explained(made({}, 9, 6.0, carrier)).choices[0].fit
    base = evaluate(fit.ground, [])
    off = replace(base, nuisance=base.nuisance + np.array([0.0, 5.0 * NOISE]))
    place = fit.ground.problem.motion.drive / 110.0
    carried = np.ones(len(place)) if carrier == "zero" else place
    likelihood = beside(base, carried).log_likelihood
    assert beside(off, carried).log_likelihood == pytest.approx(likelihood, abs=0.5)
    other = place if carrier == "zero" else np.ones(len(place))
    assert beside(off, other).log_likelihood < likelihood - 22.0


def test_it_is_far_beyond_the_noise_and_slow(drifting):
    _, found = wandering(drifting, drifting.choices[0])
    assert may_wander(found, drifting.prior)
    quick = replace(found, zero=replace(found.zero, pace=14.0 / STEPS))
    near = replace(found, left=found.left * 1.5 * NOISE / np.std(found.left))
    assert not may_wander(quick, drifting.prior)
    assert may_wander(near, drifting.prior)
    assert not may_wander(near, replace(drifting.prior, repeats=0))
    assert not may_wander(replace(near, left=0.6 * near.left), drifting.prior)


@pytest.mark.long
def test_held_out_cycles_and_an_absurd_calibration_speak_against_it(drifting, monkeypatch):
    problem = drifting.problem
    assert decision.decided(problem, drifting).wander is not None
    with monkeypatch.context() as patched:
        patched.setattr(decision, "refuted", lambda *_: True)
        assert decision.decided(problem, drifting).wander is None
    monkeypatch.setattr(decision, "absurd_calibration", lambda _: "the gain, which is 3")
    assert decision.decided(problem, drifting).wander is None


def test_names_that_take_back_what_they_do_are_none(drifting):
    """Where they leave more than there was without them, a zero hides that they are wrong."""
    best = next(c for c in drifting.choices if "backlash" in c.fit.names)
    problem = drifting.problem
    calm = replace(problem, simulated=best.fit.predicted)
    ground = replace(best.fit.ground, problem=calm)
    wrong = replace(best, fit=replace(best.fit, ground=ground))
    assert wandering(replace(drifting, choices=[wrong]), wrong) is None


def test_a_fit_beside_it_has_its_share_refitted(drifting):
    """What a fit took for gain and offset under another noise goes back to the zero."""
    base = next(c for c in drifting.choices if not c.fit.pieces)
    found = beside(base.fit)
    used = base.fit.ground.used
    assert not np.any(found.left[~used])
    steady = np.ones(len(used))
    before = np.where(used, base.fit.ground.problem.measured - base.fit.predicted, 0.0)
    assert found.log_likelihood >= found.zero.log_likelihood(before, steady, used)


def test_carriers_are_the_same_at_any_scale():
    drive = np.sin(np.arange(200) / 9.0)
    for one, other in zip(carriers(drive), carriers(50.0 + 7.0 * drive), strict=True):
        assert other == pytest.approx(one)


def test_the_direction_turns_within_the_width():
    drive = np.array([0.0, 1.0, 2.0, 1.5, 1.0, 0.0, -1.0])
    assert direction(drive, 0.5).tolist() == [0.0, 1.0, 1.0, 0.0, -1.0, -1.0, -1.0]


def test_it_says_how_far(drifting):
    _, zero = wandering(drifting, drifting.choices[0])
    (evidence,) = diagnosed(recorded(PLAY, cycles=CYCLES)).evidence
    told = zero_that_wanders(zero, evidence)
    assert (told.name, told.site, told.alternatives) == ("drift", "sensor", ())
    assert told.says.startswith("The zero wanders smoothly, by about 1.")


@pytest.mark.parametrize(("lead", "sure"), [(18.0, False), (25.0, True)])
def test_a_zero_has_to_be_much_likelier_than_all_else_that_may_wander(monkeypatch, lead, sure):
    found = beside(explained(made({}, 6, 6.0)).choices[0].fit)
    other = replace(found, log_likelihood=found.log_likelihood - lead)
    monkeypatch.setattr(smooth_wander, "beside", lambda *_: other)
    assert smooth_wander.is_zero(found) == sure


@pytest.mark.parametrize("rings", [True, False])
@pytest.mark.long
def test_beside_what_rings_after_long_steps_no_zero_is_said_to_wander(rings):
    """Cycles in which one step in ten is four times as long; samples that are off after those."""
    way = np.where(np.arange(STEPS // 2) % 10 == 3, 4.0, 1.0)
    stroke = np.cumsum(way) / way.sum()
    cycle = 110.0 * np.concatenate([stroke, stroke[::-1]]) - 55.0
    command = np.tile(cycle, CYCLES)
    plain, rng = recorded({}, cycles=CYCLES), np.random.default_rng(8)
    long = np.flatnonzero(np.abs(np.diff(command, prepend=command[:1])) > 3.0)
    off = np.zeros(len(command))
    off[rng.choice(long if rings else len(command), 14, replace=False)] = 9.0
    angle = 0.7 * command
    noise = NOISE * rng.standard_normal(len(command))
    measured = angle + off + noise + 6.0 * NOISE * wander(6)
    columns = {"pitch_command_deg": command, SIMULATED: angle, ANGLE: measured}
    (told,) = diagnosed(changed(plain, **columns)).diagnoses
    assert ("drift" in {p.name for p in told.physics}) != rings
    assert (told.verdict == "explained") != rings


@pytest.mark.parametrize(("size", "may"), [(8.0, True), (40.0, False)])
def test_where_nothing_repeats_a_zero_does_not_go_as_fast_and_as_far_as_the_mechanism(size, may):
    recording = recorded({}, cycles=CYCLES, seed=1)
    fast = size * NOISE * wander(1, width=0.04)
    problem = posed(changed(recording, **{ANGLE: recording.values(ANGLE) + fast}))
    fit = evaluate(ground_of(problem, NoiseModel(NOISE), problem.train), ())
    found, prior = beside(fit), NoisePrior(NoiseModel(NOISE), 0, 0.3, ())
    assert may_wander(found, prior) == may
    assert may_wander(found, replace(prior, repeats=6))
