"""The recordings that travel with the project are what they were when they were made."""

import hashlib
from pathlib import Path

import pytest

from pipeline.recording import load_recording

DATA = Path(__file__).resolve().parents[1] / "data"
SUMS = [line.split(maxsplit=1) for line in (DATA / "SHA256SUMS").read_text().splitlines()]


@pytest.mark.parametrize(("expected", "name"), SUMS)
def test_file_is_unchanged(expected, name):
    assert hashlib.sha256((DATA / name.strip()).read_bytes()).hexdigest() == expected


def test_every_file_has_a_checksum():
    names = {str(f.relative_to(DATA)) for f in DATA.glob("*/*/*")}
    assert names == {name.strip() for _, name in SUMS}


@pytest.mark.parametrize("axis", ["yaw", "pitch"])
def test_recording_loads(axis):
    recording = load_recording(DATA / "paper_twin" / axis)
    assert len(recording.samples) == 1800
    assert recording.simulation_of(f"{axis}_angle_deg") is not None
