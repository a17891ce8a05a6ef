"""Quantities of a hidden effect that a diagnosis can be held to, whatever its own formulas.

Widths are full lost motions of the shaft's command, but friction's (and slack's `width_at_joint`)
are of the joint's angle. A knee (contact, stop) is where the straight part of the obstacle's torque
begins; it is left out where another effect moves the joint's zero or scale, and what a torque does
to the joint where another one softens its wires. So is what has no single value (rounded slack, two
time constants, friction that grows with the angle).
"""

from pipeline.concealed.draw import Case, Hidden
from pipeline.concealed.motions import MOVE_S, RECORDED_CYCLES
from pipeline.concealed.names import BENDS

Quantity = dict[str, str | float]
PLAIN_INTERVAL_S = MOVE_S + 3.0
MOVES_THE_FRAME = BENDS | {"transmission_ripple", "slack"}
SOFTENS = frozenset({"compliance", "slack"})
BY_TORQUE = frozenset({"friction", "creep", "response_lag", "coupling"})


def comparable(case: Case, hidden: Hidden) -> list[Quantity]:
    """Names (as in a diagnosis), values and units; empty where none compares."""
    size, name = hidden.size, hidden.effect.name
    number = {k: float(v) for k, v in hidden.effect.settings.items() if not isinstance(v, str)}
    gain = case.nominal.gain
    if name in BY_TORQUE and {h.effect.name for h in case.hidden} & SOFTENS:
        return []
    match name:
        case "backlash":
            return [_quantity("width", size, "deg")]
        case "tension_loss":
            return _wear(number, size)
        case "lost_steps":
            when = float(case.motion.time_s[int(number["slip_sample"])])
            jump = number["slip_deg"] * size
            return [_quantity("jump", jump, "deg"), _quantity("time", when, "s")]
        case "transmission_ripple":
            period = _quantity("period", number["mesh_period_deg"], "deg")
            return [period, _quantity("amplitude", size, "deg")]
        case "friction" if number["capstan"] == 0.0:
            return [_quantity("width", 2.0 * gain * size, "deg")]
        case "slack" if number["straightening_deg"] == 0.0:
            at_joint = _quantity("width_at_joint", 2.0 * gain * size, "deg")
            return [_quantity("width", 2.0 * size, "deg"), at_joint]
        case "creep" if "second_dashpot_s" not in number:
            slower = _free_to_held(size, gain)
            return [_quantity("time_constant", number["dashpot_s"] * slower, "s")]
        case "response_lag" if "swing_s" in number:
            damping = _quantity("damping", number["swing_damping"], "")
            return [_quantity("natural_frequency", 1.0 / size, "rad/s"), damping]
        case "response_lag":
            return [_quantity("time_constant", size, "s")]
        case "coupling":
            slope = gain * (1.0 + case.gain_error) * number["other_lever"] * size
            return [_quantity("gain", slope, "deg/deg")]
        case "frame_lag":
            return _lag(case, number, size)
        case "drift" if hidden.effect.settings["wander_kind"] == "linear":
            return _wander(case, number["wander_deg"] * size)
        case "marker_outliers":
            return [_quantity("share", case.noise.mistaken_share, "")]
        case "contact" | "end_stop":
            return _knee(case, hidden)
    return []


def _quantity(name: str, value: float, unit: str) -> Quantity:
    return {"name": name, "value": float(value), "unit": unit}


def _wear(number: dict[str, float], size: float) -> list[Quantity]:
    """Width at the start and growth per degree of travel, where it grows steadily."""
    if "wear_saturation_deg" in number or "wear_onset_deg" in number:
        return []
    growth = _quantity("growth", number["wear_per_deg"] * size, "deg/deg")
    width = number["clearance_deg"] * size
    return [growth, _quantity("width", width, "deg")] if width > 0 else [growth]


def _lag(case: Case, number: dict[str, float], size: float) -> list[Quantity]:
    """Lag in seconds or frames as it is; in both where all frames are equally far apart."""
    seconds, frames = number.get("stale_s", 0.0) * size, number.get("stale_frames", 0.0)
    if case.excitation == "plain":
        seconds, frames = (
            seconds + frames * PLAIN_INTERVAL_S,
            frames + seconds / PLAIN_INTERVAL_S,
        )
    both = (_quantity("lag", seconds, "s"), _quantity("lag", frames, "frames"))
    return [quantity for quantity in both if quantity["value"]]


def _wander(case: Case, wander_deg: float) -> list[Quantity]:
    recorded = case.motion.time_s[case.motion.cycle < RECORDED_CYCLES]
    total = wander_deg * (1.0 + case.gain_error)
    rate = total * 3600.0 / float(recorded[-1] - recorded[0])
    return [_quantity("total", total, "deg"), _quantity("rate", rate, "deg/h")]


def _knee(case: Case, hidden: Hidden) -> list[Quantity]:
    """Signed angle of the joint at which a one-sided obstacle begins."""
    if {h.effect.name for h in case.hidden} & MOVES_THE_FRAME:
        return []
    s = hidden.effect.settings
    if hidden.effect.name == "contact":
        angle = float(s["pad_deg"]) + 0.5 * float(s["pad_skin_deg"])
        return [_quantity("angle", float(s["pad_side"]) * angle, "deg")]
    if s["stop_sides"] == "high+low":
        return []
    angle = float(s["stop_reach_deg"]) - hidden.size + 0.5 * float(s["stop_skin_deg"])
    return [_quantity("angle", angle if s["stop_sides"] == "high" else -angle, "deg")]


def _free_to_held(share: float, gain: float) -> float:
    """How much slower the joint creeps than its dashpot relaxes when held still: (k + b) / k.

    Springs of stiffness k = 2 wires / gain hold the joint; its branch has b = share * 2 wires.
    """
    return 1.0 + share * gain
