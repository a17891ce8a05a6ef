"""Friction as models of tendons have it: an operator on the drive, before what loads the joint."""

from collections.abc import Callable

import numpy as np
import pytest

from tests.discrepancy.made import diagnosed, followed, names, strokes, value_of

NOISE = 0.2


def turning(seed: int) -> np.ndarray:
    """A drive that turns at many angles, so that there are small loops within the large ones."""
    rng = np.random.default_rng(seed)
    return strokes(rng.uniform(8.0, 50.0, 50) * (-1.0) ** np.arange(50), 28)


def stops(drive: np.ndarray) -> np.ndarray:
    """The drive less Prandtl and Ishlinskii's stops of five thresholds, the first the firmest."""
    reaches = np.array([1.5, 3.5, 7.0, 11.0, 16.0])
    weights = np.array([0.30, 0.25, 0.20, 0.15, 0.10])
    out, stretch = drive.copy(), np.zeros(5)
    for k in range(1, len(drive)):
        stretch = np.clip(stretch + drive[k] - drive[k - 1], -reaches, reaches)
        out[k] -= weights @ stretch
    return out


def dahl(drive: np.ndarray) -> np.ndarray:
    """The drive less what Dahl's bristle holds, z' = u' (1 - z sgn(u') / 5), in fine steps."""
    out, held = drive.copy(), 0.0
    for k in range(1, len(drive)):
        step = (drive[k] - drive[k - 1]) / 200
        for _ in range(200):
            held += step * (1.0 - held / 5.0 * np.sign(step))
        out[k] -= held
    return out


def touched(angle: np.ndarray) -> np.ndarray:
    """Beyond 22 degrees a spring as stiff as the wire: half as far."""
    return np.minimum(angle, 22.0) + 0.5 * np.maximum(angle - 22.0, 0.0)


@pytest.mark.parametrize(("law", "width"), [(stops, 12.0), (dahl, 10.0)])
@pytest.mark.parametrize("contact", [False, True], ids=["alone", "contact"])
@pytest.mark.long
def test_it_is_friction_and_nothing_else(
    law: Callable[[np.ndarray], np.ndarray], width: float, contact: bool
) -> None:
    drive = turning(3)
    seen = touched(law(drive)) if contact else law(drive)
    noise = NOISE * np.random.default_rng(4).standard_normal(len(drive))
    found = diagnosed(followed(3.36 * np.arange(len(drive)), drive, seen + noise, 0.002))
    assert names(found) == {"friction", *(["contact"] if contact else [])}
    assert abs(value_of(found, "friction", "width").value - width) < 0.1 * width
    assert found.diagnoses[0].after.heldout_rmse < 1.1 * NOISE
