"""How one diagnosis compares with its truth."""

from dataclasses import dataclass
from itertools import permutations
from typing import Any

import numpy as np
import pandas as pd

from pipeline.concealed.cases import MEASUREMENT
from pipeline.concealed.motions import HELD_OUT, RECORDED_CYCLES
from pipeline.concealed.names import BENDS
from pipeline.concealed.seal import Truth

GIVEN_UP = ("unknown_physics", "partly_explained")
Entry = dict[str, Any]


@dataclass(frozen=True)
class Match:
    """Which named term stands for which hidden effect (None: none does), in the order of names.

    `missed` are hidden effects for which no name stands.
    """

    names: tuple[str, ...]
    stands_for: tuple[str | None, ...]
    missed: tuple[str, ...]


def entry_of(diagnosis: Entry) -> Entry:
    """The diagnosis of the concealed measurement."""
    entries: list[Entry] = diagnosis["measurements"]
    return next(e for e in entries if e["measurement"] == MEASUREMENT)


def matched(physics: list[Entry], truth: Truth) -> Match:
    """Names against hidden effects: exactly, or a true rival that states the true one beside it."""
    names = tuple(str(p["name"]) for p in physics)
    hidden = [e for e in truth["effects"] if e["in_catalogue"]]
    best: tuple[str | None, ...] = (None,) * len(names)
    slots = [*range(len(hidden)), *([None] * len(names))]
    for order in set(permutations(slots, len(names))) if names else ():
        stands = tuple(
            hidden[i]["name"] if i is not None and _stands_for(physics[k], hidden[i]) else None
            for k, i in enumerate(order)
        )
        best = max(best, stands, key=lambda s: _worth(s, names))
    missed = tuple(e["name"] for e in hidden if e["name"] not in best)
    return Match(names, best, missed)


def _worth(stands: tuple[str | None, ...], names: tuple[str, ...]) -> tuple[int, int]:
    found = sum(s is not None for s in stands)
    return found, sum(s == n for s, n in zip(stands, names, strict=True))


def _stands_for(named: Entry, effect: Entry) -> bool:
    if named["name"] == effect["name"]:
        return True
    return named["name"] in effect["rivals"] and effect["name"] in named.get("alternatives", [])


@dataclass(frozen=True)
class Answer:
    """What was handed in for a case: its diagnosis, perhaps predictions and a second diagnosis.

    `predictions` has the rows of the recording with its later cycles; `followed_up` is the
    diagnosis after the proposed block was recorded; `seconds` are those of one core that the first
    diagnosis took.
    """

    diagnosis: Entry
    predictions: pd.DataFrame | None = None
    followed_up: Entry | None = None
    seconds: float = float("nan")


def outcome(
    case: str, truth: Truth, answer: Answer, measured_deg: np.ndarray, cycle: np.ndarray
) -> dict[str, Any]:
    """One row of the outcomes: what was hidden, what was said, whether it's right, how it fits.

    `measured_deg` and `cycle` (n,) are the recording's with its later cycles.
    """
    entry = entry_of(answer.diagnosis)
    match = matched(entry["physics"], truth)
    implied = {name for e in truth["effects"] for name in e["implied"]}
    extra = [n for n, s in zip(match.names, match.stands_for, strict=True) if s is None]
    verdict = str(entry["verdict"])
    alarm = verdict != "no_mismatch" or bool(match.names)
    sizes = [e["beside_over_noise"] for e in truth["effects"]]
    return {
        "case": case,
        "kind": truth["kind"],
        "excitation": truth["excitation"],
        "hidden": "+".join(sorted(e["name"] for e in truth["effects"])),
        "named": "+".join(sorted(match.names)),
        "verdict": verdict,
        "smallest_over_noise": min(sizes, default=0.0),
        "right": not extra and not match.missed and (bool(match.names) or not alarm),
        "exact": sorted(match.names) == sorted(e["name"] for e in truth["effects"]),
        "alarm": alarm,
        "not_drift": bool(set(match.names) - {"drift"}),
        "gave_up": verdict in GIVEN_UP,
        "handled": verdict in GIVEN_UP and len(match.names) <= 1,
        "spurious": sum(name not in implied for name in extra),
        "missed": "+".join(match.missed),
        "resolved": _resolved(truth, answer.followed_up),
        "held_out_over_noise": held_out_ratio(truth, answer.predictions, measured_deg, cycle),
        "claimed_over_noise": _claimed(entry, truth),
        "later_over_noise": later_ratio(truth, answer.predictions, cycle),
        "floor_over_noise": _later_floor(truth),
        "seconds": answer.seconds,
    }


def _resolved(truth: Truth, diagnosis: Entry | None) -> float:
    """1 if the second diagnosis names exactly what is hidden and no longer calls it a tie.

    NaN without one, and where no motion could tell (what bends one static curve).
    """
    hidden = sorted(e["name"] for e in truth["effects"])
    if diagnosis is None or set(hidden) & BENDS:
        return float("nan")
    entry = entry_of(diagnosis)
    named = sorted(str(p["name"]) for p in entry["physics"])
    return float(named == hidden and entry["verdict"] != "ambiguous")


def held_out_ratio(truth: Truth, predictions: pd.DataFrame | None, measured_deg: np.ndarray,
                   cycle: np.ndarray) -> float:  # fmt: skip
    """rms of measurement minus prediction on held-out cycles over that of the true noise there.

    Frames that the plant's camera mistook are left out of both; NaN without predictions.
    """
    if predictions is None:
        return float("nan")
    good = np.isin(cycle, HELD_OUT) & np.isfinite(measured_deg)
    good[truth["mistaken_rows"]] = False
    error = measured_deg - predictions[f"{MEASUREMENT}_predicted"].to_numpy(float)
    return float(np.sqrt(np.mean(error[good] ** 2)) / truth["noise"]["held_out_rms_deg"])


def later_ratio(truth: Truth, predictions: pd.DataFrame | None, cycle: np.ndarray) -> float:
    """rms of prediction minus clean truth on the later cycles over the noise's size; NaN without.

    NaN too where the zero walks at random: commands don't determine the angle there.
    """
    if predictions is None or truth["kind"] == "walk":
        return float("nan")
    later = cycle >= RECORDED_CYCLES
    error = predictions[f"{MEASUREMENT}_predicted"].to_numpy(float) - np.array(truth["clean_deg"])
    return float(np.sqrt(np.mean(error[later] ** 2)) / truth["noise"]["total_deg"])


def _later_floor(truth: Truth) -> float:
    """What `later_ratio` is for one who knows all but calibration; NaN where that one is."""
    if truth["kind"] == "walk":
        return float("nan")
    return float(truth["noise"]["later_floor_deg"] / truth["noise"]["total_deg"])


def _claimed(entry: Entry, truth: Truth) -> float:
    """The held-out RMSE that the diagnosis states, over the true noise there."""
    rmse = (entry.get("after") or {}).get("heldout_rmse")
    return float("nan") if rmse is None else float(rmse) / truth["noise"]["held_out_rms_deg"]
