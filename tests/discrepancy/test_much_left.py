"""Several names that leave much of a mismatch follow the shape of something else."""

import pytest

from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.judgement.verdict import leaves_much
from pipeline.discrepancy.noise.noise import NoiseModel
from tests.discrepancy.made import NOISE, chosen, explanation_of, posed, recorded


@pytest.mark.parametrize(
    ("pieces", "much"),
    [
        ({"backlash": [2.0]}, False),
        ({"backlash": [2.0], "gravity": [1e-6, 0.0]}, True),
        ({"backlash": [3.9], "gravity": [1e-6, 0.0]}, False),
    ],
    ids=["one name", "two that leave a quarter", "two that leave nothing"],
)
def test_much_is_what_one_name_might_leave_shared_among_all(pieces, much):
    problem = posed(recorded({"backlash": {"width": 4.0}}, gain=1.0, offset=0.0))
    ground = ground_of(problem, NoiseModel(white=NOISE), problem.train)
    choice = chosen(ground, 0.0, **pieces)
    assert leaves_much(explanation_of([chosen(ground, 0.0), choice]), choice) is much
