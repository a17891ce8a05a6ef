"""What comes again after so many rows: noise forgets, physics may not."""

import numpy as np

LAGS, FEWEST = 20, 200
KNOWN, BY_CHANCE = 0.05, 4.0


def foretold_share(innovations: np.ndarray) -> tuple[bool, float]:
    """Whether innovations (n,) are foretold by those before them, and what share of their variance.

    By a regression on the LAGS before each (Yule, Phil. Trans. R. Soc. A 226 (1927) 267). Of
    independent ones it explains LAGS / n by chance, known to sqrt(2 LAGS) / n, which is taken off;
    the noise that whitened them may fit badly enough for a few hundredths.
    """
    count = len(innovations) - LAGS
    if count < FEWEST:
        return False, 0.0
    e = innovations - innovations.mean()
    before = np.lib.stride_tricks.sliding_window_view(e[:-1], LAGS)
    left = e[LAGS:] - before @ np.linalg.lstsq(before, e[LAGS:], rcond=None)[0]
    total = max(float(e[LAGS:] @ e[LAGS:]), 1e-300)
    share = 1.0 - float(left @ left) / total * count / (count - LAGS)
    return share > KNOWN + BY_CHANCE * np.sqrt(2.0 * LAGS) / count, max(share, 0.0)
