"""One measurement's diagnosis from its explanation: names, proof, calibration and verdict."""

from dataclasses import replace

import numpy as np

from pipeline.discrepancy.explained import explained
from pipeline.discrepancy.judgement.beyond import beyond_its_name
from pipeline.discrepancy.judgement.borne_out import refuted_note
from pipeline.discrepancy.judgement.brought_about import brought_about
from pipeline.discrepancy.judgement.cycle_zero import wanders_by_cycle
from pipeline.discrepancy.judgement.decision import Decision, decided
from pipeline.discrepancy.judgement.faint import without_faint
from pipeline.discrepancy.judgement.force_rest import left_by, mean_square
from pipeline.discrepancy.judgement.form import form_note, names_of_form
from pipeline.discrepancy.judgement.named import named_physics, verdict_of, without_name
from pipeline.discrepancy.judgement.notes import accuracy_note, notes, smooth_error
from pipeline.discrepancy.judgement.refit import likeliest, refitted
from pipeline.discrepancy.judgement.rivals import hypotheses_of, mechanism_of
from pipeline.discrepancy.judgement.smooth_wander import zero_that_wanders
from pipeline.discrepancy.judgement.structure import Structure
from pipeline.discrepancy.model.intervals import covariance_of, wide_covariance
from pipeline.discrepancy.model.model import CorrectedModel, Hypothesis
from pipeline.discrepancy.model.result import (
    Calibration,
    Diagnosis,
    Evidence,
    Unexplained,
    root_mean,
)
from pipeline.discrepancy.model.start import end_of
from pipeline.discrepancy.model.zero import zero_at_end
from pipeline.discrepancy.noise.force_noise import noise_of_samples
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.problem.force_problem import averaged
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.problem.thinning import thinned
from pipeline.discrepancy.search.counted import set_aside, turning
from pipeline.discrepancy.search.excited import not_excited
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.force_late import explained_in_time
from pipeline.discrepancy.search.weighing import Choice
from pipeline.physics.drift import Drift
from pipeline.recording import Recording


def diagnose_measurement(
    recording: Recording, measurement: str, problem: Problem
) -> tuple[Diagnosis, Evidence, CorrectedModel]:
    """Name what the simulation of a measurement left out, with the proof on held-out rows."""
    every = reduced(problem)[1]
    explain = explained if problem.derivatives is None else explained_in_time
    problem, explanation = explain(problem)
    explanation = without_faint(explanation)
    decision = decided(problem, explanation)
    explanation, best, structure = decision.explanation, decision.choice, decision.structure
    accurate, wander = decision.accurate, decision.wander
    hypotheses = hypotheses_of(problem, explanation, best)
    model = corrected(measurement, problem, decision, hypotheses)
    evidence = evidence_of(recording, measurement, problem, explanation, model, hypotheses)
    formal = {} if wander else names_of_form(explanation, best)
    covariance = known(decision, best) if decision.modelled else model.covariance
    named = named_physics(explanation, best, evidence, structure, covariance)
    if wander is not None:
        named = (*(p for p in named if p.name != Drift.name), zero_that_wanders(wander, evidence))
    physics = () if accurate else tuple(p for p in named if p.name not in formal)
    noise = reported_noise(explanation, best, structure, model) if wander is None else wander.noise
    if wanders_by_cycle(best) and any(p.name == Drift.name for p in physics):
        noise = replace(noise, jitter=0.0)
    evidence = replace(evidence, noise=noise)
    before, after = evidence.errors(evidence.before), evidence.errors(evidence.after)
    beyond = None if structure.found else beyond_its_name(explanation, best, physics)
    if beyond is not None:
        structure, formal = beyond, names_of_form(explanation, best, beyond=True)
        named = named_physics(explanation, best, evidence, structure, covariance)
        physics = tuple(p for p in named if p.name not in formal)
    verdict = verdict_of(explanation, best, physics, structure)
    diagnosis = Diagnosis(
        measurement=measurement,
        unit=problem.around.angle_unit,
        verdict=verdict,
        noise=float(np.hypot(noise.deviation, noise.jitter)),
        before=before,
        after=after,
        location=(),
        physics=physics,
        calibration=calibration_of(problem, best),
        unexplained=Unexplained(structure.share, structure.p_value, structure.where),
        not_excited=not_excited(problem),
        next_experiment=None,
        notes=(
            *(accuracy_note(explanation, best) if accurate else ()),
            *refuted_note(decision.refuted),
            *form_note(formal, brought_about(explanation, best), beyond is not None),
            *without_name(best),
            *notes(problem, explanation, best, evidence, every),
        ),
    )
    return diagnosis, evidence, model


