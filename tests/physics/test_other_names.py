"""Names that no motion tells from a term's own, or where it comes to little else."""

import numpy as np
import pytest

from pipeline.physics.catalogue import term
from pipeline.physics.term import Surroundings

AROUND = Surroundings(drive_span=100.0, angle_span=70.0)


@pytest.mark.parametrize(
    ("name", "form", "values", "others"),
    [
        ("creep", "one", [0.6, 9.0], ("response_lag",)),
        ("creep", "one", [0.4, 9.0], ()),
        ("creep", "two", [0.4, 9.0, 0.4, 90.0], ()),
        ("creep", "wire", [0.8, 9.0, 0.3, 0.0], ("response_lag",)),
        ("creep", "yielding wire", [0.6, 9.0, 0.0, 0.0, 0.5], ()),
        ("friction", "symmetric", [5.0, 0.6, 1.0], ("backlash",)),
        ("friction", "symmetric", [5.0, 0.7, 1.0], ()),
    ],
)
def test_what_comes_late_for_the_most_part_may_lag_and_sharp_friction_may_be_play(
    name: str, form: str, values: list[float], others: tuple[str, ...]
) -> None:
    assert term(name, form).other_names(np.array(values), AROUND) == others


@pytest.mark.parametrize(("apart", "bends"), [(0.0, True), (1.0, True), (2.0, False)])
def test_what_returns_where_it_left_is_a_bend_and_no_snap(apart: float, bends: bool) -> None:
    values = np.array([2.0, 10.0, apart, 3.0])
    assert term("friction", "snapping").slight(values, AROUND) == bends
