"""How far an effect stands out, and the size at which it stands out as far as wanted."""

import numpy as np

from pipeline.concealed.effects import Effect, place
from pipeline.concealed.motions import Motion
from pipeline.concealed.plant import Plant, respond

SEARCH_STEPS = 12
CLOSE = 0.03


def stands_out(change: np.ndarray, simulated: np.ndarray, bends: bool = False) -> float:
    """rms of a change of the angle after calibration is refitted; both (n,).

    Calibration is gain and offset, and a curve to the fourth power where `bends`.
    """
    columns = calibration_columns(simulated, bends)
    rest = change - columns @ np.linalg.lstsq(columns, change, rcond=None)[0]
    return float(np.sqrt(np.mean(rest**2)))


def calibration_columns(simulated: np.ndarray, bends: bool) -> np.ndarray:
    """What calibration can explain: 1, x and, where `bends`, x^2 to x^4; shape (n, 2 or 5)."""
    unit = simulated / np.abs(simulated).max()
    return np.vander(unit, 5 if bends else 2, increasing=True)


def reach_deg(effect: Effect, size: float, plant: Plant, motion: Motion, bends: bool) -> float:
    """rms by which the plant with this effect alone stands out from the nominal curve."""
    simulated = plant.nominal.angle_deg(motion.pitch_deg)
    return stands_out(respond(place(plant, effect, size), motion) - simulated, simulated, bends)


def sized(effect: Effect, plant: Plant, motion: Motion, least_deg: float, most_deg: float,
          bends: bool, rng: np.random.Generator) -> tuple[float, float] | None:  # fmt: skip
    """A size and its rms, the latter drawn evenly in its logarithm between the bounds.

    The upper bound gives way to what the effect can reach; None where not even the lower is.
    An effect without a size of its own (whole frames) is taken or refused as it is.
    """
    top = reach_deg(effect, effect.largest, plant, motion, bends)
    if top < least_deg:
        return None
    if effect.fixed:
        return (effect.largest, top) if top <= most_deg else None
    wanted = float(np.exp(rng.uniform(np.log(least_deg), np.log(min(most_deg, top)))))
    low, high = 0.0, effect.largest
    size, found = effect.largest * (wanted / top), top
    for _ in range(SEARCH_STEPS):
        found = reach_deg(effect, size, plant, motion, bends)
        if abs(found / wanted - 1.0) < CLOSE:
            return size, found
        low, high = (size, high) if found < wanted else (low, size)
        guess = size * wanted / max(found, 1e-9)
        size = guess if low < guess < high else 0.5 * (low + high)
    return size, found
