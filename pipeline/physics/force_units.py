"""Which units measure a force and which a position."""

FORCES = frozenset({
    "N", "n", "kN", "kn", "mN", "mn", "MN", "uN", "daN", "kgf", "gf", "lbf",
    "Nm", "N m", "N*m", "N·m", "kNm", "kN m", "mNm", "mN m", "Nmm", "N mm",
    "V", "v", "mV", "A", "a", "mA", "ma",
})  # fmt: skip
LENGTHS = frozenset({"m", "mm", "cm", "um", "µm", "in", "inch"})
ANGLES = frozenset({"deg", "°", "rad", "mrad", "rev", "turn", "turns", "qc", "counts"})
LOWER_TORQUE = "nm"


def is_force(unit: str, position_unit: str) -> bool:
    """Whether a unit is one of force, torque, voltage or current; `nm` is against an angle."""
    return unit in FORCES or (unit == LOWER_TORQUE and position_unit in ANGLES)


def is_position(unit: str) -> bool:
    """Whether a unit is one of length or angle."""
    return unit in LENGTHS or unit in ANGLES
