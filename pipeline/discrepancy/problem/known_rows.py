"""Which rows of a measurement count, and which of them are held out."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from pipeline.config import HeldoutConfig
from pipeline.discrepancy.problem.driven import DiagnosisError
from pipeline.discrepancy.problem.holes import unsettled_rows
from pipeline.discrepancy.problem.stale import StaleSamples, hung_samples, stale_samples
from pipeline.errors import refusal
from pipeline.physics.motion import Motion

HELD_OUT_EVERY = 3
FEWEST_HELD_OUT = 0.05
FEWEST_SAMPLES = 40


class Counted(NamedTuple):
    """A measurement (n,), NaN where it does not count, and the masks (n,) that part its rows.

    withheld: the rows held out, also where nothing was measured. unsettled: how many come after a
    hole.
    """

    measured: np.ndarray
    train: np.ndarray
    heldout: np.ndarray
    withheld: np.ndarray
    unsettled: int


def fresh_samples(
    measurement: str, came: np.ndarray, simulated: np.ndarray
) -> tuple[np.ndarray, StaleSamples]:
    """A measurement as it came (n,), NaN where it is stale, and where it is so.

    Raises DiagnosisError where nothing is left, or neither it nor its simulation (n,) moves.
    """
    stale = stale_samples(came, simulated)
    if not stale.rows.any():
        stale = replace(stale, hung=hung_samples(came, simulated))
    measured = np.where(stale.rows | stale.hung, np.nan, came)
    known = np.isfinite(measured) & np.isfinite(simulated)
    refuse_unknown(measurement, known)
    refuse_still(measurement, measured[known], simulated[known])
    return measured, stale


def rows_that_count(
    config: HeldoutConfig,
    measurement: str,
    measured: np.ndarray,
    simulated: np.ndarray,
    motion: Motion,
) -> Counted:
    """The rows of a measurement (n,) that count, beside its simulation (n,), and their parts.

    Raises DiagnosisError where there are too few of them.
    """
    known = np.isfinite(measured) & np.isfinite(simulated)
    unsettled = unsettled_rows(motion.time_s, motion.drive) & known
    measured, known = np.where(unsettled, np.nan, measured), known & ~unsettled
    withheld = held_out_rows(config, motion, known)
    train, heldout = known & ~withheld, known & withheld
    refuse_unfit(config, measurement, train, heldout)
    return Counted(measured, train, heldout, withheld, int(unsettled.sum()))


def held_out_rows(config: HeldoutConfig, motion: Motion, known: np.ndarray) -> np.ndarray:
    """Rows (n,) that are held out, of those that are known (n,).

    Of every third cycle, the last third of the known rows where there are fewer than three cycles,
    or where hardly any or all of those rows were measured; or as the configuration says otherwise.
    """
    cycle = motion.cycle
    if config.kind == "after_s":
        rows: np.ndarray = motion.time_s - motion.time_s[0] > (config.after_s or 0.0)
        return rows
    numbers = np.unique(cycle)
    rows = np.isin(cycle, numbers[HELD_OUT_EVERY - 1 :: HELD_OUT_EVERY])
    few = len(numbers) < HELD_OUT_EVERY or not known.any()
    if few or not FEWEST_HELD_OUT <= np.mean(rows[known]) < 1.0 or config.kind == "last_third":
        rows = np.zeros(len(cycle), dtype=bool)
        have = np.flatnonzero(known)
        if len(have):
            rows[have[len(have) - max(len(have) // HELD_OUT_EVERY, 1)] :] = True
    return rows


def refuse_unfit(
    config: HeldoutConfig, measurement: str, train: np.ndarray, heldout: np.ndarray
) -> None:
    """Raise DiagnosisError where masks (n,) leave too few rows to fit on, or none as a proof."""
    refuse_unknown(measurement, train | heldout)
    if not heldout.any():
        raise DiagnosisError(
            refusal(
                f"measurement {measurement!r}",
                "measured rows that are held out",
                f"none ({config.kind}, after_s={config.after_s})",
                "Hold out other rows: see diagnosis.heldout.",
            )
        )
    if train.sum() < FEWEST_SAMPLES:
        raise DiagnosisError(
            refusal(
                f"measurement {measurement!r}",
                f"at least {FEWEST_SAMPLES} measured samples to fit on",
                f"{int(train.sum())} of {len(train)} rows (held-out cycles are not counted)",
                "Record more cycles or more steps.",
            )
        )


def refuse_unknown(measurement: str, known: np.ndarray) -> None:
    """Raise DiagnosisError where no row (n,) is both measured and simulated."""
    if not known.any():
        raise DiagnosisError(
            refusal(
                f"measurement {measurement!r}",
                "samples that were measured, and simulated",
                f"none in {len(known)} rows",
                "Measure it, or take the channel and its simulation out of recording.json.",
            )
        )


def refuse_still(measurement: str, measured: np.ndarray, simulated: np.ndarray) -> None:
    """Raise DiagnosisError where neither measurement nor simulation, (n,) each, ever moves."""
    if np.ptp(measured) == 0.0 and np.ptp(simulated) == 0.0:
        raise DiagnosisError(
            refusal(
                f"measurement {measurement!r}",
                "samples in which it or its simulation moves",
                f"{measured[0]:g} in all {len(measured)} rows, simulated as {simulated[0]:g}",
                "Record a motion, or check that the sensor was on.",
            )
        )
