"""What the benchmark must show, and what it showed."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd

from pipeline.concealed.names import EFFECTS_BESIDE_KNOWN

CATALOGUE_KINDS = ("one", "two", "three")
KNOWN_KINDS = tuple(EFFECTS_BESIDE_KNOWN)
Figure = tuple[float, int]
FigureOf = Callable[[pd.DataFrame, pd.DataFrame], Figure]


@dataclass(frozen=True)
class Requirement:
    """One row: a figure of the cases' outcomes and intervals, bounded on plain and rich motions."""

    name: str
    sign: str
    plain: float
    rich: float | None
    figure: FigureOf

    def met(self, excitation: str, found: float) -> str:
        """Whether the bound is kept, "yes" or "no"; empty without a bound or a figure."""
        bound = self.plain if excitation == "plain" else self.rich
        if bound is None or not np.isfinite(found):
            return ""
        return "yes" if (found >= bound if self.sign == ">=" else found <= bound) else "no"


def _share(values: "pd.Series[bool]") -> Figure:
    kept = values.dropna()
    return (float(kept.mean()) if len(kept) else float("nan")), len(kept)


def _of_kind(column: str, *kinds: str) -> FigureOf:
    return lambda cases, intervals: _share(cases.loc[cases["kind"].isin(kinds), column])


def _quantile(column: str, share: float) -> FigureOf:
    """Of all cases but those outside the catalogue, whose rest nobody can predict.

    And but those whose simulation has a loop of its own, which have rows of their own.
    """
    return lambda cases, intervals: _quantile_of(
        cases.loc[~cases["kind"].isin(("outside", *KNOWN_KINDS)), column], share
    )


def _quantile_beside_known(column: str, share: float) -> FigureOf:
    return lambda cases, intervals: _quantile_of(
        cases.loc[cases["kind"].isin(KNOWN_KINDS), column], share
    )


def _quantile_of(values: "pd.Series[float]", share: float) -> Figure:
    kept = values.dropna()
    return (float(kept.quantile(share)) if len(kept) else float("nan")), len(kept)


def _coverage(cases: pd.DataFrame, intervals: pd.DataFrame) -> Figure:
    """Of all cases but those whose simulation has a loop of its own."""
    return _share(intervals.loc[~_beside_known(cases, intervals), "covers"])


def _coverage_beside_known(cases: pd.DataFrame, intervals: pd.DataFrame) -> Figure:
    return _share(intervals.loc[_beside_known(cases, intervals), "covers"])


def _beside_known(cases: pd.DataFrame, intervals: pd.DataFrame) -> "pd.Series[bool]":
    return intervals["case"].isin(cases.loc[cases["kind"].isin(KNOWN_KINDS), "case"])


def _seconds(cases: pd.DataFrame, intervals: pd.DataFrame) -> Figure:
    return _quantile_of(cases.loc[~cases["kind"].isin(KNOWN_KINDS), "seconds"], 0.95)


