"""The concealed benchmark of a run: hide, seal, diagnose without the truth, open, score."""

import json
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

import pandas as pd

from pipeline.atomically import write_atomically
from pipeline.concealed.benchmark import generate
from pipeline.concealed.cases import follow_up
from pipeline.concealed.draw import Case, draw_cases
from pipeline.concealed.names import KINDS
from pipeline.concealed.score import Score, score
from pipeline.config import DiagnosisConfig
from pipeline.errors import UsageError, refusal
from pipeline.recording import load_recording, save_recording
from pipeline.runners.diagnosis import answer, stored_models, write_answer
from pipeline.runners.run_folder import Run, made, progress_bar
from pipeline.stages.prediction import predict
from pipeline.tracking.benchmark_figures import calibration_figure, confusion_figure
from pipeline.tracking.figures import save_figure
from pipeline.tracking.tables import plain, write_table

WORKERS = 2
Job = tuple[DiagnosisConfig, Path, Path]


def run_concealed(run: Run) -> None:
    """Generate the cases, diagnose each, record the proposed blocks, diagnose again, and score."""
    config = run.config.concealed
    drawn = draw_cases(config.seed, config.counts)
    if not drawn:
        raise UsageError(
            refusal("concealed.counts", f"how many cases of {', '.join(KINDS)}", "none at all",
                    "Choose `experiment=concealed`.")
        )  # fmt: skip
    cases, truth, results = (run.folder / n for n in ("cases", "truth", "results"))
    generate(cases, truth, drawn)
    print(f"  {len(drawn)} cases; their sealed truths: {cases / 'commitments.json'}")
    table = pd.read_csv(cases / "declared.csv")
    declared = dict(zip(table["case"], table["tolerance_shape_deg"], strict=True))
    settings = {case.name: _declaring(run.config.diagnosis, declared[case.name]) for case in drawn}
    first = [(settings[c.name], cases / c.name, results / c.name) for c in drawn]
    seconds = _all_answered("diagnosing", first)
    table = pd.DataFrame({"case": [c.name for c in drawn], "seconds": seconds})
    write_atomically(results / "seconds.csv", table.to_csv(index=False))
    second = [
        (settings[case.name], folder, results / case.name / "follow_up")
        for case in drawn
        if (folder := _recorded_block(case, cases, results)) is not None
    ]
    _all_answered("after the proposed blocks", second)
    write_score(score(cases, results, truth), made(run.folder / "score"))


def write_score(scored: Score, folder: Path) -> None:
    """Tables of the score as CSV, Markdown, LaTeX, two pictures; requirements on the terminal."""
    for name in ("requirements", "further", "calibration", "effects", "smallest"):
        write_table(getattr(scored, name), folder, name)
    write_table(scored.confusion.reset_index(names="hidden"), folder, "confusion")
    save_figure(confusion_figure(scored.confusion), folder, "confusion")
    save_figure(calibration_figure(scored.calibration, scored.smallest), folder, "calibration")
    for name in ("outcomes", "terms", "intervals"):
        table: pd.DataFrame = getattr(scored, name)
        write_atomically(folder / f"{name}.csv", table.to_csv(index=False))
    print(plain(scored.requirements))


def _declaring(config: DiagnosisConfig, shape_deg: float) -> DiagnosisConfig:
    """The configuration of a user who knows how far the simulated curve may be wrong."""
    return replace(config, tolerance=replace(config.tolerance, shape=float(shape_deg)))


def _all_answered(title: str, jobs: Sequence[Job]) -> list[float]:
    seconds = []
    with progress_bar(title, len(jobs)) as tick:
        for taken_s in _mapped(jobs):
            seconds.append(taken_s)
            tick(1)
    return seconds


def _mapped(jobs: Sequence[Job]) -> Iterator[float]:
    with ProcessPoolExecutor(WORKERS, get_context("spawn")) as pool:
        yield from pool.map(_answered, jobs, chunksize=4)


def _answered(job: Job) -> float:
    """Diagnose one recording, predict its later cycles; the seconds of a core for the diagnosis."""
    config, folder, results = job
    recording = load_recording(folder)
    began_s = time.process_time()
    answered = answer(config, [recording])
    taken_s = time.process_time() - began_s
    write_answer(answered, results)
    later = folder.with_name(f"{folder.name}.later")
    if later.is_dir():
        asked = load_recording(later)
        predictions = predict(stored_models(results / "model.json", asked), asked)
        write_atomically(results / "predictions.csv", predictions.to_csv(index=False))
    return taken_s


def _recorded_block(case: Case, cases: Path, results: Path) -> Path | None:
    """Record what an ambiguous diagnosis proposed; None where it proposed no commands."""
    entry = json.loads((results / case.name / "diagnosis.json").read_text())["measurements"][0]
    file = results / case.name / "next_commands.csv"
    if entry["verdict"] != "ambiguous" or not file.is_file():
        return None
    folder = cases / f"{case.name}.follow_up"
    save_recording(follow_up(case, pd.read_csv(file)), folder)
    return folder
