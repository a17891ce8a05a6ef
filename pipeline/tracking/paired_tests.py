"""Whether two methods differ, judged from pairs: both on the same recording and split."""

from collections.abc import Sequence

import numpy as np
from scipy import stats

WORDS = {
    "corrected_t": "corrected resampled t-test (Nadeau & Bengio 2003)",
    "t": "paired t-test",
    "wilcoxon": "Wilcoxon signed-rank test",
}


def p_value(difference: np.ndarray, test: str, test_over_train: float) -> float:
    """Two-sided p-value of differences of shape (n,), one a pair, against none; NaN below 2 pairs.

    `t` and `wilcoxon` take the pairs for independent, which overlapping splits of one recording
    are not: their p-values come out too small there. `corrected_t` widens the variance of the mean
    from s^2 / n to s^2 (1/n + n_test / n_train) (Nadeau & Bengio 2003, eq. 9).
    """
    n = len(difference)
    if n < 2:
        return float("nan")
    if not difference.any():
        return 1.0
    if test == "wilcoxon":
        return float(stats.wilcoxon(difference).pvalue)
    widened = 1.0 / n + (test_over_train if test == "corrected_t" else 0.0)
    deviation = float(np.std(difference, ddof=1)) * np.sqrt(widened)
    if deviation == 0.0:
        return 0.0
    return float(2.0 * stats.t.sf(abs(float(difference.mean())) / deviation, df=n - 1))


def holm(p_values: Sequence[float]) -> list[float]:
    """p-values corrected for their number (Holm 1979); NaN stays, and doesn't count."""
    adjusted = list(p_values)
    order = sorted((p, i) for i, p in enumerate(p_values) if not np.isnan(p))
    highest = 0.0
    for rank, (p, i) in enumerate(order):
        highest = max(highest, min(1.0, (len(order) - rank) * p))
        adjusted[i] = highest
    return adjusted
