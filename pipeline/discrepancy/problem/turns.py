"""Angles that were recorded within one turn and leap by a whole one at its end."""

from dataclasses import replace

import numpy as np

from pipeline.physics.force_units import RADIAN
from pipeline.recording import Recording

LEAP, WHOLE, MOSTLY = 0.5, 0.2, 0.9


def unwrapped(recording: Recording) -> tuple[Recording, dict[str, int]]:
    """The recording with angles that go on over whole turns, and by channel how often they leapt.

    Measurements and simulations are looked at. A measurement that leapt comes to within half a turn
    of its simulation (median), for a whole turn is no calibration error.
    """
    samples, leapt = recording.samples, {}
    for channel in (*recording.with_role("simulation"), *recording.with_role("measurement")):
        if channel.unit not in RADIAN:
            continue
        turn = 2.0 * np.pi * RADIAN[channel.unit]
        values = recording.values(channel.name)
        count = leaps_of(values, turn)
        if not count:
            continue
        going_on = _going_on(values, turn)
        simulation = recording.simulation_of(channel.name)
        if simulation is not None:
            off = going_on - samples[simulation.name].to_numpy(float)
            going_on = going_on - turn * np.round(np.nanmedian(off) / turn)
        leapt[channel.name] = count
        samples = samples.assign(**{channel.name: going_on})
    return replace(recording, samples=samples), leapt


def leaps_of(values: np.ndarray, turn: float) -> int:
    """How often values (n,), NaN where unknown, leap by a whole turn [their unit].

    None where other changes of more than half a turn are as usual: that is a fast motion, or a
    sensor that is mistaken.
    """
    change = np.abs(np.diff(values[np.isfinite(values)]))
    large = change[change > LEAP * turn]
    whole = np.abs(large - turn) < WHOLE * turn
    return int(whole.sum()) if len(large) and whole.mean() >= MOSTLY else 0


def _going_on(values: np.ndarray, turn: float) -> np.ndarray:
    out, known = values.copy(), np.isfinite(values)
    out[known] = np.unwrap(values[known], period=turn)
    return out