def corrected(
    measurement: str, problem: Problem, decision: Decision, hypotheses: tuple[Hypothesis, ...]
) -> CorrectedModel:
    """The model of what was decided, with the explanations that compete with its names."""
    best, structure = decision.choice, decision.structure
    modelled = decision.modelled or best
    covariance = known(decision, modelled)
    model = model_of(measurement, problem, modelled, covariance, structure.wandering)
    rivals = tuple(h for h in hypotheses if set(h.names) != set(best.fit.names))
    model = replace(model, rivals=rivals)
    if not (structure.found or decision.accurate):
        model = going_on(model, problem, decision.explanation, best)
    return replace(model, end=end_of(problem.motion, model.later or model.mechanism))


def known(decision: Decision, choice: Choice) -> np.ndarray:
    """Covariance of a choice's parameters, beside the noise that it may have."""
    if decision.accurate:
        return covariance_of(choice.fit)
    return wide_covariance(choice.fit, choice.place, decision.explanation.search.family)


def reported_noise(
    explanation: Explanation, best: Choice, structure: Structure, model: CorrectedModel
) -> NoiseModel:
    """The noise, without a structured rest that the fit had to take for noise.

    Then it is that of the repeats, if there are any and they are quieter, and of a force what does
    not come again where its motion does.
    """
    noise = model.noise if structure.wandering is None else best.fit.ground.noise
    if structure.found and structure.alike.sure:
        taken = best.fit.ground.noise.white
        again = structure.alike.share * min(taken**2, mean_square(left_by(best)))
        return replace(noise, white=float(np.sqrt(max(noise.white**2 - again, 0.0))))
    if structure.found and explanation.prior.repeats > 0:
        return min(noise, explanation.prior.model, key=lambda n: n.deviation)
    return noise


def calibration_of(problem: Problem, choice: Choice) -> Calibration:
    """Gain and offset of a choice, and the delay of a force."""
    gain, offset = (float(value) for value in choice.fit.nuisance[:2])
    return Calibration(
        gain,
        offset,
        delay_s=None if problem.derivatives is None else problem.delay.value,
        smooth_error=smooth_error(choice),
    )


def reduced(problem: Problem, whole: bool = False) -> tuple[Problem, int]:
    """The problem on as many rows as a fit needs, and how many samples stand behind each.

    whole: up to its last row, even where that is held out.
    """
    if problem.derivatives is None:
        return thinned(problem, whole)
    return averaged(problem)


def model_of(
    measurement: str,
    problem: Problem,
    choice: Choice,
    covariance: np.ndarray,
    wandering: NoiseModel | None = None,
) -> CorrectedModel:
    """What predicts the measurement from now on; wandering: its error, where noise is not all."""
    small, noise = choice.fit.ground.problem, wandering or choice.fit.ground.noise
    if small.averaged is not None:
        noise = noise_of_samples(noise, problem, small.averaged, mechanism_of(problem, choice))
    if problem.read is not None:
        off = root_mean((problem.read - problem.measured)[problem.train] ** 2)
        noise = replace(noise, white=float(np.hypot(noise.white, off)))
    return CorrectedModel(
        measurement=measurement,
        unit=problem.around.angle_unit,
        drive=problem.drive,
        static=problem.static,
        radian=problem.motion.radian,
        mechanism=mechanism_of(problem, choice),
        noise=noise,
        covariance=covariance,
        force=problem.motion.kinetics is not None,
        simulated=problem.motion.kinetics is None or problem.around.simulated,
        delay_s=problem.delay.value,
        zero=None if wandering else zero_at_end(problem, choice.fit),
        counted=problem.counted,
        rough=problem.rough,
        cornered=problem.motion.corners is not None,
        zeros=problem.motion.zeros,
    )


def going_on(
    model: CorrectedModel, problem: Problem, explanation: Explanation, choice: Choice
) -> CorrectedModel:
    """The model with what foretells the rows after the recording."""
    after = refitted(reduced(problem, whole=True)[0], explanation, likeliest(explanation, choice))
    return replace(
        model,
        zero=zero_at_end(problem, after.fit),
        later=mechanism_of(problem, after),
        lasted_s=float(problem.motion.time_s[-1] - problem.motion.time_s[0]),
    )


def evidence_of(
    recording: Recording,
    measurement: str,
    problem: Problem,
    explanation: Explanation,
    model: CorrectedModel,
    hypotheses: tuple[Hypothesis, ...],
) -> Evidence:
    """All rows of the recording with their predictions, and the hypotheses that compete."""
    after, deviation = model.predict(problem.motion)
    outliers = set_aside(problem, after, explanation.prior)
    outliers &= ~turning(problem) | problem.mistaken
    return Evidence(
        recording=recording,
        measurement=measurement,
        drive=problem.drive,
        static=problem.static,
        motion=problem.motion,
        measured=problem.measured if problem.read is None else problem.read,
        train=problem.train,
        heldout=problem.heldout,
        used=np.isfinite(problem.measured) & np.isfinite(problem.simulated) & ~outliers,
        mistaken=problem.mistaken,
        before=problem.simulated if problem.replaced is None else problem.replaced,
        after=after,
        deviation=deviation,
        noise=model.noise,
        hypotheses=hypotheses,
    )
