import shutil
import subprocess
from pathlib import Path

import pandas as pd
import pytest

from pipeline.tracking.tables import latex, markdown, plain, write_table

TABLE = pd.DataFrame(
    {
        "axis": ["yaw", "pitch | side"],
        "improvement [%]": [60.96, float("nan")],
        "RMSE [deg]": [0.3941234, 1.7],
        "tip [um]": [20.6382, 89.0],
        "n_samples": [600, 599],
    }
)


def test_csv_keeps_every_digit(tmp_path: Path) -> None:
    paths = write_table(TABLE, tmp_path / "evaluation", "table")
    assert [p.name for p in paths] == ["table.csv", "table.md", "table.tex"]
    pd.testing.assert_frame_equal(pd.read_csv(paths[0]), TABLE)
    assert sorted(p.name for p in (tmp_path / "evaluation").iterdir()) == sorted(
        p.name for p in paths
    )


def test_markdown_rounds_by_unit_and_escapes() -> None:
    lines = markdown(TABLE).splitlines()
    assert len({len(line) for line in lines}) == 1
    cells = [[c.strip() for c in line.strip("|").split(" | ")] for line in lines]
    assert cells[1][1].endswith("-:")
    assert cells[2] == ["yaw", "61.0", "0.394", "20.6", "600"]
    assert cells[3] == [r"pitch \| side", "–", "1.700", "89.0", "599"]


def test_plain_columns_stand_under_each_other() -> None:
    lines = plain(TABLE).splitlines()
    end = lines[0].index("RMSE [deg]") + len("RMSE [deg]")
    assert lines[2][:end].endswith("0.394")
    assert lines[3][:end].endswith("1.700")


def test_latex_has_booktabs_and_escaped_signs() -> None:
    text = latex(TABLE)
    for part in (r"\toprule", r"\midrule", r"\bottomrule", r"{lrrrr}", r"[\%]", r"n\_samples",
                 r"[$\mu$m]", "61.0", "--"):  # fmt: skip
        assert part in text
    assert "nan" not in text


WIDE = pd.DataFrame(
    {
        "job": [0, 10],
        "recording": ["data/paper_twin/pitch", "/home/somebody/recordings/the_other_finger"],
        "measurement": ["pitch_angle_deg", "joint6_angle_deg"],
        "verdict": ["explained", "partly explained"],
        "left out": ["backlash", "coupling + camera_tilt or gravity or lens_distortion"],
        "how much (95 %)": [
            "width 4.55 (4.46 to 4.63) deg",
            "; ".join(["gain 0.1 (0 to 0.2)"] * 9),
        ],
        "held-out RMSE before": [1.742, 14.85],
        "after": [0.4593, 2.18],
        "unit": ["deg", "deg"],
    }
)


@pytest.mark.parametrize("table", [TABLE, WIDE], ids=["narrow", "wide"])
def test_latex_fits_a_page(table: pd.DataFrame, tmp_path: Path) -> None:
    if shutil.which("pdflatex") is None:
        pytest.skip("pdflatex is not installed")
    head = "\\documentclass{article}\\usepackage{booktabs}\\begin{document}\n\\noindent "
    (tmp_path / "t.tex").write_text(head + latex(table) + "\\end{document}\n", encoding="utf-8")
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "t.tex"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
    assert "Overfull" not in done.stdout


def test_a_wide_table_loses_nothing_in_latex() -> None:
    text = latex(WIDE).replace(r"\allowbreak{}", "")
    for cell in WIDE.astype(str).to_numpy().ravel():
        assert cell.replace("_", r"\_") in text


def test_an_empty_table_can_be_shown() -> None:
    empty = TABLE.head(0)
    assert markdown(empty).count("\n") == 2
    assert "axis" in plain(empty)
