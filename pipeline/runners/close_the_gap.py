"""The whole circle: record, diagnose, propose, until one answer is left; then compensate."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pandas as pd

from pipeline.atomically import write_atomically
from pipeline.commands import read_commands
from pipeline.control.inverse import Solution
from pipeline.control.mechanism_inverse import follow_mechanism
from pipeline.control.trial import trial_path
from pipeline.discrepancy.model.model import CorrectedModel
from pipeline.laboratory import Laboratory, open_laboratory
from pipeline.physics.mechanism import Mechanism
from pipeline.recording import Recording
from pipeline.runners.acquisition import record, see
from pipeline.runners.diagnosis import (
    Answered,
    answer,
    commands_file,
    summary,
    write_answer,
    write_pages,
)
from pipeline.runners.evaluation import landing, trial_commands
from pipeline.runners.run_folder import Run, made, say_now
from pipeline.stages.acquisition import protocol
from pipeline.stages.evaluation import evaluate
from pipeline.stages.simulation import simulate
from pipeline.tracking.tables import plain, write_table


def run_close_the_gap(run: Run) -> None:
    """Close the gap between the kinematic simulation of one axis and the robot."""
    config, axis = run.config.close_the_gap, run.config.close_the_gap.axis
    commands = protocol(run.config.acquisition, axis)
    whole: Recording | None = None
    with open_laboratory(run.config, run.config.acquisition.axes, run.config.seed) as laboratory:
        for number in range(1, config.rounds + 1):
            folder = run.folder / f"round-{number}"
            whole = _joined(whole, _recorded(run, laboratory, commands, folder))
            simulated = simulate(run.config.simulation, _without_encoders(whole))
            answered = answer(run.config.diagnosis, [simulated], say_now)
            write_answer(answered, folder)
            write_pages(answered, folder)
            print(f"  round {number}: {summary(answered.diagnoses[0])}")
            proposed = answered.proposals[0]
            if answered.diagnoses[0].verdict != "ambiguous" or proposed is None:
                break
            print(f"  {proposed.why}")
            if proposed.commands is None:
                break
            file = folder / commands_file(answered.diagnoses[0].measurement, 1)
            commands = read_commands(file, run.config.acquisition.axes)
        _compensate(run, laboratory, answered)


def _recorded(run: Run, laboratory: Laboratory, commands: pd.DataFrame, folder: Path) -> Recording:
    axis = run.config.close_the_gap.axis
    record(run, laboratory, commands, [axis], folder / "acquisition")
    return see(run, folder / "acquisition", folder / "vision")


def _without_encoders(recording: Recording) -> Recording:
    """The recording as a simulation is asked: encoders are no part of it."""
    keep = tuple(c for c in recording.channels if c.role != "encoder")
    return replace(recording, channels=keep)


def _joined(before: Recording | None, after: Recording) -> Recording:
    """One recording of two that followed each other; cycles count on."""
    if before is None:
        return after
    later = after.samples.assign(cycle=after.samples["cycle"] + before.samples["cycle"].max() + 1)
    samples = pd.concat([before.samples, later], ignore_index=True)
    return replace(before, samples=samples)


def _compensate(run: Run, laboratory: Laboratory, answered: Answered) -> None:
    """Drive along the trial path by the inverse of the simulation, as it came and corrected."""
    axis = run.config.close_the_gap.axis
    model = answered.models[0]
    nominal = Mechanism(model.mechanism.curve, course=model.mechanism.course)
    mechanisms = {"nominal": nominal, "compensated": model.mechanism}
    landings = {}
    for method, mechanism in mechanisms.items():
        solutions = _solutions(run, model, mechanism)
        name = f"{axis}_{method}"
        folder = made(run.folder / "trial")
        commands = trial_commands(run.config, axis, solutions)
        record(run, laboratory, commands, [axis], folder / name)
        seen = see(run, folder / name, folder / "vision" / name)
        landings[method] = landing(folder, name, axis, solutions, seen)
    evaluation = evaluate(run.config.evaluation, {}, {axis: landings})
    folder = made(run.folder / "evaluation")
    write_atomically(folder / "metrics.csv", evaluation.metrics.to_csv(index=False))
    write_table(evaluation.table, folder, "table")
    print("\nThe robot that follows the simulation as it came, and the corrected one:")
    print(plain(evaluation.table))


def _solutions(run: Run, model: CorrectedModel, mechanism: Mechanism) -> pd.DataFrame:
    config = run.config.compensation
    limit_deg = run.config.robot.limit_deg[run.config.close_the_gap.axis]
    amplitude_deg = run.config.acquisition.amplitude_deg[run.config.close_the_gap.axis]
    solutions: Sequence[Solution] = follow_mechanism(
        mechanism,
        trial_path(config.targets, config.target_amplitude_deg).tolist(),
        (-limit_deg, limit_deg),
        config.tolerance_deg,
        run.config.acquisition.pause_s,
        (amplitude_deg, -amplitude_deg, 0.0),
    )
    return pd.DataFrame([vars(solution) for solution in solutions])
