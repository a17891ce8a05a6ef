import numpy as np
import pytest
from scipy import stats

from pipeline.tracking.paired_tests import holm, p_value

DIFFERENCE = np.array([0.3, -0.1, 0.4, 0.2, 0.5, 0.1])


def test_uncorrected_tests_are_scipys() -> None:
    assert p_value(DIFFERENCE, "t", 0.5) == pytest.approx(stats.ttest_1samp(DIFFERENCE, 0).pvalue)
    assert p_value(DIFFERENCE, "wilcoxon", 0.5) == stats.wilcoxon(DIFFERENCE).pvalue


def test_the_corrected_test_is_that_of_nadeau_and_bengio() -> None:
    t = DIFFERENCE.mean() / np.sqrt((1 / 6 + 0.5) * DIFFERENCE.var(ddof=1))
    assert p_value(DIFFERENCE, "corrected_t", 0.5) == pytest.approx(2 * stats.t.sf(t, 5))
    assert p_value(DIFFERENCE, "corrected_t", 0.0) == pytest.approx(p_value(DIFFERENCE, "t", 0.5))


def test_the_corrected_test_is_not_too_sure_where_splits_overlap() -> None:
    """No true difference: nine cycles' errors, all 84 choices of three as test."""
    rng = np.random.default_rng(0)
    alarms = {"t": 0, "corrected_t": 0}
    for _ in range(60):
        cycles = rng.standard_normal(9)
        tests = [rng.choice(9, 3, replace=False) for _ in range(84)]
        difference = np.array([cycles[chosen].mean() for chosen in tests])
        for test in alarms:
            alarms[test] += p_value(difference, test, 0.5) < 0.05
    assert alarms["t"] > 30
    assert alarms["corrected_t"] < 9


@pytest.mark.parametrize("test", ["t", "corrected_t", "wilcoxon"])
def test_no_difference_and_too_few_pairs(test: str) -> None:
    assert p_value(np.zeros(5), test, 0.5) == 1.0
    assert np.isnan(p_value(np.array([1.0]), test, 0.5))


def test_holm_orders_and_never_decreases() -> None:
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.9, float("nan"), 0.8])[::2] == [1.0, 1.0]
