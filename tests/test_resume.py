"""A sweep that is killed at random moments ends as one that nobody disturbed.

A small version of `benchmarks/kills.py`, which also fills disks and locks folders.
"""

import importlib.util
import json
import random
import shutil
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[1]
KILLS = 6
SMALL = [
    "-m", "hydra/launcher=basic", "stages=[training,evaluation]", "evaluation.trial=false",
    "training.n_init=1", "split=leave_three_out", "split.index=0,1", "selection.k=1,2",
]  # fmt: skip


@pytest.fixture(scope="module")
def kills() -> ModuleType:
    spec = importlib.util.spec_from_file_location("kills", ROOT / "benchmarks" / "kills.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["kills"] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.long
def test_a_killed_sweep_ends_as_an_undisturbed_one(kills: ModuleType, tmp_path: Path) -> None:
    shutil.copytree(ROOT / "data" / "paper_twin", tmp_path / "earlier" / "vision")
    asked = (*SMALL, f"earlier={tmp_path / 'earlier'}")
    undisturbed = kills.Place(tmp_path / "undisturbed", asked)
    status, errors = undisturbed.finish()
    assert (status, errors) == (0, "")
    rng, tally = random.Random(0), kills.Tally()
    for number in range(KILLS):
        place = kills.Place(tmp_path / f"round-{number % 2}", asked)
        kills.kill_at_random(place, rng, 4.0, tally)
        kills.prove(place, tally)
    for number in range(2):
        place = kills.Place(tmp_path / f"round-{number}", asked)
        assert place.finish() == (0, "")
        kills.compare(place, undisturbed, tally)
        assert len(kills.results_of(place)) == 4 * 6
    assert (tally.lost, tally.corrupt, tally.doubled, tally.other_tables) == (0, 0, 0, 0)
    assert tally.notes == []
    half = tmp_path / "round-0" / "sweep" / "0" / ".config.yaml.1.part"
    half.write_text("sel")
    assert kills.Place(tmp_path / "round-0", asked).finish() == (0, "")
    assert not half.exists(), "of a job that was done before and killed when asked again"
    again = json.loads((tmp_path / "round-0" / "sweep" / "0" / "provenance.json").read_text())
    assert [stage["stage"] for stage in again["stages"]] == ["training", "evaluation"]
    status, errors = kills.Place(tmp_path / "round-0", (*asked, "seed=1")).finish()
    assert status == 2
    assert "Ask the same again to go on, or write elsewhere: hydra.sweep.dir=OUT" in errors
