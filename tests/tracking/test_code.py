"""Which code decides on a result: a module, all that it imports, and nothing else."""

import ast
from pathlib import Path

import pytest

from pipeline.tracking import code

FILES = {
    "__init__.py": "",
    "a.py": "from pipeline.inner import b\nimport numpy\n",
    "inner/__init__.py": "",
    "inner/b.py": "def late():\n    from pipeline import c\n    import cv2\n",
    "inner/templates/page.jinja": "<p>",
    "c.py": "X = 1\n",
    "other.py": "import pandas\n",
}


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "pipeline"
    for name, text in FILES.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    monkeypatch.setattr(code, "PACKAGE", folder)
    forget()
    yield folder
    forget()


def forget() -> None:
    for function in (code.code_of, code.libraries_of, code._reached, code._imports):
        function.cache_clear()


@pytest.mark.parametrize("name", ["a.py", "inner/b.py", "inner/templates/page.jinja", "c.py"])
def test_a_change_anywhere_beneath_counts(package: Path, name: str) -> None:
    before = code.code_of("pipeline.a")
    with (package / name).open("a") as file:
        file.write("# more\n")
    forget()
    assert code.code_of("pipeline.a") != before


def test_a_change_elsewhere_does_not(package: Path) -> None:
    before = code.code_of("pipeline.a")
    (package / "other.py").write_text("import scipy\n")
    forget()
    assert code.code_of("pipeline.a") == before


def test_libraries_are_those_that_are_imported(package: Path) -> None:
    found = set(code.libraries_of("pipeline.a"))
    assert found == {"python", "architecture", "numpy", "scipy", "opencv-python-headless"}


def test_every_import_that_a_parser_sees_is_read() -> None:
    sources = sorted(code.PACKAGE.rglob("*.py"))
    assert len(sources) > 100
    for source in sources:
        name = ".".join(source.relative_to(code.PACKAGE.parent).with_suffix("").parts)
        module = name.removesuffix(".__init__")
        parsed: set[str] = set()
        for node in ast.walk(ast.parse(source.read_bytes())):
            if isinstance(node, ast.Import):
                parsed |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                parsed |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
        assert parsed <= code._imports(module), source
