"""What a diagnosis notes of a calibration that is far off: how far, and what it looks like."""

import numpy as np

from pipeline.discrepancy.fitting.calibration import FAR_OFF
from pipeline.number_words import worded

NEAR = 0.1
UNITS = {
    np.pi / 180.0: "a degree in radians",
    180.0 / np.pi: "a radian in degrees",
    1.0 / 360.0: "a degree in turns",
    360.0: "a turn in degrees",
    0.5 / np.pi: "a radian in turns",
    2.0 * np.pi: "a turn in radians",
    1e-3: "a thousandth",
    1e3: "a thousand",
    1.0 / 25.4: "a millimetre in inches",
    25.4: "an inch in millimetres",
}


def calibration_note(gain: float, offset: float, unit: str) -> str:
    """That gain and offset [unit] are far off, and which mix-up of units or sign would do that."""
    note = (
        f"The calibration (gain {worded(gain)}, offset {worded(offset)} {unit}) is more than "
        f"{FAR_OFF:.0f} tolerances off: check it, or declare `diagnosis.tolerance`."
    )
    if gain < 0.0:
        note += " The gain is negative, as where a sign was turned round."
    for ratio, words in UNITS.items():
        if abs(abs(gain) / ratio - 1.0) < NEAR:
            note += f" {worded(abs(gain))} is about {words}: units may be mixed."
    return note
