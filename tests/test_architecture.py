"""The house's rules that a machine can check."""

import ast
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
FILES = sorted((ROOT / "pipeline").rglob("*.py"))
LAYERS = {
    "app": 6, "quick_compose": 5, "collecting": 5, "sweep": 5, "job": 5, "run": 4, "runners": 4,
    "laboratory": 3, "stages": 3,
    "discrepancy": 2, "control": 2, "models": 2, "hardware": 2, "twin": 2, "vision": 2,
    "tracking": 2, "concealed": 2, "recorder": 1, "split": 1, "commands": 1, "config_errors": 1,
    "config_check": 1, "physics": 1, "foreign": 1, "config_importing": 0, "recording": 0,
    "atomically": 0, "sample_table": 0, "leading": 0, "number_words": 0, "clock": 0, "config": 0,
    "errors": 0,
}  # fmt: skip


FLOORS = ["problem", "noise", "location", "fitting", "model", "search", "judgement"]


@cache
def nodes_of(file: Path) -> list[ast.AST]:
    return list(ast.walk(ast.parse(file.read_text())))


@cache
def imported(file: Path) -> frozenset[str]:
    names: set[str] = set()
    for node in nodes_of(file):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names.add(node.module)
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
    return frozenset(names)


def room_of(file: Path) -> str:
    return file.relative_to(ROOT / "pipeline").parts[0].removesuffix(".py")


def test_imports_go_one_way():
    upward = []
    for file in FILES:
        room = room_of(file)
        if room == "__init__":
            continue
        for name in imported(file):
            parts = name.split(".")
            other = parts[1] if parts[0] == "pipeline" and len(parts) > 1 else room
            if other in LAYERS and LAYERS[other] > LAYERS[room]:
                upward.append(f"{file.relative_to(ROOT)} imports {name}")
    assert upward == []


def test_the_floors_of_the_diagnosis_rest_on_those_below():
    house = ROOT / "pipeline" / "discrepancy"
    upward = []
    for file in house.rglob("*.py"):
        own = FLOORS.index(file.parent.name) if file.parent != house else len(FLOORS)
        for name in imported(file):
            parts = name.split(".")
            if parts[:2] == ["pipeline", "discrepancy"] and len(parts) > 2:
                other = FLOORS.index(parts[2]) if parts[2] in FLOORS else len(FLOORS)
                if other > own:
                    upward.append(f"{file.relative_to(ROOT)} imports {name}")
    assert upward == []


@pytest.mark.parametrize(
    ("library", "rooms"),
    [
        ("rerun", {"pipeline/tracking/review.py"}),
        (
            "matplotlib",
            {f"pipeline/tracking/{n}figures.py" for n in ("", "diagnosis_", "benchmark_")},
        ),
        ("rosbags", {"pipeline/foreign/bag.py"}),
        ("openpyxl", {"pipeline/foreign/excel.py"}),
        ("h5py", {"pipeline/foreign/matlab.py"}),
        ("serial", {"pipeline/hardware/epos2_line.py"}),
        (
            "hydra",
            {
                f"pipeline/{n}.py"
                for n in ("app", "config", "sweep", "quick_compose", "tracking/planned")
            },
        ),
    ],
)
def test_a_library_is_known_in_few_rooms(library, rooms):
    users = {
        str(file.relative_to(ROOT))
        for file in FILES
        if any(name.split(".")[0] == library for name in imported(file))
    }
    assert users
    assert users <= rooms


def test_a_diagnosis_does_not_wait_for_what_it_hardly_needs():
    needless = {"scipy.stats", "scipy.signal", "sklearn"}
    said = f"import sys, pipeline.runners.diagnosis; print({needless!r} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", said], cwd=ROOT, capture_output=True, text=True)
    assert done.stdout.strip() == "set()", done.stderr


@pytest.mark.parametrize("word", ["pickle", "eval", "exec"])
def test_nothing_runs_what_a_file_says(word):
    for file in FILES:
        for node in nodes_of(file):
            called = isinstance(node, ast.Call) and getattr(node.func, "id", "") == word
            assert not called, f"{file} calls {word}"
        assert word not in imported(file)


def test_configuration_names_no_code():
    for file in [*FILES, *(ROOT / "conf").rglob("*.yaml")]:
        words = file.read_text().replace(":", " ").split()
        assert "_target_" not in words, file
