"""The installed package works away from the checkout: its configuration travels with it."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module")
def unpacked_wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(build, cwd=ROOT, check=True, capture_output=True)
    with zipfile.ZipFile(next(folder.glob("loopgap-*.whl"))) as wheel:
        wheel.extractall(folder / "site")
    return folder / "site"


def test_all_configuration_travels_with_the_package(unpacked_wheel):
    here = {f.relative_to(ROOT / "conf") for f in (ROOT / "conf").rglob("*.yaml")}
    there = unpacked_wheel / "pipeline" / "conf"
    assert {f.relative_to(there) for f in there.rglob("*.yaml")} == here


def test_the_package_composes_its_configuration_away_from_the_checkout(unpacked_wheel, tmp_path):
    command = [sys.executable, "-m", "pipeline.app", "--cfg", "job", "selection.k=7"]
    done = subprocess.run(
        command, cwd=tmp_path, env={"PYTHONPATH": str(unpacked_wheel), "PATH": "/usr/bin:/bin"},
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert "k: 7" in done.stdout
    assert "play_half_width_deg: 2.23" in done.stdout