REQUIREMENTS = (
    Requirement("one effect right", ">=", 0.95, 0.98, _of_kind("right", "one")),
    Requirement("two effects right", ">=", 0.90, 0.95, _of_kind("right", "two")),
    Requirement("three effects right", ">=", 0.75, 0.90, _of_kind("right", "three")),
    Requirement("false alarms, nothing concealed", "<=", 0.02, 0.02, _of_kind("alarm", "none")),
    Requirement("the same with a random walk", "<=", 0.05, 0.05, _of_kind("alarm", "walk")),
    Requirement(
        "outside the catalogue: said so, at most one name", ">=", 0.90, 0.90,
        _of_kind("handled", "outside"),
    ),
    Requirement(
        "said so where the catalogue suffices", "<=", 0.05, 0.05,
        _of_kind("gave_up", *CATALOGUE_KINDS),
    ),
    Requirement(
        "names a case neither true nor implied", "<=", 0.05, 0.05,
        _of_kind("spurious", "none", "walk", *CATALOGUE_KINDS),
    ),
    Requirement(
        "held-out RMSE over noise, median", "<=", 1.02, 1.02, _quantile("held_out_over_noise", 0.5)
    ),
    Requirement(
        "held-out RMSE over noise, 90th percentile", "<=", 1.10, 1.10,
        _quantile("held_out_over_noise", 0.9),
    ),
    Requirement(
        "later cycles over noise, median", "<=", 0.10, 0.10, _quantile("later_over_noise", 0.5)
    ),
    Requirement(
        "later cycles over noise, 90th percentile", "<=", 0.25, 0.25,
        _quantile("later_over_noise", 0.9),
    ),
    Requirement("95 % intervals cover, at least", ">=", 0.92, 0.92, _coverage),
    Requirement("95 % intervals cover, at most", "<=", 0.97, 0.97, _coverage),
    Requirement(
        "tie resolved after the proposed block", ">=", 0.95, None,
        _of_kind("resolved", *CATALOGUE_KINDS),
    ),
    Requirement("seconds a case on one core, 95th percentile", "<=", 3.0, 3.0, _seconds),
    Requirement(
        "one effect right, the simulation with a loop of its own", ">=", 0.95, 0.98,
        _of_kind("right", "known_one"),
    ),
    Requirement(
        "false alarms, the same with nothing concealed", "<=", 0.02, 0.02,
        _of_kind("alarm", "known_none"),
    ),
)  # fmt: skip
FURTHER: dict[str, FigureOf] = {
    "one effect named exactly": _of_kind("exact", "one"),
    "two effects named exactly": _of_kind("exact", "two"),
    "three effects named exactly": _of_kind("exact", "three"),
    "random walk: names other than drift": _of_kind("not_drift", "walk"),
    "outside: names not hidden": _of_kind("spurious", "outside"),
    "held-out RMSE as stated over noise, median": _quantile("claimed_over_noise", 0.5),
    "later cycles, knowing all but calibration, median": _quantile("floor_over_noise", 0.5),
    "the same, 90th percentile": _quantile("floor_over_noise", 0.9),
    "simulation with a loop: held-out RMSE over noise, 90th percentile": _quantile_beside_known(
        "held_out_over_noise", 0.9
    ),
    "the same, later cycles over noise, 90th percentile": _quantile_beside_known(
        "later_over_noise", 0.9
    ),
    "the same, 95 % intervals cover": _coverage_beside_known,
    "the same, seconds a case, 95th percentile": _quantile_beside_known("seconds", 0.95),
}


def requirement_table(outcomes: pd.DataFrame, intervals: pd.DataFrame) -> pd.DataFrame:
    """Found against required, a row each, for plain cycles and rich excitation."""
    rows = []
    for requirement in REQUIREMENTS:
        row: dict[str, object] = {"requirement": requirement.name}
        for excitation in ("plain", "rich"):
            found, count = _found(requirement.figure, excitation, outcomes, intervals)
            bound = requirement.plain if excitation == "plain" else requirement.rich
            row |= {
                excitation: found,
                f"{excitation} wanted": "" if bound is None else f"{requirement.sign} {bound:g}",
                f"{excitation} met": requirement.met(excitation, found),
                f"{excitation} of": count,
            }
        rows.append(row)
    return pd.DataFrame(rows)


def further_table(outcomes: pd.DataFrame, intervals: pd.DataFrame) -> pd.DataFrame:
    """Figures without a bound that help to read the others."""
    rows = []
    for name, figure in FURTHER.items():
        row: dict[str, object] = {"figure": name}
        for excitation in ("plain", "rich"):
            found, count = _found(figure, excitation, outcomes, intervals)
            row |= {excitation: found, f"{excitation} of": count}
        rows.append(row)
    return pd.DataFrame(rows)


def _found(
    figure: FigureOf, excitation: str, outcomes: pd.DataFrame, intervals: pd.DataFrame
) -> Figure:
    cases = outcomes[(outcomes["excitation"] == excitation) & (outcomes["kind"] != "small")]
    stated = intervals[intervals["excitation"] == excitation] if len(intervals) else intervals
    return figure(cases, stated)
