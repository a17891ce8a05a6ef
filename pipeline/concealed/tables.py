"""The benchmark's tables, from the rows of its cases."""

import numpy as np
import pandas as pd

NOTHING = "(nothing)"
PROBABILITY_BINS = (0.0, 0.5, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0)
SIZE_BINS = (0.0, 0.1, 0.2, 0.35, 0.7, 1.0, 1.5, 2.5, 5.0, np.inf)
NEIGHBOURS = 20
FOUND_SHARE = 0.9


def confusion_table(terms: pd.DataFrame) -> pd.DataFrame:
    """How often each hidden effect (row) was given each name (column); counts."""
    paired = _pair_up(terms)
    return pd.crosstab(paired["hidden"], paired["named"])


def _pair_up(terms: pd.DataFrame) -> pd.DataFrame:
    """In a case with one missed effect and one wrong name, the name was given to that effect."""
    rows = [terms.iloc[:0]]
    for _, some in terms.groupby("case", sort=False):
        wrong = some[some["hidden"] == NOTHING]
        missed = some[some["named"] == NOTHING]
        rows.append(some[(some["hidden"] != NOTHING) & (some["named"] != NOTHING)])
        pairs = min(len(wrong), len(missed))
        taken = missed.iloc[:pairs].assign(named=wrong["named"].to_numpy()[:pairs])
        rows += [taken, wrong.iloc[pairs:], missed.iloc[pairs:]]
    return pd.concat(rows)


def calibration_table(terms: pd.DataFrame) -> pd.DataFrame:
    """Stated probability against the share that was right, in bins of the probability."""
    stated = terms[terms["named"] != NOTHING]
    bins = pd.cut(stated["probability"], list(PROBABILITY_BINS), include_lowest=True)
    table = stated.groupby(bins, observed=True).agg(
        stated=("probability", "mean"), right=("right", "mean"), terms=("right", "size")
    )
    return table.reset_index(names="probability")


def smallest_table(terms: pd.DataFrame) -> pd.DataFrame:
    """Share of hidden catalogue effects that were found, by their size over the noise."""
    hidden = terms[(terms["hidden"] != NOTHING) & (terms["kind"] != "outside")]
    bins = pd.cut(hidden["over_noise"], list(SIZE_BINS), right=False)
    table = hidden.groupby(bins, observed=True).agg(
        found=("right", "mean"), effects=("right", "size")
    )
    return table.reset_index(names="over_noise")


def smallest_found(terms: pd.DataFrame) -> float:
    """Size over the noise from which on nine in ten effects of the like size were found.

    Like sizes are the nearest `NEIGHBOURS` of the cases with one effect; NaN with fewer.
    """
    single = terms["kind"].isin(("one", "small")) & (terms["hidden"] != NOTHING)
    hidden = terms[single].sort_values("over_noise")
    if len(hidden) < NEIGHBOURS:
        return float("nan")
    found = hidden["right"].astype(float).rolling(NEIGHBOURS).mean().to_numpy()
    enough = (found >= FOUND_SHARE) | np.isnan(found)
    last_bad = int(np.flatnonzero(~enough)[-1]) if not enough.all() else NEIGHBOURS - 2
    if last_bad == len(hidden) - 1:
        return float("nan")
    index = last_bad + 1 - NEIGHBOURS // 2
    return float(hidden["over_noise"].iloc[index])


def effect_table(terms: pd.DataFrame) -> pd.DataFrame:
    """Share of each hidden effect that was found, by excitation, and how many there were."""
    hidden = terms[(terms["hidden"] != NOTHING) & ~terms["kind"].isin(("outside", "small"))]
    return (
        hidden.groupby(["hidden", "excitation"])["right"].agg(["mean", "size"])
        .rename(columns={"mean": "found", "size": "effects"}).reset_index()
    )  # fmt: skip
