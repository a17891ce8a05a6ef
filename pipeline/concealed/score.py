"""Open the seals, compare every diagnosis with its truth, and make the tables."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from pipeline.concealed.outcome import entry_of, matched, outcome
from pipeline.concealed.seal import Truth, opened
from pipeline.concealed.tables import (
    calibration_table,
    confusion_table,
    requirement_table,
    smallest_table,
)
from pipeline.errors import LoopgapError, refusal
from pipeline.recording import load_recording


@dataclass(frozen=True)
class Score:
    """Tables of a benchmark: a row a case, a row a requirement, and what the pictures need."""

    outcomes: pd.DataFrame
    requirements: pd.DataFrame
    confusion: pd.DataFrame
    calibration: pd.DataFrame
    intervals: pd.DataFrame
    terms: pd.DataFrame
    smallest: pd.DataFrame


def score(folder_cases: Path, folder_results: Path, folder_truth: Path,
          seconds: Mapping[str, float]) -> Score:  # fmt: skip
    """Score `folder_results/CASE/diagnosis.json` and `predictions.csv` for all committed cases.

    `seconds` is the time that each diagnosis took. SealError where a truth isn't the sealed one,
    LoopgapError where a diagnosis is missing.
    """
    promised = json.loads((folder_cases / "commitments.json").read_text(encoding="utf-8"))
    return score_cases(folder_cases, folder_results, folder_truth, promised, seconds)


def score_cases(folder_cases: Path, folder_results: Path, folder_truth: Path,
                promised: Mapping[str, str], seconds: Mapping[str, float]) -> Score:  # fmt: skip
    """Score the cases of `promised` (name: commitment) only."""
    rows: list[dict[str, Any]] = []
    terms: list[dict[str, Any]] = []
    intervals: list[dict[str, Any]] = []
    for case, commitment in promised.items():
        envelope = json.loads((folder_truth / f"{case}.json").read_text(encoding="utf-8"))
        truth = opened(case, envelope, commitment)
        diagnosis = _diagnosis(folder_results / case / "diagnosis.json")
        predictions = _predictions(folder_results / case / "predictions.csv")
        later = load_recording(folder_cases / f"{case}.later")
        rows.append(
            outcome(
                case, truth, diagnosis, predictions, later.values("pitch_angle_deg"),
                later.values("cycle"), seconds.get(case, float("nan")),
            )
        )  # fmt: skip
        terms += named_terms(case, truth, diagnosis)
        intervals += stated_intervals(case, truth, diagnosis)
    outcomes = pd.DataFrame(rows)
    named, covered = pd.DataFrame(terms), pd.DataFrame(intervals)
    return Score(
        outcomes=outcomes,
        requirements=requirement_table(outcomes, covered),
        confusion=confusion_table(named),
        calibration=calibration_table(named),
        intervals=covered,
        terms=named,
        smallest=smallest_table(named),
    )


def named_terms(case: str, truth: Truth, diagnosis: dict[str, Any]) -> list[dict[str, Any]]:
    """A row for each named term and each missed effect: hidden name, stated name, probability."""
    physics = entry_of(diagnosis)["physics"]
    match = matched(physics, truth)
    sizes = {e["name"]: e["beside_over_noise"] for e in truth["effects"]}
    common = {"case": case, "kind": truth["kind"], "excitation": truth["excitation"]}
    rows = []
    for term, stands in zip(physics, match.stands_for, strict=True):
        rows.append(
            common
            | {
                "hidden": stands or "(nothing)",
                "named": term["name"],
                "right": stands is not None,
                "probability": term["probability"],
                "over_noise": sizes.get(stands or "", float("nan")),
            }
        )
    outside = [e["name"] for e in truth["effects"] if not e["in_catalogue"]]
    for name in (*match.missed, *outside):
        rows.append(
            common
            | {
                "hidden": name,
                "named": "(nothing)",
                "right": False,
                "probability": float("nan"),
                "over_noise": sizes[name],
            }
        )
    return rows


def stated_intervals(case: str, truth: Truth, diagnosis: dict[str, Any]) -> list[dict[str, Any]]:
    """A row for each stated 95 % interval of a rightly named effect that has a true value."""
    entry = entry_of(diagnosis)
    true = {
        (e["name"], q["name"], q["unit"]): q["value"]
        for e in truth["effects"]
        for q in e["comparable"]
    }
    rows = []
    for term in entry["physics"]:
        for parameter in term["parameters"]:
            key = (term["name"], parameter["name"], parameter["unit"])
            if key in true and parameter["low"] is not None:
                rows.append(
                    {
                        "case": case,
                        "excitation": truth["excitation"],
                        "name": term["name"],
                        "parameter": parameter["name"],
                        "true": true[key],
                        "value": parameter["value"],
                        "low": parameter["low"],
                        "high": parameter["high"],
                        "covers": parameter["low"] <= true[key] <= parameter["high"],
                    }
                )
    return rows


def _diagnosis(path: Path) -> dict[str, Any]:
    if not path.is_file():
        raise LoopgapError(
            refusal(str(path), "the diagnosis of a case", "no such file", "Diagnose all cases.")
        )
    diagnosis: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return diagnosis


def _predictions(path: Path) -> pd.DataFrame | None:
    return pd.read_csv(path) if path.is_file() else None
