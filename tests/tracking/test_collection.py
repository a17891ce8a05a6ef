import json
import shlex
import shutil
from pathlib import Path

import pandas as pd
import pytest
from hydra.core.override_parser.overrides_parser import OverridesParser
from made_sweep import add_job, plan

from pipeline.collecting import run
from pipeline.errors import UsageError
from pipeline.tracking.collection import collect
from pipeline.tracking.planned import override


def test_every_job_gives_its_rows_in_natural_order(tmp_path: Path) -> None:
    for number in (10, 2, 0):
        add_job(tmp_path, str(number), {"selection.k": number + 1}, rmse=0.1 * (number + 1))
    collection = collect(tmp_path)
    assert list(collection.results["job"]) == ["0"] * 4 + ["2"] * 4 + ["10"] * 4
    written = pd.read_parquet(tmp_path / "results.parquet")
    assert list(written.columns) == [
        "job", "selection.k", "commit", "config_hash", "data_hash",
        "axis", "method", "cycle", "metric", "value", "unit", "n",
    ]  # fmt: skip
    pd.testing.assert_frame_equal(written, collection.results)
    chosen = written.query("metric == 'model_rmse' and method == 'compensated'")
    pooled = chosen[chosen["cycle"].isna()]
    assert pooled["value"].tolist() == pytest.approx([0.1, 0.3, 1.1])
    assert pooled["selection.k"].tolist() == [1, 3, 11]
    assert chosen["cycle"].dropna().tolist() == [6, 6, 6]
    assert "# 3 of 3 jobs" in (tmp_path / "results.md").read_text()


def test_the_hash_of_a_configuration_knows_what_has_a_say(tmp_path: Path) -> None:
    for sweep, name, seed in (("here", "0", 0), ("there", "0", 0), ("there", "1", 1)):
        add_job(tmp_path / sweep, name, {"seed": seed})
    here, there = (collect(tmp_path / s).results for s in ("here", "there"))
    assert set(here["config_hash"]) == set(there.query("job == '0'")["config_hash"])
    assert there["config_hash"].nunique() == there["data_hash"].nunique() == 2


def test_failed_and_unfinished_jobs_are_listed(tmp_path: Path) -> None:
    add_job(tmp_path, "0", {"seed": 0})
    add_job(tmp_path, "1", {"seed": 1}, status="failed")
    add_job(tmp_path, "2", {"seed": 2})
    (tmp_path / "2/evaluation/metrics.csv").unlink()
    add_job(tmp_path, "3", {"seed": 3})
    (tmp_path / "3/job.json").write_text("{")
    add_job(tmp_path, "4", {"seed": 4}, status="running")
    incomplete = collect(tmp_path).incomplete.set_index("job")
    assert incomplete["status"].to_dict() == {
        "1": "failed", "2": "no results", "3": "unreadable", "4": "unfinished",
    }  # fmt: skip
    assert incomplete.loc["1", "error"] == "LoopgapError: no such port"
    assert "metrics.csv" in incomplete.loc["2", "error"]
    report = (tmp_path / "results.md").read_text()
    assert "# 1 of 5 jobs" in report
    assert "no such port" in report


@pytest.mark.parametrize(
    "name", ["plain-1", "with blank", "außen (1)", "it's", "a,b", r"back\slash", "k=1", "1", "[x]"]
)
def test_a_folder_of_any_name_is_told_as_hydra_reads_it(name: str) -> None:
    (read,) = OverridesParser.create().parse_overrides([override("hydra.run.dir", name)])
    value = read.value()
    assert str(getattr(value, "text", value)) == name


def test_a_job_whose_stages_measure_nothing_is_done(tmp_path: Path) -> None:
    folder = add_job(tmp_path, "0", {"recording": "mine"})
    (folder / "evaluation/metrics.csv").unlink()
    left = {"stage": "prediction", "inputs": {}, "outputs": {"predictions.csv": "hash"}}
    (folder / "provenance.json").write_text(json.dumps({"code": {}, "stages": [left]}))
    assert collect(tmp_path).incomplete.empty
    report = (tmp_path / "results.md").read_text()
    assert "# 1 of 1 jobs" in report
    assert "look into their folders" in report
    assert not (tmp_path / "diagnoses.csv").exists()


def add_diagnosis(sweep: Path, name: str, recording: str, *physics: dict[str, object]) -> Path:
    folder = add_job(sweep, name, {"stages": "[diagnosis]", "recording": recording})
    (folder / "evaluation/metrics.csv").unlink()
    left = {"stage": "diagnosis", "inputs": {}, "outputs": {"diagnosis.json": "hash"}}
    (folder / "provenance.json").write_text(json.dumps({"code": {}, "stages": [left]}))
    entry = {
        "measurement": "elbow_deg", "unit": "deg", "noise": 0.125, "physics": physics,
        "verdict": "partly_explained" if physics else "no_mismatch",
        "before": {"train_rmse": 3.1, "heldout_rmse": 3.2},
        "after": {"train_rmse": 0.16, "heldout_rmse": 0.17},
    }  # fmt: skip
    (folder / "diagnosis.json").write_text(json.dumps({"measurements": [entry]}))
    return folder


PLAY = {
    "name": "backlash", "probability": 0.98, "alternatives": ["friction"],
    "parameters": [{"name": "width", "value": 8.125, "low": 7.9, "high": 8.3, "unit": "deg"}],
}  # fmt: skip
LENS = {"name": "lens_distortion", "probability": 0.9, "alternatives": [], "parameters": []}


