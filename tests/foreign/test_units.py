import math

import pytest

from pipeline.errors import UsageError
from pipeline.foreign.units import factor


@pytest.mark.parametrize(
    ("from_unit", "unit", "expected"),
    [
        ("rad", "deg", 180 / math.pi), ("deg", "rad", math.pi / 180), ("turn", "deg", 360.0),
        ("mm", "m", 1e-3), ("um", "mm", 1e-3), ("m", "um", 1e6), ("kN", "N", 1e3),
        ("mN", "N", 1e-3), ("ms", "s", 1e-3), ("mV", "V", 1e-3), ("rpm", "deg/s", 6.0),
        ("furlong", "furlong", 1.0),
    ],
)  # fmt: skip
def test_conversions(from_unit, unit, expected):
    assert factor("here", from_unit, unit, None) == pytest.approx(expected, rel=1e-14)


def test_counts_take_a_scale_and_a_scale_multiplies_a_conversion():
    assert factor("here", "count", "deg", 360 / 65536) == 360 / 65536
    assert factor("here", "mm", "m", 2.0) == pytest.approx(2e-3)


@pytest.mark.parametrize(
    ("from_unit", "unit", "words"),
    [
        ("rad", "mm", r"a unit that converts to 'mm'; found 'rad' \(angle\), where 'mm' is "
                      r"\(length\).*`scale` in mm per rad"),
        ("count", "deg", r"'count' \(not in the table\).*`scale` in deg per count"),
        ("Nm", "N", "torque"),
    ],
)  # fmt: skip
def test_units_that_measure_different_things_need_a_scale(from_unit, unit, words):
    with pytest.raises(UsageError, match=words):
        factor("here", from_unit, unit, None)
