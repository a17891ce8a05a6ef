"""How much of an effect is left when the best of the catalogue's effects have had their share."""

import numpy as np

from pipeline.concealed.effects import CATALOGUE, place
from pipeline.concealed.motions import Motion
from pipeline.concealed.plant import Plant, respond
from pipeline.concealed.sizing import calibration_columns

VARIANTS = 3
SHARES = (0.03, 0.12, 0.4)
HELPERS = 2


def left_over(change: np.ndarray, plant: Plant, motion: Motion, rng: np.random.Generator) -> float:
    """rms of a change (n,) after a smooth curve and the best two of many catalogue effects.

    The effects are the plant's own, in random variants and sizes; their amplitudes are free.
    """
    simulated = plant.nominal.angle_deg(motion.pitch_deg)
    nuisance, _ = np.linalg.qr(calibration_columns(simulated, bends=True))
    columns = np.array(_library(plant, motion, rng)).T
    columns = columns - nuisance @ (nuisance.T @ columns)
    rest = change - nuisance @ (nuisance.T @ change)
    for _ in range(HELPERS):
        power = np.maximum(np.sum(columns**2, axis=0), 1e-12)
        best = int(np.argmax((columns.T @ rest) ** 2 / power))
        unit = columns[:, best] / np.sqrt(power[best])
        rest = rest - unit * (unit @ rest)
        columns = columns - np.outer(unit, unit @ columns)
    return float(np.sqrt(np.mean(rest**2)))


def _library(plant: Plant, motion: Motion, rng: np.random.Generator) -> list[np.ndarray]:
    """Changes of the angle by catalogue effects, (n,) each."""
    before = plant.nominal.angle_deg(motion.pitch_deg)
    changes = []
    for draw in CATALOGUE.values():
        for variant in range(VARIANTS):
            effect = draw(rng, motion, plant)
            size = effect.largest * (1.0 if effect.fixed else SHARES[variant])
            changes.append(respond(place(plant, effect, size), motion) - before)
    return [c for c in changes if np.abs(c).max() > 1e-6]
