"""The benchmark's tables, from the rows of its cases."""

from itertools import pairwise

import numpy as np
import pandas as pd

PROBABILITY_BINS = (0.0, 0.5, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0)
SIZE_BINS = (0.0, 0.1, 0.2, 0.35, 0.7, 1.0, 1.5, 2.5, 5.0, np.inf)
CATALOGUE_KINDS = ("one", "two", "three")
REQUIREMENTS: tuple[tuple[str, str, float, float], ...] = (
    ("one effect right", ">=", 0.95, 0.98),
    ("two effects right", ">=", 0.90, 0.95),
    ("three effects right", ">=", 0.75, 0.90),
    ("false alarms, nothing concealed", "<=", 0.02, 0.02),
    ("false alarms, nothing concealed, random walk", "<=", 0.05, 0.05),
    ("outside the catalogue: said so, at most one name", ">=", 0.90, 0.90),
    ("said so where the catalogue suffices", "<=", 0.05, 0.05),
    ("names a case neither true nor implied", "<=", 0.05, 0.05),
    ("held-out RMSE over noise, median", "<=", 1.02, 1.02),
    ("held-out RMSE over noise, 90th percentile", "<=", 1.10, 1.10),
    ("later cycles over noise, median", "<=", 0.10, 0.10),
    ("later cycles over noise, 90th percentile", "<=", 0.25, 0.25),
    ("95 % intervals cover, at least", ">=", 0.92, 0.92),
    ("95 % intervals cover, at most", "<=", 0.97, 0.97),
    ("seconds a case, 95th percentile", "<=", 3.0, 3.0),
)


def requirement_table(outcomes: pd.DataFrame, intervals: pd.DataFrame) -> pd.DataFrame:
    """Found against required, a row each requirement, for plain cycles and rich excitation."""
    rows = []
    for number, (name, sign, *wanted) in enumerate(REQUIREMENTS):
        row: dict[str, object] = {"requirement": name}
        for excitation, bound in zip(("plain", "rich"), wanted, strict=True):
            some = outcomes[(outcomes["excitation"] == excitation) & (outcomes["kind"] != "small")]
            held = intervals[intervals["excitation"] == excitation] if len(intervals) else intervals
            found, count = _figures(some, held)[number]
            met = found >= bound if sign == ">=" else found <= bound
            row |= {
                f"{excitation}": found,
                f"{excitation} wanted": f"{sign} {bound:g}",
                f"{excitation} met": bool(met) if np.isfinite(found) else None,
                f"{excitation} of": count,
            }
        rows.append(row)
    return pd.DataFrame(rows)


def _figures(some: pd.DataFrame, intervals: pd.DataFrame) -> list[tuple[float, int]]:
    """Figure and number of cases behind it, in the order of REQUIREMENTS."""
    none = some[some["kind"] == "none"]
    known = some[some["kind"].isin(CATALOGUE_KINDS)]
    inside = some[some["kind"] != "outside"]
    cover = _share(intervals["covers"]) if len(intervals) else (float("nan"), 0)
    return [
        *(_share(some.loc[some["kind"] == kind, "right"]) for kind in CATALOGUE_KINDS),
        _share(none.loc[~none["walk"], "alarm"]),
        _share(none.loc[none["walk"], "alarm"]),
        _share(some.loc[some["kind"] == "outside", "handled"]),
        _share(known["gave_up"]),
        _share(inside["spurious"]),
        _quantile(inside["held_out_over_noise"], 0.5),
        _quantile(inside["held_out_over_noise"], 0.9),
        _quantile(inside["later_over_noise"], 0.5),
        _quantile(inside["later_over_noise"], 0.9),
        cover,
        cover,
        _quantile(some["seconds"], 0.95),
    ]


def _share(values: "pd.Series[bool]") -> tuple[float, int]:
    return (float(values.mean()) if len(values) else float("nan")), len(values)


def _quantile(values: "pd.Series[float]", share: float) -> tuple[float, int]:
    kept = values.dropna()
    return (float(kept.quantile(share)) if len(kept) else float("nan")), len(kept)


def confusion_table(terms: pd.DataFrame) -> pd.DataFrame:
    """How often each hidden effect (row) was given each name (column); counts."""
    if terms.empty:
        return pd.DataFrame()
    named = terms.copy()
    wrong = _pair_up(named)
    return pd.crosstab(wrong["hidden"], wrong["named"])


def _pair_up(terms: pd.DataFrame) -> pd.DataFrame:
    """In a case with one missed effect and one wrong name, the name was given to that effect."""
    rows = []
    for _, some in terms.groupby("case", sort=False):
        wrong = some[some["hidden"] == "(nothing)"]
        missed = some[some["named"] == "(nothing)"]
        rows.append(some[(some["hidden"] != "(nothing)") & (some["named"] != "(nothing)")])
        pairs = min(len(wrong), len(missed))
        taken = missed.iloc[:pairs].assign(named=wrong["named"].to_numpy()[:pairs])
        rows += [taken, wrong.iloc[pairs:], missed.iloc[pairs:]]
    return pd.concat(rows)


def calibration_table(terms: pd.DataFrame) -> pd.DataFrame:
    """Stated probability against the share that was right, in bins of the probability."""
    stated = terms[terms["named"] != "(nothing)"] if len(terms) else terms
    rows = []
    for low, high in pairwise(PROBABILITY_BINS):
        if not len(stated):
            break
        within = (stated["probability"] > low) & (stated["probability"] <= high)
        some = stated[within | ((low == 0.0) & (stated["probability"] == 0.0))]
        if len(some):
            rows.append(
                {
                    "from": low,
                    "to": high,
                    "stated": float(some["probability"].mean()),
                    "right": float(some["right"].mean()),
                    "terms": len(some),
                }
            )
    return pd.DataFrame(rows, columns=["from", "to", "stated", "right", "terms"])


def smallest_table(terms: pd.DataFrame) -> pd.DataFrame:
    """Share of hidden catalogue effects that were found, by their size over the noise."""
    rows = []
    for low, high in pairwise(SIZE_BINS):
        if not len(terms):
            break
        hidden = terms[(terms["hidden"] != "(nothing)") & (terms["kind"] != "outside")]
        some = hidden[(hidden["over_noise"] >= low) & (hidden["over_noise"] < high)]
        if len(some):
            rows.append(
                {
                    "from_over_noise": low,
                    "to_over_noise": high,
                    "found": float(some["right"].mean()),
                    "effects": len(some),
                }
            )
    return pd.DataFrame(rows, columns=["from_over_noise", "to_over_noise", "found", "effects"])
