"""Numbers of a size that arithmetic on them, and squares of them, still tell apart."""

import numpy as np

from pipeline.discrepancy.problem.driven import DiagnosisError
from pipeline.errors import refusal
from pipeline.number_words import worded
from pipeline.recording import Recording

LARGEST, LEAST_SPAN, ROUNDED = 1e15, 1e-9, 1e-12
ROLES = ("command", "measurement", "simulation")


def refuse_other_scales(recording: Recording) -> None:
    """Raise DiagnosisError for a channel with a number beyond LARGEST or a span below LEAST_SPAN.

    A channel that stands still is judged elsewhere.
    """
    for channel in (c for role in ROLES for c in recording.with_role(role)):
        values = recording.values(channel.name)
        known = values[np.isfinite(values)]
        size = float(np.max(np.abs(known), initial=0.0))
        span = float(np.ptp(known)) if len(known) else 0.0
        if size <= LARGEST and (span <= ROUNDED * size or span >= LEAST_SPAN):
            continue
        found = f"{worded(size)}" if size > LARGEST else f"values that differ by {worded(span)}"
        raise DiagnosisError(
            refusal(
                f"channel {channel.name!r}",
                f"numbers up to {LARGEST:g} that differ by at least {LEAST_SPAN:g} {channel.unit}",
                found,
                "Convert it to a unit that suits it, or correct the row.",
            )
        )
