"""Scoring by hand-made answers: an oracle, a liar, and everything between."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from pipeline.concealed.benchmark import generate
from pipeline.concealed.draw import draw_cases
from pipeline.concealed.outcome import Answer, matched, outcome
from pipeline.concealed.score import score
from pipeline.concealed.seal import SealError
from pipeline.concealed.tables import confusion_table, smallest_found
from pipeline.errors import LoopgapError
from pipeline.recording import load_recording

COUNTS = {
    "none": 2, "walk": 2, "one": 8, "two": 2, "three": 2, "outside": 2, "small": 2,
    "known_none": 2, "known_one": 4,
}  # fmt: skip


def term(name: str, alternatives: tuple[str, ...] = (), probability: float = 0.9) -> dict[str, Any]:
    return {
        "name": name,
        "probability": probability,
        "alternatives": list(alternatives),
        "parameters": [],
    }


def diagnosis(verdict: str, *physics: dict[str, Any], rmse: float = 0.2) -> dict[str, Any]:
    entry = {
        "measurement": "pitch_angle_deg",
        "verdict": verdict,
        "physics": list(physics),
        "after": {"heldout_rmse": rmse},
    }
    return {"measurements": [entry]}


def effect(name: str, *rivals: str, implied: tuple[str, ...] = ()) -> dict[str, Any]:
    return {
        "name": name,
        "in_catalogue": name != "snap_through",
        "rivals": list(rivals),
        "implied": list(implied),
        "beside_over_noise": 2.0,
        "comparable": [],
    }


def truth_of(kind: str, *effects: dict[str, Any]) -> dict[str, Any]:
    return {
        "kind": kind,
        "excitation": "plain",
        "effects": list(effects),
        "mistaken_rows": [],
        "clean_deg": [0.0] * 15,
        "noise": {"held_out_rms_deg": 0.2, "total_deg": 0.2, "later_floor_deg": 0.02},
    }


CYCLE = np.arange(15.0)


def judged(truth: dict[str, Any], said: dict[str, Any], **more: Any) -> dict[str, Any]:
    return outcome("case-000", truth, Answer(said, **more), np.zeros(15), CYCLE)


def test_exact_names_are_right():
    truth = truth_of("two", effect("backlash"), effect("gravity"))
    row = judged(truth, diagnosis("explained", term("gravity"), term("backlash")))
    assert row["right"]
    assert row["exact"]
    assert row["spurious"] == 0


def test_a_rival_counts_only_if_it_is_true_and_states_the_hidden_one():
    truth = truth_of("one", effect("creep", "friction"))
    stated = judged(truth, diagnosis("ambiguous", term("friction", ("creep",))))
    assert stated["right"]
    assert not stated["exact"]
    assert not judged(truth, diagnosis("explained", term("friction")))["right"]
    no_rival = truth_of("one", effect("creep"))
    row = judged(no_rival, diagnosis("ambiguous", term("friction", ("creep",))))
    assert not row["right"]
    assert row["spurious"] == 1


def test_a_missed_effect_or_a_further_name_is_wrong():
    truth = truth_of("two", effect("backlash"), effect("drift"))
    missed = judged(truth, diagnosis("explained", term("backlash")))
    assert (missed["right"], missed["missed"], missed["spurious"]) == (False, "drift", 0)
    more = diagnosis("explained", term("backlash"), term("drift"), term("slack"))
    row = judged(truth, more)
    assert (row["right"], row["missed"], row["spurious"]) == (False, "", 1)


def test_an_implied_name_is_not_spurious_but_not_right_either():
    truth = truth_of("one", effect("tension_loss", implied=("backlash",)))
    row = judged(truth, diagnosis("explained", term("tension_loss"), term("backlash")))
    assert (row["right"], row["spurious"]) == (False, 0)


def test_one_name_stands_for_one_effect_and_the_exact_one_goes_first():
    truth = truth_of("two", effect("gravity", "lens_distortion"), effect("friction", "creep"))
    physics = [term("lens_distortion", ("gravity",)), term("friction", ("creep",))]
    match = matched(physics, truth)
    assert match.stands_for == ("gravity", "friction")
    twice = matched([term("gravity"), term("lens_distortion", ("gravity",))], truth)
    assert twice.stands_for == ("gravity", None)
    assert twice.missed == ("friction",)


def test_any_verdict_but_no_mismatch_is_an_alarm_where_nothing_is_hidden():
    nothing = truth_of("none")
    assert judged(nothing, diagnosis("no_mismatch"))["right"]
    assert not judged(nothing, diagnosis("no_mismatch"))["alarm"]
    assert judged(nothing, diagnosis("unknown_physics"))["alarm"]
    assert not judged(nothing, diagnosis("unknown_physics"))["right"]


@pytest.mark.parametrize(
    ("verdict", "names", "handled"),
    [
        ("unknown_physics", 0, True),
        ("partly_explained", 1, True),
        ("partly_explained", 2, False),
        ("explained", 1, False),
        ("no_mismatch", 0, False),
    ],
)
def test_an_effect_outside_wants_the_verdict_and_at_most_one_name(verdict, names, handled):
    said = diagnosis(verdict, *[term(n) for n in ("backlash", "drift")[:names]])
    assert judged(truth_of("outside", effect("snap_through")), said)["handled"] is handled


def test_a_tie_is_resolved_by_the_exact_name_without_ambiguity():
    truth = truth_of("one", effect("creep", "friction"))
    first = diagnosis("ambiguous", term("friction", ("creep",)))
    told = judged(truth, first, followed_up=diagnosis("explained", term("creep")))
    still = judged(truth, first, followed_up=diagnosis("ambiguous", term("creep", ("friction",))))
    assert (told["resolved"], still["resolved"]) == (1.0, 0.0)
    assert np.isnan(judged(truth, first)["resolved"])
    bend = truth_of("one", effect("gravity", "lens_distortion"))
    assert np.isnan(judged(bend, first, followed_up=first)["resolved"])


def test_fits_are_measured_against_the_noise():
    predicted = pd.DataFrame({"pitch_angle_deg_predicted": np.where(CYCLE < 9, 0.3, 0.05)})
    row = judged(truth_of("none"), diagnosis("no_mismatch", rmse=0.25), predictions=predicted)
    assert row["held_out_over_noise"] == pytest.approx(1.5)
    assert row["claimed_over_noise"] == pytest.approx(1.25)
    assert row["later_over_noise"] == pytest.approx(0.25)
    walk = judged(truth_of("walk"), diagnosis("no_mismatch"), predictions=predicted)
    assert np.isnan(walk["later_over_noise"])


def test_the_confusion_pairs_a_wrong_name_with_what_it_missed():
    rows = [
        ("a", "creep", "(nothing)"), ("a", "(nothing)", "friction"),
        ("b", "creep", "creep"), ("c", "(nothing)", "drift"), ("d", "slack", "(nothing)"),
    ]  # fmt: skip
    table = confusion_table(pd.DataFrame(rows, columns=["case", "hidden", "named"]))
    assert table.loc["creep", "friction"] == 1
    assert table.loc["creep", "creep"] == 1
    assert table.loc["(nothing)", "drift"] == 1
    assert table.loc["slack", "(nothing)"] == 1
    assert table.to_numpy().sum() == 4


def test_the_smallest_size_found_is_where_the_misses_end():
    sizes = np.geomspace(0.01, 10, 301)
    terms = pd.DataFrame(
        {"kind": "one", "hidden": "backlash", "over_noise": sizes, "right": sizes > 0.3}
    )
    assert smallest_found(terms) == pytest.approx(0.3, rel=0.4)
    assert np.isnan(smallest_found(terms.assign(right=False)))
    assert np.isnan(smallest_found(terms[:5]))


@pytest.fixture(scope="module")
def folders(tmp_path_factory) -> tuple[Path, Path]:
    folder = tmp_path_factory.mktemp("benchmark")
    generate(folder / "cases", folder / "truth", draw_cases(5, COUNTS))
    return folder / "cases", folder / "truth"


def answer_truly(cases: Path, truths: Path, results: Path) -> None:
    """What one would hand in who knew everything."""
    seconds = []
    for file in sorted(truths.glob("*.json")):
        truth = json.loads(file.read_text())["truth"]
        physics = [
            term(e["name"])
            | {"parameters": [q | {"low": q["value"], "high": q["value"]} for q in e["comparable"]]}
            for e in truth["effects"]
            if e["in_catalogue"]
        ]
        outside = truth["kind"] == "outside"
        verdict = "partly_explained" if outside else "explained" if physics else "no_mismatch"
        folder = results / truth["case"]
        folder.mkdir(parents=True)
        said = diagnosis(verdict, *physics, rmse=truth["noise"]["held_out_rms_deg"])
        (folder / "diagnosis.json").write_text(json.dumps(said))
        later = load_recording(cases / f"{truth['case']}.later")
        pd.DataFrame(
            {"time_s": later.values("time_s"), "pitch_angle_deg_predicted": truth["clean_deg"]}
        ).to_csv(folder / "predictions.csv", index=False)
        seconds.append({"case": truth["case"], "seconds": 1.5})
    pd.DataFrame(seconds).to_csv(results / "seconds.csv", index=False)


def test_an_oracle_meets_every_requirement_that_it_can(folders, tmp_path):
    cases, truths = folders
    answer_truly(cases, truths, tmp_path)
    got = score(cases, tmp_path, truths)
    assert len(got.outcomes) == sum(COUNTS.values())
    table = got.requirements.set_index("requirement")
    unmet = table.index[(table["plain met"] == "no") | (table["rich met"] == "no")]
    assert list(unmet) == ["95 % intervals cover, at most"]
    assert table.loc["held-out RMSE over noise, median", "plain"] == pytest.approx(1.0, abs=1e-3)
    assert table.loc["later cycles over noise, 90th percentile", "rich"] == pytest.approx(
        0, abs=1e-3
    )
    assert table.loc["one effect right", "plain of"] == COUNTS["one"] / 2
    beside = "one effect right, the simulation with a loop of its own"
    assert table.loc[beside, "rich of"] == COUNTS["known_one"] / 2
    apart = COUNTS["small"] + COUNTS["known_none"] + COUNTS["known_one"]
    assert table.loc["seconds a case on one core, 95th percentile", "plain of"] == (
        (sum(COUNTS.values()) - apart) / 2
    )
    floor = got.outcomes["floor_over_noise"].dropna()
    assert len(floor) == len(got.outcomes) - COUNTS["walk"]
    assert ((floor > 0.001) & (floor < 0.6)).all()
    assert len(got.intervals) > 0
    assert got.calibration["right"].tolist() == [1.0]
    assert got.effects["effects"].sum() >= 8 + 4 + 6


def test_one_who_sees_nothing_raises_no_alarm_and_finds_nothing(folders, tmp_path):
    cases, truths = folders
    for case in json.loads((cases / "commitments.json").read_text()):
        (tmp_path / case).mkdir()
        (tmp_path / case / "diagnosis.json").write_text(json.dumps(diagnosis("no_mismatch")))
    table = score(cases, tmp_path, truths).requirements.set_index("requirement")
    assert table.loc["false alarms, nothing concealed", "plain"] == 0.0
    for name in ("one effect right", "three effects right"):
        assert table.loc[name, "rich"] == 0.0
    assert table.loc["outside the catalogue: said so, at most one name", "plain"] == 0.0
    assert table.loc["seconds a case on one core, 95th percentile", "plain met"] == ""


def test_a_missing_diagnosis_is_refused(folders, tmp_path):
    with pytest.raises(LoopgapError, match=r"case-000.diagnosis.json: expected the diagnosis"):
        score(*((folders[0]), tmp_path, folders[1]))


def test_a_truth_that_was_changed_is_not_scored(folders, tmp_path):
    cases, truths = folders
    changed = tmp_path / "truth"
    changed.mkdir()
    for file in truths.glob("*.json"):
        envelope = json.loads(file.read_text())
        envelope["truth"]["effects"] = []
        (changed / file.name).write_text(json.dumps(envelope))
    with pytest.raises(SealError, match="Draw the benchmark anew"):
        score(cases, tmp_path, changed)


def test_nothing_but_recordings_and_hashes_is_published(folders):
    cases, _ = folders
    files = {p.name for p in cases.rglob("*") if p.is_file()}
    assert files == {"recording.json", "samples.csv", "declared.csv", "commitments.json"}
    public = "".join(p.read_text() for p in cases.rglob("*.json"))
    assert "backlash" not in public
    assert all(len(c) == 64 for c in json.loads((cases / "commitments.json").read_text()).values())
