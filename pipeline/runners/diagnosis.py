"""Diagnosis and prediction of a run: what a simulation left out, and what it says without it."""

import json
from pathlib import Path

import pandas as pd

from pipeline.discrepancy import model as stored
from pipeline.discrepancy.result import DiagnosisResult, Evidence, as_json
from pipeline.errors import UsageError, refusal
from pipeline.recording import Recording, load_recording, save_recording, write_atomically
from pipeline.runners.run_folder import Run, made
from pipeline.stages.diagnosis import diagnose
from pipeline.stages.prediction import predict
from pipeline.stages.simulation import simulate

MODEL_FILE = "model.json"


def run_diagnosis(run: Run) -> None:
    """Diagnose a recording, or all that vision left; diagnosis.json has an entry a measurement."""
    recordings = {
        name: simulate(run.config.simulation, recording)
        for name, recording in _recordings(run).items()
    }
    results = [diagnose(run.config.diagnosis, recording) for recording in recordings.values()]
    result = DiagnosisResult(
        tuple(d for r in results for d in r.diagnoses),
        tuple(e for r in results for e in r.evidence),
        tuple(m for r in results for m in r.models),
    )
    for name, recording in recordings.items():
        save_recording(recording, run.folder / "diagnosis" / name)
    for evidence in result.evidence:
        file = made(run.folder / "diagnosis") / f"{evidence.measurement}.csv"
        write_atomically(file, _table(evidence).to_csv(index=False))
    models = {"models": [stored.as_json(model) for model in result.models]}
    write_atomically(run.folder / MODEL_FILE, json.dumps(models))
    write_atomically(run.folder / "diagnosis.json", json.dumps(as_json(result.diagnoses), indent=1))
    for diagnosis in result.diagnoses:
        names = ", ".join(p.name for p in diagnosis.physics) or "nothing named"
        print(f"  {diagnosis.measurement}: {diagnosis.verdict} ({names}); held-out RMSE "
              f"{diagnosis.before.heldout_rmse:.3g} -> {diagnosis.after.heldout_rmse:.3g} "
              f"{diagnosis.unit}, noise {diagnosis.noise:.3g}")  # fmt: skip


def run_prediction(run: Run) -> None:
    """What the corrected simulation of an earlier run says for a recording's commands."""
    if run.config.recording is None or run.config.model is None:
        raise UsageError(
            refusal("configuration", "model=RUN_DIR and recording=DIR",
                    f"model={run.config.model} recording={run.config.recording}",
                    "Name the run that diagnosed, and the recording whose commands to answer.")
        )  # fmt: skip
    recording = load_recording(Path(run.config.recording))
    file = Path(run.config.model) / MODEL_FILE
    if not file.is_file():
        raise UsageError(
            refusal(str(file), "the model that a diagnosis left", "no such file",
                    "Point `model=` at the folder of a run with stages=[diagnosis].")
        )  # fmt: skip
    commands = [c.name for c in recording.with_role("command")]
    models = [
        stored.from_json(entry, [c for c in commands if c != entry["drive"]])
        for entry in json.loads(file.read_text())["models"]
    ]
    predictions = predict(models, recording)
    write_atomically(run.folder / "predictions.csv", predictions.to_csv(index=False))
    print(f"  {len(predictions)} rows in {run.folder / 'predictions.csv'}")


def _recordings(run: Run) -> dict[str, Recording]:
    if run.config.recording is not None:
        folder = Path(run.config.recording)
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
