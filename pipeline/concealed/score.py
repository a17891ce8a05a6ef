"""Open the seals, compare every diagnosis with its truth, and make the tables."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from pipeline.concealed.cases import MEASUREMENT
from pipeline.concealed.outcome import Answer, entry_of, matched, outcome
from pipeline.concealed.requirements import further_table, requirement_table
from pipeline.concealed.seal import Truth, opened
from pipeline.concealed.tables import (
    NOTHING,
    calibration_table,
    confusion_table,
    effect_table,
    smallest_found,
    smallest_table,
)
from pipeline.errors import LoopgapError, refusal
from pipeline.recording import load_recording

TERM_COLUMNS = ["case", "kind", "excitation", "hidden", "named", "right", "probability",
                "over_noise"]  # fmt: skip
INTERVAL_COLUMNS = ["case", "excitation", "name", "parameter", "true", "value", "low", "high",
                    "covers"]  # fmt: skip


@dataclass(frozen=True)
class Score:
    """Tables of a benchmark: rows a case, a term, an interval, and what they come to."""

    outcomes: pd.DataFrame
    terms: pd.DataFrame
    intervals: pd.DataFrame
    requirements: pd.DataFrame
    further: pd.DataFrame
    confusion: pd.DataFrame
    calibration: pd.DataFrame
    effects: pd.DataFrame
    smallest: pd.DataFrame
    smallest_found_over_noise: float


def score(folder_cases: Path, folder_results: Path, folder_truth: Path) -> Score:
    """Score the diagnoses of all committed cases.

    `folder_results` has `CASE/diagnosis.json`, `CASE/predictions.csv` (rows of `CASE.later`),
    where a proposed block was recorded `CASE/follow_up/diagnosis.json`, and `seconds.csv` (case,
    seconds). SealError where a truth isn't the sealed one, LoopgapError where a diagnosis is
    missing.
    """
    promised = json.loads((folder_cases / "commitments.json").read_text(encoding="utf-8"))
    return score_cases(folder_cases, folder_results, folder_truth, promised)


def score_cases(
    folder_cases: Path, folder_results: Path, folder_truth: Path, promised: Mapping[str, str]
) -> Score:
    """The same for the cases of `promised` (name: commitment) only."""
    seconds = _seconds(folder_results / "seconds.csv")
    rows: list[dict[str, Any]] = []
    terms: list[dict[str, Any]] = []
    intervals: list[dict[str, Any]] = []
    for case, commitment in promised.items():
        envelope = json.loads((folder_truth / f"{case}.json").read_text(encoding="utf-8"))
        truth = opened(case, envelope, commitment)
        answer = _answer(folder_results / case, seconds.get(case, float("nan")))
        later = load_recording(folder_cases / f"{case}.later")
        rows.append(outcome(case, truth, answer, later.values(MEASUREMENT), later.values("cycle")))
        terms += named_terms(case, truth, answer.diagnosis)
        intervals += stated_intervals(case, truth, answer.diagnosis)
    return _tables(
        pd.DataFrame(rows),
        pd.DataFrame(terms, columns=TERM_COLUMNS),
        pd.DataFrame(intervals, columns=INTERVAL_COLUMNS),
    )


def _tables(outcomes: pd.DataFrame, terms: pd.DataFrame, intervals: pd.DataFrame) -> Score:
    return Score(
        outcomes=outcomes,
        terms=terms,
        intervals=intervals,
        requirements=requirement_table(outcomes, intervals),
        further=further_table(outcomes, intervals),
        confusion=confusion_table(terms),
        calibration=calibration_table(terms),
        effects=effect_table(terms),
        smallest=smallest_table(terms),
        smallest_found_over_noise=smallest_found(terms),
    )


def named_terms(case: str, truth: Truth, diagnosis: dict[str, Any]) -> list[dict[str, Any]]:
    """A row for each named term and each missed effect: hidden name, stated name, probability."""
    physics = entry_of(diagnosis)["physics"]
    match = matched(physics, truth)
    sizes = {e["name"]: e["beside_over_noise"] for e in truth["effects"]}
    stated = [
        (stands or NOTHING, str(term["name"]), float(term["probability"]))
        for term, stands in zip(physics, match.stands_for, strict=True)
    ]
    outside = [e["name"] for e in truth["effects"] if not e["in_catalogue"]]
    unsaid = [(name, NOTHING, float("nan")) for name in (*match.missed, *outside)]
    return [
        {
            "case": case,
            "kind": truth["kind"],
            "excitation": truth["excitation"],
            "hidden": hidden,
            "named": named,
            "right": NOTHING not in (hidden, named),
            "probability": probability,
            "over_noise": sizes.get(hidden, float("nan")),
        }
        for hidden, named, probability in [*stated, *unsaid]
    ]


def stated_intervals(case: str, truth: Truth, diagnosis: dict[str, Any]) -> list[dict[str, Any]]:
    """A row for each stated 95 % interval of a rightly named effect that has a true value."""
    true = {
        (e["name"], q["name"], q["unit"]): q["value"]
        for e in truth["effects"]
        for q in e["comparable"]
    }
    stated = [
        ((term["name"], parameter["name"], parameter["unit"]), parameter)
        for term in entry_of(diagnosis)["physics"]
        for parameter in term["parameters"]
    ]
    return [
        {
            "case": case,
            "excitation": truth["excitation"],
            "name": key[0],
            "parameter": key[1],
            "true": true[key],
            "value": parameter["value"],
            "low": parameter["low"],
            "high": parameter["high"],
            "covers": parameter["low"] <= true[key] <= parameter["high"],
        }
        for key, parameter in stated
        if key in true and parameter["low"] is not None and parameter["high"] is not None
    ]


def _answer(folder: Path, seconds: float) -> Answer:
    file = folder / "diagnosis.json"
    if not file.is_file():
        raise LoopgapError(
            refusal(str(file), "the diagnosis of a case", "no such file", "Diagnose all cases.")
        )
    predictions = folder / "predictions.csv"
    second = folder / "follow_up" / "diagnosis.json"
    return Answer(
        diagnosis=json.loads(file.read_text(encoding="utf-8")),
        predictions=pd.read_csv(predictions) if predictions.is_file() else None,
        followed_up=json.loads(second.read_text(encoding="utf-8")) if second.is_file() else None,
        seconds=seconds,
    )


def _seconds(file: Path) -> dict[str, float]:
    if not file.is_file():
        return {}
    table = pd.read_csv(file)
    return dict(zip(table["case"].astype(str), table["seconds"].astype(float), strict=True))
