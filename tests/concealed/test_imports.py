"""The generator is another model than the catalogue: it knows nothing of it."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import pipeline.concealed

FOLDER = Path(pipeline.concealed.__file__).parent
FORBIDDEN = ("pipeline.physics", "pipeline.discrepancy", "pipeline.stages", "pipeline.twin")
FILES = sorted(FOLDER.glob("*.py"))


@pytest.mark.parametrize("file", FILES, ids=lambda f: f.name)
def test_no_file_imports_the_catalogue_or_the_diagnosis(file):
    names: list[str] = []
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "relative imports hide where they lead"
            names += [f"{node.module}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Call):
            assert getattr(node.func, "id", "") != "__import__"
            assert getattr(node.func, "attr", "") != "import_module"
    assert [n for n in names if n.startswith(FORBIDDEN)] == []


def test_nothing_of_them_is_loaded_with_the_generator():
    modules = ", ".join(f"pipeline.concealed.{f.stem}" for f in FILES if f.stem != "__init__")
    code = f"import sys, {modules}\nprint('\\n'.join(m for m in sys.modules))"
    root = FOLDER.parents[1]
    loaded = subprocess.run(
        [sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True
    ).stdout.split()
    assert "pipeline.concealed.draw" in loaded
    assert [m for m in loaded if m.startswith(FORBIDDEN)] == []
