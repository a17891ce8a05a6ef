"""Evaluation of a run: the models on the test cycles, and their commands on the robot."""

from pathlib import Path

import pandas as pd

from pipeline.atomically import write_atomically
from pipeline.commands import SUFFIX
from pipeline.config import Config
from pipeline.laboratory import open_laboratory
from pipeline.recording import Recording
from pipeline.runners.acquisition import record, see
from pipeline.runners.run_folder import Run, fresh, made
from pipeline.stages.evaluation import evaluate, land, predict_cycles
from pipeline.tracking.tables import plain, write_table

TRIAL_SEED = 1000


def run_evaluation(run: Run) -> None:
    """Score the models on the test cycles, then drive the robot along the compensated commands."""
    recordings, models = run.measured(), run.models()
    _, test_cycles = run.split(recordings)
    predictions = {
        axis: predict_cycles(models[axis], recording, test_cycles)
        for axis, recording in recordings.items()
    }
    if run.config.evaluation.trial:
        run.find("compensation", "compensation")
    commands = _commands(run)
    landings = _trials(run, commands) if run.config.evaluation.trial else {}
    evaluation = evaluate(run.config.evaluation, predictions, landings, commands)
    folder = made(run.folder / "evaluation")
    write_atomically(folder / "metrics.csv", evaluation.metrics.to_csv(index=False))
    write_table(evaluation.table, folder, "table")
    print(f"\nErrors of the models and of the robot that follows them:\n{plain(evaluation.table)}")
    if landings:
        write_table(evaluation.closed_loop, folder, "closed_loop")
        print(f"\nThe commands on the robot:\n{plain(evaluation.closed_loop)}")
    for axis, methods in landings.items():
        for method, landing in methods.items():
            write_atomically(folder / f"landing_{axis}_{method}.csv", landing.to_csv(index=False))


def _commands(run: Run) -> dict[str, dict[str, pd.DataFrame]]:
    """What compensation left, axis -> method -> its commands; nothing where it was not run."""
    folder = run.left("compensation", "compensation")
    files = {} if folder is None else {f.stem: f for f in sorted(folder.glob("*.csv"))}
    return {
        axis: {str(m): part for m, part in pd.read_csv(file).groupby("method", sort=False)}
        for axis, file in run.in_order(files).items()
    }


def _trials(
    run: Run, commands: dict[str, dict[str, pd.DataFrame]]
) -> dict[str, dict[str, pd.DataFrame]]:
    """Each axis and method on the robot: axis -> method -> where it landed (`land`)."""
    parent = fresh(run.folder / "evaluation", "trial")
    landings: dict[str, dict[str, pd.DataFrame]] = {}
    for number, (axis, of_methods) in enumerate(commands.items()):
        landings[axis] = {}
        for method, solutions in of_methods.items():
            sent = trial_commands(run.config, axis, solutions)
            name = f"{axis}_{method}"
            with open_laboratory(run.config, [axis], run.config.seed + TRIAL_SEED + number) as lab:
                record(run, lab, sent, [axis], parent / name)
            seen = see(run, parent / name, parent / "vision" / name)
            landings[axis][method] = landing(parent, name, axis, solutions, seen)
    return landings


def trial_commands(config: Config, axis: str, solutions: pd.DataFrame) -> pd.DataFrame:
    """The commands that have been found, after one run around the full loop (cycle 0) and home."""
    amplitude_deg = config.acquisition.amplitude_deg[axis]
    lead_in = [amplitude_deg, -amplitude_deg, 0.0]
    sent = solutions["command_deg"].dropna().tolist()
    table = pd.DataFrame({f"{a}{SUFFIX}": 0.0 for a in config.acquisition.axes},
                         index=range(len(lead_in) + len(sent)))  # fmt: skip
    table[f"{axis}{SUFFIX}"] = lead_in + sent
    table["cycle"] = [0] * len(lead_in) + [1] * len(sent)
    table["step"] = [*range(len(lead_in)), *range(len(sent))]
    return table


def landing(
    parent: Path, name: str, axis: str, solutions: pd.DataFrame, seen: Recording
) -> pd.DataFrame:
    """The landings of cycle 1, with the true pose where a twin knows it."""
    scored = (seen.samples["cycle"] == 1).to_numpy()
    truth_file = parent / "truth" / f"{name}.csv"
    truth = pd.read_csv(truth_file)[scored] if truth_file.is_file() else None
    return land(solutions.reset_index(drop=True), seen.cycles([1]), truth, axis)
