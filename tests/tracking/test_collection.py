import json
from pathlib import Path

import pandas as pd
import pytest

from pipeline.errors import UsageError
from pipeline.tracking.collection import collect


def add_job(
    sweep: Path, name: str, overrides: dict[str, object], status: str = "done", rmse: float = 0.5
) -> None:
    folder = sweep / name
    folder.mkdir(parents=True)
    error = None if status == "done" else "LoopgapError: no such port"
    job = {"overrides": overrides, "status": status, "error": error}
    (folder / "job.json").write_text(json.dumps(job))
    if status != "done":
        return
    (folder / "evaluation").mkdir()
    rows = [
        ("pitch", "nominal", "model_rmse", 3 * rmse, "deg", 600),
        ("pitch", "compensated", "model_rmse", rmse, "deg", 600),
        ("pitch", "compensated", "targets_converged", 100, "targets", 100),
    ]
    columns = ["axis", "method", "metric", "value", "unit", "n"]
    pd.DataFrame(rows, columns=columns).to_csv(folder / "evaluation/metrics.csv", index=False)


def test_every_job_gives_its_rows_in_natural_order(tmp_path: Path) -> None:
    for number in (10, 2, 0):
        add_job(tmp_path, str(number), {"selection.k": number + 1}, rmse=0.1 * (number + 1))
    collection = collect(tmp_path)
    assert list(collection.results["job"]) == ["0"] * 3 + ["2"] * 3 + ["10"] * 3
    written = pd.read_csv(tmp_path / "results.csv")
    assert list(written.columns) == [
        "job", "selection.k", "axis", "method", "metric", "value", "unit", "n",
    ]  # fmt: skip
    assert written.query("metric == 'model_rmse' and method == 'compensated'")[
        "value"
    ].tolist() == pytest.approx([0.1, 0.3, 1.1])
    assert "# 3 of 3 jobs" in (tmp_path / "results.md").read_text()


def test_headline_errors_stand_in_one_row_a_job(tmp_path: Path) -> None:
    add_job(tmp_path, "0", {"split.index": 0}, rmse=0.4)
    add_job(tmp_path, "1", {"split.index": 1}, rmse=0.6)
    wide = collect(tmp_path).results_wide()
    assert wide.to_dict("list") == {
        "job": ["0", "1"],
        "split.index": [0, 1],
        "axis": ["pitch", "pitch"],
        "nominal model [deg]": pytest.approx([1.2, 1.8]),
        "compensated model [deg]": [0.4, 0.6],
    }


def test_failed_and_unfinished_jobs_are_listed(tmp_path: Path) -> None:
    add_job(tmp_path, "0", {"seed": 0})
    add_job(tmp_path, "1", {"seed": 1}, status="failed")
    add_job(tmp_path, "2", {"seed": 2})
    (tmp_path / "2/evaluation/metrics.csv").unlink()
    add_job(tmp_path, "3", {"seed": 3})
    (tmp_path / "3/job.json").write_text("{")
    incomplete = collect(tmp_path).incomplete.set_index("job")
    assert list(incomplete.index) == ["1", "2", "3"]
    assert incomplete.loc["1", "error"] == "LoopgapError: no such port"
    assert "metrics.csv" in incomplete.loc["2", "error"]
    assert incomplete.loc["3", "status"] == "unreadable"
    report = (tmp_path / "results.md").read_text()
    assert "# 1 of 4 jobs" in report
    assert "no such port" in report


def test_collecting_again_changes_nothing(tmp_path: Path) -> None:
    add_job(tmp_path, "0", {"selection.k": 4, "split": "paper"})
    add_job(tmp_path, "1", {"seed": 3}, status="failed")
    collect(tmp_path)
    first = {p.name: p.read_bytes() for p in tmp_path.glob("results.*")}
    collect(tmp_path)
    assert {p.name: p.read_bytes() for p in tmp_path.glob("results.*")} == first
    assert len(first) == 2


def test_a_sweep_of_failures_still_gives_its_table(tmp_path: Path) -> None:
    add_job(tmp_path, "0", {"seed": 0}, status="failed")
    collection = collect(tmp_path)
    assert collection.results.empty
    assert collection.results_wide().empty
    assert len(collection.incomplete) == 1


def test_a_folder_without_jobs_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"expected job folders with job\.json; found none"):
        collect(tmp_path)
