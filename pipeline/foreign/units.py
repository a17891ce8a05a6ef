"""The units that an import converts, each with what it measures and its size."""

import math

from pipeline.errors import UsageError, refusal

UNITS: dict[str, tuple[str, float]] = {
    "deg": ("angle", math.pi / 180), "rad": ("angle", 1.0), "mrad": ("angle", 1e-3),
    "turn": ("angle", 2 * math.pi),
    "m": ("length", 1.0), "cm": ("length", 1e-2), "mm": ("length", 1e-3), "um": ("length", 1e-6),
    "in": ("length", 0.0254),
    "N": ("force", 1.0), "mN": ("force", 1e-3), "kN": ("force", 1e3),
    "Nm": ("torque", 1.0), "mNm": ("torque", 1e-3), "Nmm": ("torque", 1e-3),
    "s": ("time", 1.0), "ms": ("time", 1e-3), "us": ("time", 1e-6), "ns": ("time", 1e-9),
    "min": ("time", 60.0),
    "V": ("voltage", 1.0), "mV": ("voltage", 1e-3),
    "A": ("current", 1.0), "mA": ("current", 1e-3),
    "deg/s": ("angular velocity", math.pi / 180), "rad/s": ("angular velocity", 1.0),
    "rpm": ("angular velocity", math.pi / 30),
    "m/s": ("velocity", 1.0), "mm/s": ("velocity", 1e-3),
}  # fmt: skip


def factor(where: str, from_unit: str, unit: str, scale: float | None) -> float:
    """What a number in `from_unit` is multiplied by to be in `unit`.

    `scale` multiplies it further; between units that measure different things, or that are not in
    the table, it alone converts and has to be given. UsageError where it isn't.
    """
    if from_unit == unit:
        return 1.0 if scale is None else scale
    source, target = UNITS.get(from_unit), UNITS.get(unit)
    if source is not None and target is not None and source[0] == target[0]:
        return source[1] / target[1] * (1.0 if scale is None else scale)
    if scale is None:
        raise UsageError(
            refusal(where, f"a unit that converts to {unit!r}",
                    f"{from_unit!r}{_kind(from_unit)}, where {unit!r} is{_kind(unit)}",
                    f"Correct `from_unit` or `unit`, or give `scale` in {unit} per {from_unit}. "
                    f"Known: {', '.join(UNITS)}.")
        )  # fmt: skip
    return scale


def _kind(unit: str) -> str:
    return f" ({UNITS[unit][0]})" if unit in UNITS else " (not in the table)"
