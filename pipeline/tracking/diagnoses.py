"""Diagnoses as tables: a row for each measurement, of one run or of all jobs of a sweep."""

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from pipeline.number_words import worded

DIAGNOSIS_FILE = "diagnosis.json"
Entry = Mapping[str, Any]


def read_diagnoses(folder: Path) -> list[Entry]:
    """The entries of a run's diagnosis.json, none if it has none; ValueError for a broken file."""
    file = folder / DIAGNOSIS_FILE
    if not file.is_file():
        return []
    try:
        entries = list(json.loads(file.read_text(encoding="utf-8"))["measurements"])
        overview(entries)
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{DIAGNOSIS_FILE}: no diagnosis: {error}") from error
    return entries


def overview(entries: Sequence[Entry]) -> pd.DataFrame:
    """A row for each measurement: verdict, what was left out, error before and after, noise."""
    rows = [
        {
            "measurement": entry["measurement"],
            "verdict": entry["verdict"].replace("_", " "),
            "left out": left_out(entry) or "nothing",
            "held-out RMSE before": entry["before"]["heldout_rmse"],
            "after": entry["after"]["heldout_rmse"],
            "noise": entry["noise"],
            "unit": entry["unit"],
        }
        for entry in entries
    ]
    return pd.DataFrame(rows)


def left_out(entry: Entry) -> str:
    """The named physics with what each may also be: `creep or friction + gravity`."""
    return " + ".join(" or ".join((p["name"], *p["alternatives"])) for p in entry["physics"])


def how_much(entry: Entry) -> str:
    """The named physics' parameters, intervals, units: `backlash: width 4 (3.9 to 4.1) deg`."""
    return "; ".join(
        f"{p['name']}: {', '.join(_with_interval(one) for one in p['parameters'])}"
        for p in entry["physics"]
        if p["parameters"]
    )


def parameters(entries: Iterable[Entry]) -> pd.DataFrame:
    """A row for each parameter of each name, with its 95 % interval; full precision.

    A name without parameters has one row, with an empty parameter.
    """
    none = {"name": None, "value": None, "low": None, "high": None, "unit": None}
    rows = [
        {
            "measurement": entry["measurement"],
            "name": physics["name"],
            "alternatives": " or ".join(physics["alternatives"]),
            "probability": physics["probability"],
            "parameter": one["name"],
            **{key: one[key] for key in ("value", "low", "high", "unit")},
        }
        for entry in entries
        for physics in entry["physics"]
        for one in physics["parameters"] or [none]
    ]
    return pd.DataFrame(rows)


def _with_interval(one: Entry) -> str:
    low, high = worded(one["low"]), worded(one["high"])
    return f"{one['name']} {worded(one['value'])} ({low} to {high}) {one['unit']}".strip()
