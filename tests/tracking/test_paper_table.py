import shutil
import subprocess
from pathlib import Path

import pandas as pd
import pytest
from made_sweep import add_job, plan

from pipeline.collecting import run
from pipeline.errors import LoopgapError, UsageError
from pipeline.tracking.collection import gather
from pipeline.tracking.paper_table import table_files
from pipeline.tracking.table_forms import difference

DEFINITION = """
caption: Errors & more.
rows: [axis]
columns: [method]
over: [seed]
metrics:
  - {metric: model_rmse, label: RMSE, unit: deg, digits: 2, best: min}
compare: {column: method, baseline: nominal, test: t}
"""
ERRORS = (0.4, 0.5, 0.6)


@pytest.fixture
def definition(tmp_path: Path) -> Path:
    file = tmp_path / "errors.yaml"
    file.write_text(DEFINITION)
    return file


@pytest.fixture
def sweep(tmp_path: Path) -> Path:
    for seed, rmse in enumerate(ERRORS):
        add_job(tmp_path / "sweep", str(seed), {"seed": seed}, rmse=rmse)
    return tmp_path / "sweep"


def made(sweep: Path, definition: Path, **more: bool) -> dict[str, str]:
    return table_files(definition, gather(sweep), **more)


def test_every_cell_has_mean_deviation_and_n(sweep: Path, definition: Path) -> None:
    files = made(sweep, definition)
    assert r"| pitch | 1.50 ± 0.30 (n = 3) | **0.50** ± 0.10 (n = 3) |" in files["table.md"]
    assert (
        r"pitch & 1.50 $\pm$ 0.30 (n = 3) & \textbf{0.50} $\pm$ 0.10 (n = 3) \\"
        in (files["table.tex"])
    )
    for rule in (r"\toprule", r"\midrule", r"\bottomrule"):
        assert rule in files["table.tex"]
    assert r"\newcommand{\PitchCompensatedModelRmse}{0.50}" in files["numbers.tex"]
    assert r"\newcommand{\PitchNominalModelRmseN}{3}" in files["numbers.tex"]


def test_csv_keeps_full_precision_below_the_head(sweep: Path, definition: Path, tmp_path) -> None:
    (tmp_path / "t.csv").write_text(made(sweep, definition)["table.csv"])
    table = pd.read_csv(tmp_path / "t.csv", comment="#").set_index("method")
    assert table.loc["compensated", ["mean", "deviation", "n"]].tolist() == pytest.approx(
        [0.5, 0.1, 3]
    )
    assert table["best"].to_dict() == {"nominal": False, "compensated": True}


def test_pairs_are_tested(sweep: Path, definition: Path) -> None:
    files = made(sweep, definition)
    assert "paired t-test, two-sided; p by Holm for 1." in files["table.md"]
    (row,) = files["comparisons.csv"].splitlines()[-1:]
    assert row.startswith("pitch,RMSE [deg],compensated - nominal,-1.00,0.20,3,0.013,0.013")


@pytest.mark.parametrize(
    ("value", "said"), [(-0.04, "-4.0e-02"), (0.0, "0.0"), (-0.0, "0.0"), (0.06, "0.1")]
)
def test_a_difference_is_called_zero_only_where_it_is(value, said) -> None:
    assert difference(value, 1, tex=False) == said


def test_the_head_of_each_file_says_what_it_stands_on(sweep: Path, definition: Path) -> None:
    for text in made(sweep, definition).values():
        head = text[:800]
        assert "commit: abc" in head
        assert "configuration: " in head
        assert head.count("data: ") == 3
        assert "(3 of 3 jobs)" in head


def test_missing_jobs_are_told_with_their_reason(sweep: Path, definition: Path) -> None:
    plan(sweep, "twin=paper", seed="range(0,6)")
    for seed in range(3):
        shutil.rmtree(sweep / str(seed))
        add_job(sweep, str(seed), {"seed": seed, "twin": "paper"}, rmse=ERRORS[seed])
    add_job(sweep, "3", {"seed": 3, "twin": "paper"}, status="failed")
    files = made(sweep, definition)
    assert "(n = 3 of 6)" in files["table.md"]
    assert "Missing: failed: LoopgapError: no such port; never started (2)." in files["table.md"]


