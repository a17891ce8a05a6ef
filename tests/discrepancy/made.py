"""Recordings made of the project's own terms, with known truth."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pandas as pd

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.fitting.effects import effects_of
from pipeline.discrepancy.fitting.fit import evaluate
from pipeline.discrepancy.fitting.ground import Ground
from pipeline.discrepancy.model.result import DiagnosisResult, Estimate
from pipeline.discrepancy.noise.family import noise_family
from pipeline.discrepancy.noise.learning import NoisePrior
from pipeline.discrepancy.problem.posing import pose_problem
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.explain import Explanation, explain
from pipeline.discrepancy.search.weighing import Choice, Search
from pipeline.physics.catalogue import term
from pipeline.physics.kinematics import CubicCurve
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.term import Surroundings, values_of
from pipeline.recording import Channel, Recording
from pipeline.stages.diagnosis import diagnose

ANGLE = "pitch_angle_deg"
SIMULATED = "pitch_angle_sim_deg"
NOISE = 0.2
AMPLITUDE = 55.0
STEPS = 120
CHANNELS = (
    Channel("pitch_command_deg", "command", "deg"),
    Channel("yaw_command_deg", "command", "deg"),
    Channel(ANGLE, "measurement", "deg"),
    Channel(SIMULATED, "simulation", "deg", of=ANGLE),
)


def motion_of(cycles: int = 6, two_axes: bool = False) -> Motion:
    phase = np.arange(cycles * STEPS) % STEPS / STEPS * 4.0
    shape = np.where(phase < 1, phase, np.where(phase < 3, 2 - phase, phase - 4))
    n = len(phase)
    yaw = 30.0 * np.sin(np.arange(n) / 17.0) if two_axes else np.zeros(n)
    return Motion(
        AMPLITUDE * shape,
        3.0 + 3.36 * np.arange(n),
        np.arange(n) // STEPS,
        {"yaw_command_deg": yaw},
    )


def recorded(
    hidden: dict[str, dict[str, float]],
    *,
    seed: int = 0,
    noise: float = NOISE,
    gain: float = 1.02,
    offset: float = 0.4,
    cycles: int = 6,
    two_axes: bool = False,
) -> Recording:
    """A mechanism with hidden terms ("name/form": parameters), measured with white noise."""
    motion = motion_of(cycles, two_axes)
    around = Surroundings(
        drive_span=2 * AMPLITUDE,
        drive_low=-AMPLITUDE,
        start_s=float(motion.time_s[0]),
        end_s=float(motion.time_s[-1]),
        other_span={"yaw_command_deg": 60.0},
    )
    pieces = []
    for key, parameters in hidden.items():
        name, _, form = key.partition("/")
        physics = term(name, form, ["yaw_command_deg"])
        pieces.append(Piece(physics, values_of(physics, around, parameters)))
    curve = CubicCurve(0.7, 1e-5)
    clean = Mechanism(curve, pieces, gain, offset).respond(motion)[0]
    rng = np.random.default_rng(seed)
    n = len(motion)
    samples = pd.DataFrame(
        {
            "time_s": motion.time_s,
            "cycle": motion.cycle,
            "step": np.arange(n) % STEPS,
            "pitch_command_deg": motion.drive,
            "yaw_command_deg": motion.others["yaw_command_deg"],
            ANGLE: clean + noise * rng.standard_normal(n),
            SIMULATED: curve(motion.drive),
        }
    )
    return Recording(samples, CHANNELS, "simulated")


def strokes(turns: np.ndarray, rows: int) -> np.ndarray:
    """A drive straight from 0 to the first turn and on from turn to turn, `rows` samples each."""
    ends = pairwise(np.concatenate([[0.0], turns]))
    return np.concatenate([np.linspace(a, b, rows, False) for a, b in ends])


def followed(
    time_s: np.ndarray,
    drive: np.ndarray,
    seen: np.ndarray,
    pace_hz: float,
    simulated: np.ndarray | None = None,
) -> Recording:
    """A motion and what was seen of it, (n,) each, simulated to go where it is told or as said."""
    columns = [time_s, (pace_hz * time_s).astype(int), np.arange(len(drive)), drive, 0.0 * drive]
    named = ["time_s", "cycle", "step", *(c.name for c in CHANNELS)]
    told = drive if simulated is None else simulated
    samples = pd.DataFrame(dict(zip(named, [*columns, seen, told], strict=True)))
    return Recording(samples, CHANNELS, "simulated")


def explained(recording: Recording) -> Explanation:
    """What explains the angle of such a recording."""
    return explain(posed(recording))


def posed(recording: Recording) -> Problem:
    """The problem that such a recording's angle poses."""
    return pose_problem(DiagnosisConfig(), recording, ANGLE, recording.values(SIMULATED))


def chosen(ground: Ground, score: float, **pieces: list[float]) -> Choice:
    """A choice of terms by their names with these values, as they stand."""
    fit = evaluate(ground, [Piece(term(n), np.array(values)) for n, values in pieces.items()])
    return Choice(fit, (0, 0, 0), score)


def explanation_of(choices: list[Choice], *, repeats: int = 0, strain: float = 0.0) -> Explanation:
    """These choices of one ground as an explanation, which could not search for others.

    repeats: how many cycles its noise was learnt from. strain: what these have against any noise.
    """
    ground = choices[0].fit.ground
    prior = NoisePrior(ground.noise, repeats, 0.1, ())
    family = noise_family(prior, ground.problem, ground.used)
    family = replace(family, strain=np.full_like(family.strain, strain))
    search = Search((), effects_of(ground.problem, ()), family)
    return Explanation(ground.problem, prior, search, choices, ~ground.used, ground.used)


def diagnosed(recording: Recording) -> DiagnosisResult:
    """The diagnosis of a recording, settings as they come."""
    return diagnose(DiagnosisConfig(), recording)


def names(result: DiagnosisResult) -> set[str]:
    """What was named of the only measurement, or of the first."""
    return {p.name for p in result.diagnoses[0].physics}


def value_of(result: DiagnosisResult, name: str, parameter: str) -> Estimate:
    """What was found of a parameter of a name."""
    physics = next(p for p in result.diagnoses[0].physics if p.name == name)
    return next(e for e in physics.parameters if e.name == parameter)


def changed(recording: Recording, **columns: np.ndarray) -> Recording:
    """The recording with other values in some columns."""
    return replace(recording, samples=recording.samples.assign(**columns))


def diagnosed_beside_its_commands(motion: Motion, seen: np.ndarray) -> DiagnosisResult:
    """The diagnosis of what a robot shows (n,) that its simulation says goes where it is told."""
    recording = followed(motion.time_s, motion.drive, seen, 0.002)
    recording.samples[SIMULATED] = motion.drive
    return diagnosed(recording)
