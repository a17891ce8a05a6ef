"""Diagnosis and prediction of a run: what a simulation left out, and what it says without it."""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import count
from pathlib import Path

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from pipeline.atomically import write_atomically
from pipeline.config import Config, DiagnosisConfig
from pipeline.discrepancy.account import with_account
from pipeline.discrepancy.model import model as stored
from pipeline.discrepancy.model.model import CorrectedModel, ModelError
from pipeline.discrepancy.model.result import Diagnosis, Evidence, as_json
from pipeline.discrepancy.next_experiment import Proposal
from pipeline.errors import UsageError, refusal
from pipeline.recording import (
    Channel,
    Recording,
    file_stem,
    load_recording,
    save_recording,
)
from pipeline.runners.run_folder import Run, made, say_now
from pipeline.runners.simulation import asked_for, with_simulation
from pipeline.stages.diagnosis import diagnose
from pipeline.stages.prediction import predict
from pipeline.tracking.diagnoses import DIAGNOSIS_FILE, left_out, overview
from pipeline.tracking.report import write_report
from pipeline.tracking.tables import plain, write_table

MODEL_FILE = "model.json"


@dataclass(frozen=True)
class Answered:
    """What a diagnosis left: entries, evidence and models by measurement, and proposed commands."""

    diagnoses: tuple[Diagnosis, ...]
    evidence: tuple[Evidence, ...]
    models: tuple[CorrectedModel, ...]
    proposals: tuple[Proposal | None, ...]


def run_diagnosis(run: Run) -> None:
    """Diagnose a recording, or all that vision left; diagnosis.json has an entry a measurement."""
    recordings = {
        name: with_simulation(run.config, recording) for name, recording in _recordings(run).items()
    }
    for name, recording in recordings.items():
        save_recording(recording, run.folder / "diagnosis" / name)
    answered = answer(run.config.diagnosis, list(recordings.values()), say_now)
    write_answer(answered, run.folder)
    say_now("drawing the figures and the report")
    write_pages(answered, run.folder)
    for evidence in answered.evidence:
        file = made(run.folder / "diagnosis") / f"{file_stem(evidence.measurement)}.csv"
        write_atomically(file, _table(evidence).to_csv(index=False))
    table = overview(as_json(answered.diagnoses)["measurements"])
    write_table(table, run.folder / "diagnosis", "table")
    print(f"\nWhat the simulation left out:\n{plain(table)}")
    print(f"  report, opens in any browser: {run.folder / 'report.html'}")


def answer(
    config: DiagnosisConfig,
    recordings: Sequence[Recording],
    say: Callable[[str], object] = lambda _: None,
) -> Answered:
    """Diagnose recordings that bring their simulations; say where and what next.

    The matrices are small: more than one BLAS thread only makes them wait for each other.
    `say` is told what is begun.
    """
    with threadpool_limits(1):
        return _answer(config, recordings, say)


def _answer(
    config: DiagnosisConfig, recordings: Sequence[Recording], say: Callable[[str], object]
) -> Answered:
    number, measurements = count(1), sum(len(r.with_role("measurement")) for r in recordings)

    def begun(measurement: str) -> None:
        say(f"{measurement} ({next(number)} of {measurements}): searching what was left out")

    results = [diagnose(config, recording, begun) for recording in recordings]
    diagnoses = [d for r in results for d in r.diagnoses]
    evidence = [e for r in results for e in r.evidence]
    accounts = []
    for diagnosis, proof in zip(diagnoses, evidence, strict=True):
        name = diagnosis.measurement
        say(f"{name}: where it was left out, and what to record next")
        accounts.append(with_account(diagnosis, proof, commands_file(name, len(diagnoses))))
    return Answered(
        tuple(d for d, _, _ in accounts),
        tuple(e for _, e, _ in accounts),
        tuple(m for r in results for m in r.models),
        tuple(p for _, _, p in accounts),
    )


def commands_file(measurement: str, measurements: int) -> str:
    """Where the commands proposed for a measurement stand, in a run of so many measurements."""
    whose = "" if measurements == 1 else f"_{file_stem(measurement)}"
    return f"next_commands{whose}.csv"


def write_answer(answered: Answered, folder: Path) -> None:
    """Write diagnosis.json, the models that predict, and the proposed commands."""
    models = {"models": [stored.as_json(model) for model in answered.models]}
    write_atomically(made(folder) / MODEL_FILE, json.dumps(models))
    for diagnosis, proposal in zip(answered.diagnoses, answered.proposals, strict=True):
        if proposal is not None and proposal.commands is not None:
            file = commands_file(diagnosis.measurement, len(answered.diagnoses))
            write_atomically(folder / file, proposal.commands.to_csv(index=False))
    write_atomically(folder / DIAGNOSIS_FILE, json.dumps(as_json(answered.diagnoses), indent=1))


