"""Quantities of a hidden effect that a diagnosis can be held to, whatever its own formulas."""

from pipeline.concealed.draw import Case, Hidden

Quantity = dict[str, str | float]


def comparable(case: Case, hidden: Hidden) -> list[Quantity]:
    """Names (as diagnosis parameters have them), values and units; empty where none compares."""
    settings, size = hidden.effect.settings, hidden.size
    number = {k: float(v) for k, v in settings.items() if not isinstance(v, str)}
    gain = 1.0 + case.gain_error
    match hidden.effect.name:
        case "backlash":
            return [_quantity("width", size, "deg")]
        case "lost_steps":
            when = float(case.motion.time_s[int(number["slip_sample"])])
            return [_quantity("jump", number["slip_deg"] * size, "deg"),
                    _quantity("time", when, "s")]  # fmt: skip
        case "transmission_ripple":
            return [_quantity("period", number["mesh_period_deg"], "deg"),
                    _quantity("amplitude", size, "deg")]  # fmt: skip
        case "slack" if number["straightening_deg"] == 0.0:
            return [_quantity("width", 2.0 * size, "deg")]
        case "creep" if "second_dashpot_s" not in number:
            slower = _free_to_held(size, case.nominal.gain)
            return [_quantity("time_constant", number["dashpot_s"] * slower, "s")]
        case "coupling" if number["other_lever_even"] == 0.0:
            return [_quantity("gain", case.nominal.gain * gain * size, "deg/deg")]
        case "frame_lag" if "stale_s" in number:
            return [_quantity("lag", size, "s")]
        case "drift" if settings["wander_kind"] == "linear":
            return [_quantity("total", number["wander_deg"] * size * gain, "deg")]
        case "contact":
            return [_quantity("angle", number["pad_side"] * number["pad_deg"], "deg")]
    return []


def _quantity(name: str, value: float, unit: str) -> Quantity:
    return {"name": name, "value": float(value), "unit": unit}


def _free_to_held(share: float, gain: float) -> float:
    """How much slower the joint creeps than its dashpot relaxes when held still: (k + b) / k.

    Springs of stiffness k = 2 wires / gain hold the joint; its branch has b = share * 2 wires.
    """
    return 1.0 + share * gain
