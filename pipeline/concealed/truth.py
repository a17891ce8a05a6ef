"""What a case hides, as plain JSON: names, comparable quantities, rivals, noise, clean angles."""

from typing import Any

import numpy as np

from pipeline.concealed.cases import Realised
from pipeline.concealed.comparable import comparable
from pipeline.concealed.draw import Case
from pipeline.concealed.motions import HELD_OUT
from pipeline.concealed.outside import OUTSIDE
from pipeline.concealed.rivals import IMPLIED, rivals_of
from pipeline.concealed.seal import Truth
from pipeline.concealed.sizing import calibration_columns


def truth_of(case: Case, realised: Realised) -> Truth:
    """The truth of a case; all that scoring needs."""
    return {
        "case": case.name,
        "kind": case.kind,
        "excitation": case.excitation,
        "known": [h.effect.name for h in case.known],
        "effects": [_effect(case, index) for index in range(len(case.hidden))],
        "noise": _noise(case, realised),
        "calibration": {"gain": 1.0 + case.gain_error, "offset": case.offset_deg},
        "tolerance_shape_deg": case.tolerance_shape_deg,
        "bend_deg": list(case.bend_deg),
        "homing_deg": case.homing_deg,
        "mistaken_rows": np.flatnonzero(realised.mistaken).tolist(),
        "clean_deg": np.round(realised.clean_deg, 4).tolist(),
    }


def _effect(case: Case, index: int) -> dict[str, Any]:
    hidden = case.hidden[index]
    name = hidden.effect.name
    return {
        "name": name,
        "in_catalogue": name not in OUTSIDE,
        "alone_over_noise": round(hidden.alone_over_noise, 4),
        "beside_over_noise": round(hidden.beside_over_noise, 4),
        "size": hidden.size,
        "settings": dict(hidden.effect.settings),
        "scaled": list(hidden.effect.scaled),
        "comparable": comparable(case, hidden),
        "rivals": rivals_of(case, hidden),
        "implied": sorted(IMPLIED.get(name, ())),
    }


def _noise(case: Case, realised: Realised) -> dict[str, float]:
    """Sizes as drawn, and the rms that the blur really has on recorded and held-out rows."""
    blur = realised.measured_deg - realised.clean_deg
    good = np.isfinite(blur) & ~realised.mistaken
    held = good & np.isin(case.motion.cycle, HELD_OUT)
    return {
        "sigma_deg": case.noise.sigma_deg,
        "correlation": case.noise.correlation,
        "jitter_deg": case.noise.jitter_deg,
        "walk_deg": case.noise.walk_deg,
        "total_deg": float(np.hypot(case.noise.sigma_deg, case.noise.jitter_deg)),
        "rms_deg": float(np.sqrt(np.mean(blur[good] ** 2))),
        "held_out_rms_deg": float(np.sqrt(np.mean(blur[held] ** 2))),
        "later_floor_deg": _later_floor(case, realised, np.where(good & ~held, blur, np.nan)),
    }


def _later_floor(case: Case, realised: Realised, blur: np.ndarray) -> float:
    """rms error on the later cycles of one who knows all but calibration [deg].

    Calibration (with a curve where one is declared) is fitted to the training cycles, where
    `blur` (n,) is the noise; else it is NaN.
    """
    columns = calibration_columns(realised.simulated_deg, case.tolerance_shape_deg > 0)
    known = np.isfinite(blur)
    fitted = columns @ np.linalg.lstsq(columns[known], blur[known], rcond=None)[0]
    return float(np.sqrt(np.mean(fitted[~realised.recorded] ** 2)))