def write_pages(answered: Answered, folder: Path) -> None:
    """Write report.html, its figures and the rerun recording of the diagnosis."""
    commands = [None if p is None else p.commands for p in answered.proposals]
    write_report(folder, answered.diagnoses, answered.evidence, commands)


def summary(diagnosis: Diagnosis) -> str:
    """A diagnosis in a line."""
    (entry,) = as_json((diagnosis,))["measurements"]
    names = left_out(entry)
    return (
        f"{diagnosis.measurement}: {diagnosis.verdict}{f', {names}' if names else ''}; held-out "
        f"RMSE {diagnosis.before.heldout_rmse:.3g} -> {diagnosis.after.heldout_rmse:.3g} "
        f"{diagnosis.unit} (noise {diagnosis.noise:.3g})"
    )


def run_prediction(run: Run) -> None:
    """What the corrected simulation of an earlier run says for a recording's commands."""
    folder = run.given_recording()
    own = run.folder / MODEL_FILE
    model = run.config.model or (str(run.folder) if own.is_file() else None)
    if folder is None or model is None:
        raise UsageError(
            refusal("configuration", "model=RUN_DIR and recording=DIR",
                    f"model={run.config.model} recording={run.config.recording}",
                    "Name the run that diagnosed, and the recording whose commands to answer.")
        )  # fmt: skip
    recording = load_recording(folder)
    file = Path(model) / MODEL_FILE
    if not file.is_file():
        raise UsageError(
            refusal(str(file), "the model that a diagnosis left", "no such file",
                    "Point `model=` at the folder of a run with stages=[diagnosis].")
        )  # fmt: skip
    models = stored_models(file, recording)
    recording = with_simulations(run.config, recording, models)
    predictions = predict(models, recording, run.config.diagnosis.cutoff_hz)
    write_atomically(run.folder / "predictions.csv", predictions.to_csv(index=False))
    print(f"  {len(predictions)} rows in {run.folder / 'predictions.csv'}")


def with_simulations(
    config: Config, recording: Recording, models: Sequence[CorrectedModel]
) -> Recording:
    """The recording with the simulations that models correct, as the configuration says.

    Of a motion that is only one that was asked for: the kinematics that stand there unasked are no
    trace that a model may have been fitted to. Raises UsageError where a force's model needs a
    simulation and nothing brings one.
    """
    asked = asked_for(config.simulation)
    moving = [m for m in models if (m.simulated if m.force else asked and not m.static)]
    lacking = [m for m in moving if recording.simulation_of(m.measurement) is None]
    if not lacking:
        return recording
    there = {c.name for c in recording.channels}
    nothing = np.full(len(recording.samples), np.nan)
    for model in models if config.simulation.kind == "python" else lacking:
        if model.measurement not in there:
            channel = Channel(model.measurement, "measurement", model.unit)
            recording = recording.with_channel(channel, nothing)
    recording = with_simulation(config, recording)
    for name in (m.measurement for m in lacking if m.force):
        found = recording.simulation_of(name)
        if found is None or not np.any(recording.values(found.name)):
            raise UsageError(
                refusal(f"simulation of {name!r}", "the one that the diagnosis had", "none",
                        "Say the same simulation=, or add its channel to the recording.")
            )  # fmt: skip
    return recording


def stored_models(file: Path, recording: Recording) -> list[CorrectedModel]:
    """The models of a run's model.json, for the commands of a recording.

    Raises ModelError where the file is none, or a command is missing that couples in.
    """
    try:
        entries = json.loads(file.read_text(encoding="utf-8"))["models"]
    except (ValueError, KeyError, TypeError) as error:
        raise ModelError(
            refusal(str(file), "the models that a diagnosis left", f"{error}", "Diagnose anew.")
        ) from error
    commands = [c.name for c in recording.with_role("command")]
    for entry in entries:
        told = [entry, *entry.get("rivals", [])]
        coupled = [t["form"] for e in told for t in e.get("terms", []) if t["name"] == "coupling"]
        for name in (form.partition("/")[0] for form in coupled):
            if name not in commands:
                raise ModelError(
                    refusal("recording", f"the command {name!r} that the model was fitted with",
                            f"commands {', '.join(commands) or 'none'}", "Name the channel so.")
                )  # fmt: skip
    return [
        stored.from_json(entry, [c for c in commands if c != entry["drive"] or not entry["static"]])
        for entry in entries
    ]


def _recordings(run: Run) -> dict[str, Recording]:
    folder = run.given_recording()
    if folder is not None:
        return {folder.name: load_recording(folder)}
    return run.measured()


def _table(evidence: Evidence) -> pd.DataFrame:
    """Row by row: the drive, the measurement, the simulation before and after."""
    context = evidence.recording.samples[["time_s", "cycle", "step"]].reset_index(drop=True)
    return context.assign(
        drive=evidence.motion.drive,
        measured=evidence.measured,
        before=evidence.before,
        after=evidence.after,
        deviation=evidence.deviation,
        heldout=evidence.heldout.astype(int),
    )
