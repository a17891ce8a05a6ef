"""What is held until it has fallen behind far enough, and then lets go: no frames are late so."""

import numpy as np

from pipeline.discrepancy.problem.late import LateFrames

FEWEST = 10


def held_by_chance(
    late: LateFrames, measured: np.ndarray, predicted: np.ndarray, judged: np.ndarray
) -> float:
    """How likely late samples (n,) are by chance those to which the least way was left to go.

    A camera repeats an earlier pose by lot, wherever the joint is by then; what a controller's dead
    band or dry friction holds stays only as long as what is asked for is near, and comes at once
    when it is far. (Mann and Whitney, Ann. Math. Stat. 18 (1947) 50.) 1 where few samples are late.
    """
    ahead = np.abs(predicted - np.concatenate([[np.nan], measured[:-1]]))
    known = judged & np.isfinite(ahead) & np.isfinite(measured) & ~late.unsure
    held, gone = ahead[known & (late.late > 0)], ahead[known & (late.late <= 0)]
    if min(len(held), len(gone)) < FEWEST:
        return 1.0
    from scipy.stats import mannwhitneyu  # 0.3 s: only late frames wait for it

    return float(mannwhitneyu(held, gone, alternative="less").pvalue)
