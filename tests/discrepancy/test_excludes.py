"""Which terms can't stand beside each other."""

import pytest

from pipeline.discrepancy.search.choose import excludes
from pipeline.physics.catalogue import term


@pytest.mark.parametrize(
    ("one", "other", "apart"),
    [
        ("friction", "friction/driven", True),
        ("friction", "friction/snapping", False),
        ("friction/snapping bent", "friction/snapping", True),
        ("contact/upper", "contact/lower", False),
        ("gravity", "lens_distortion", True),
        ("backlash", "friction", False),
    ],
)
def test_one_name_stands_once_but_what_has_none_of_its_own_beside_it(one, other, apart):
    terms = [term(*spec.partition("/")[::2]) for spec in (one, other)]
    assert excludes(*terms) == excludes(*terms[::-1]) == apart