def test_a_cell_without_any_number_says_why(sweep: Path, definition: Path) -> None:
    add_job(sweep, "3", {"seed": 3}, status="failed")
    definition.write_text(DEFINITION.replace("rows: [axis]", "rows: [axis, seed]"))
    assert "– (failed: LoopgapError: no such port)" in made(sweep, definition)["table.md"]


def test_results_of_two_commits_stand_together_only_if_asked(sweep, definition, tmp_path) -> None:
    add_job(sweep, "3", {"seed": 3}, commit="def")
    with pytest.raises(LoopgapError, match="results of one commit; found abc; def"):
        made(sweep, definition)
    mixed = made(sweep, definition, mixed_commits=True)["table.tex"]
    assert "% commit: abc\n% commit: def\n" in mixed


def test_several_numbers_for_one_replicate_are_refused(sweep: Path, definition: Path) -> None:
    add_job(sweep, "3", {"seed": 0})
    with pytest.raises(LoopgapError, match="one number for each seed; found several"):
        made(sweep, definition)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("over: [seed]", "over: [sead]", "found 'sead'"),
        ("unit: deg", "unit: mm", "expected 'mm'; found deg"),
        ("digits: 2", "digit: 2", "digit"),
        ("test: t", "test: anova", "one of corrected_t, t, wilcoxon"),
        ("baseline: nominal", "baseline: none", "one of nominal, compensated"),
        ("best: min", "best: least", "one of min, max, none"),
    ],
)
def test_a_wrong_definition_is_refused(sweep, definition, old, new, words) -> None:
    definition.write_text(DEFINITION.replace(old, new))
    with pytest.raises(UsageError, match=words):
        made(sweep, definition)


def test_check_fails_where_a_table_is_older_than_its_results(sweep, definition, capsys) -> None:
    arguments = [str(sweep), "--table", str(definition)]
    assert run([*arguments, "--check"]) == 1  # not made yet
    assert run(arguments) == 0
    assert run([*arguments, "--check"]) == 0
    metrics = sweep / "0" / "evaluation" / "metrics.csv"
    metrics.write_text(metrics.read_text().replace("0.4,", "0.41,"))
    assert run([*arguments, "--check"]) == 1
    assert "errors/table.tex is not what the jobs' results make" in capsys.readouterr().err
    assert run(arguments) == 0
    (sweep / "tables" / "errors" / "numbers.tex").write_text("1.0")
    assert run([*arguments, "--check"]) == 1


def test_an_incomplete_sweep_is_told_by_the_exit_status(sweep: Path, capsys) -> None:
    assert run([str(sweep)]) == 0
    add_job(sweep, "3", {"seed": 3}, status="failed")
    assert run([str(sweep)]) == 1
    said = capsys.readouterr().err
    assert "1 of 4 jobs are missing" in said
    assert f"loopgap seed=3 hydra.run.dir={sweep / '3'}" in said
    assert run([str(sweep), "--table", "no_such"]) == 2
    assert run([str(sweep / "empty")]) == 2


def test_latex_takes_the_table(sweep: Path, definition: Path, tmp_path: Path) -> None:
    if shutil.which("pdflatex") is None:
        pytest.skip("no pdflatex")
    for name, text in made(sweep, definition).items():
        (tmp_path / name).write_text(text)
    (tmp_path / "paper.tex").write_text(
        r"\documentclass{article}\usepackage{booktabs}\input{numbers}\begin{document}"
        r"\input{table} \input{comparisons} \PitchCompensatedModelRmse\end{document}"
    )
    done = subprocess.run(["pdflatex", "-halt-on-error", "paper.tex"], cwd=tmp_path)
    assert done.returncode == 0