def test_diagnoses_of_many_recordings_are_one_table(tmp_path: Path, capsys) -> None:
    add_diagnosis(tmp_path, "0", "lab/one", PLAY, LENS)
    add_diagnosis(tmp_path, "1", "lab/two")
    add_diagnosis(tmp_path, "2", "lab/three", PLAY, LENS)
    assert collect(tmp_path).incomplete.empty
    table = pd.read_csv(tmp_path / "diagnoses.csv")
    assert list(table.columns) == [
        "job", "recording", "measurement", "verdict", "left out", "how much (95 %)",
        "held-out RMSE before", "after", "noise", "unit",
    ]  # fmt: skip
    assert list(table["recording"]) == ["lab/one", "lab/two", "lab/three"]
    first, second = table.iloc[0], table.iloc[1]
    assert first["left out"] == "backlash or friction + lens_distortion"
    assert first["how much (95 %)"] == "backlash: width 8.12 (7.9 to 8.3) deg"
    assert (first["verdict"], first["after"], first["noise"]) == ("partly explained", 0.17, 0.125)
    assert (second["verdict"], second["left out"]) == ("no mismatch", "nothing")
    assert "| lab/three |" in (tmp_path / "diagnoses.md").read_text()
    tex = (tmp_path / "diagnoses.tex").read_text().replace(r"\allowbreak{}", "")
    assert r"backlash or friction + lens\_distortion" in tex
    each = pd.read_csv(tmp_path / "parameters.csv")
    assert list(each["recording"]) == ["lab/one"] * 2 + ["lab/three"] * 2
    assert each.iloc[0][["name", "alternatives", "parameter", "value", "low", "high"]].tolist() == [
        "backlash", "friction", "width", 8.125, 7.9, 8.3,
    ]  # fmt: skip
    assert each["parameter"].isna().tolist() == [False, True, False, True]
    report = (tmp_path / "results.md").read_text()
    assert "partly explained | backlash or friction + lens_distortion |    2 |" in report
    assert "look into their folders" not in report
    assert run([str(tmp_path), "--check"]) == 0
    add_diagnosis(tmp_path, "3", "lab/four", PLAY)
    assert run([str(tmp_path), "--check"]) == 1
    assert "diagnoses.csv is not what" in capsys.readouterr().err


def test_a_diagnosis_that_is_lost_or_broken_is_missing(tmp_path: Path) -> None:
    (add_diagnosis(tmp_path, "0", "lab/one", PLAY) / "diagnosis.json").unlink()
    (add_diagnosis(tmp_path, "1", "lab/two") / "diagnosis.json").write_text(
        '{"measurements": [{}]}'
    )
    lacking = collect(tmp_path).incomplete
    assert list(lacking["status"]) == ["no results", "no results"]
    assert lacking["error"][0] == "diagnosis.json is not there any more"
    assert "diagnosis.json: no diagnosis" in lacking["error"][1]


def test_jobs_of_ones_own_configuration_are_repeated_with_it(tmp_path: Path) -> None:
    plan(tmp_path, "importing=mine", seed="1,2")
    with (tmp_path / "multirun.yaml").open("a") as file:
        file.write("\n    config_sources: [{path: /home/me/my conf, provider: command-line},"
                   " {path: /conf, provider: main}]")  # fmt: skip
    command = collect(tmp_path).incomplete["command"][0]
    assert shlex.split(command)[:4] == ["loopgap", "--config-dir", "/home/me/my conf", "seed=1"]


def test_jobs_that_never_began_are_known_by_the_plan(tmp_path: Path) -> None:
    plan(tmp_path, "+experiment=x", "selection.k=4", split__index="range(0,2)", seed="1,2")
    given = {"experiment": "x", "selection.k": 4}
    add_job(tmp_path, "0", {"split.index": 0, "seed": 1, **given})
    add_job(tmp_path, "3", {"split.index": 1, "seed": 7, **given})  # of an older sweep
    incomplete = collect(tmp_path).incomplete.set_index("job")
    assert incomplete["status"].to_dict() == {
        "1": "never started", "2": "never started", "3": "not of this sweep",
    }  # fmt: skip
    assert shlex.split(incomplete.loc["2", "command"]) == [
        "loopgap", "split.index=1", "seed=1", "+experiment=x", "selection.k=4",
        f"hydra.run.dir={tmp_path / '2'}",
    ]  # fmt: skip
    lines = (tmp_path / "repeat.sh").read_text().splitlines()
    assert lines[2:] == [*incomplete["command"], f"loopgap-collect {tmp_path}"]


def test_a_copied_folder_collects_alike(tmp_path: Path) -> None:
    add_job(tmp_path / "one", "0", {"seed": 0})
    add_job(tmp_path / "one", "1", {"seed": 1})
    collect(tmp_path / "one")
    shutil.copytree(tmp_path / "one", tmp_path / "two")
    (tmp_path / "two" / "results.parquet").unlink()
    collect(tmp_path / "two")
    for name in ("results.parquet", "results.csv", "results.md"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()
    assert not (tmp_path / "two" / "repeat.sh").exists()


def test_collecting_again_changes_nothing(tmp_path: Path) -> None:
    add_job(tmp_path, "0", {"selection.k": 4, "split": "paper"})
    add_job(tmp_path, "1", {"seed": 3}, status="failed")
    collect(tmp_path)
    first = {p.name: p.read_bytes() for p in tmp_path.glob("re*.*")}
    collect(tmp_path)
    assert {p.name: p.read_bytes() for p in tmp_path.glob("re*.*")} == first
    assert len(first) == 4


def test_a_sweep_of_failures_still_gives_its_table(tmp_path: Path) -> None:
    add_job(tmp_path, "0", {"seed": 0}, status="failed")
    collection = collect(tmp_path)
    assert collection.results.empty
    assert len(collection.incomplete) == 1
    assert pd.read_parquet(tmp_path / "results.parquet").empty


def test_a_folder_without_jobs_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"expected job folders with job\.json; found none"):
        collect(tmp_path)
