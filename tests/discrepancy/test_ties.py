"""Ties: what could stand in the place of a name."""

from dataclasses import replace

import pytest

from pipeline.discrepancy.fitting.fit import Ground, ground_of
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.search.disguise import (
    plainly,
)
from pipeline.discrepancy.search.ties import standing
from tests.discrepancy.made import NOISE, chosen, posed, recorded


@pytest.fixture(scope="module")
def ground() -> Ground:
    problem = posed(recorded({"backlash": {"width": 2.0}}))
    return ground_of(problem, NoiseModel(NOISE), problem.train)


def test_two_names_that_two_others_could_stand_for_are_tied(ground):
    best = chosen(ground, 0.0, backlash=[2.0], drift=[0.5])
    far = chosen(ground, 30.0, friction=[2.0, 1.0, 0.7], drift=[0.5])
    both = chosen(ground, 5.0, friction=[2.0, 9.0, 0.7], lost_steps=[0.5, 900.0])
    found = standing("drift", best, [best, both, far], ground.problem)
    assert found.tied
    assert found.alternatives[:2] == ("friction", "lost_steps")
    assert not standing("drift", best, [best, replace(both, score=30.0)], ground.problem).tied


@pytest.mark.parametrize(("score", "said"), [(-3.0, True), (12.0, True), (16.0, False)])
def test_friction_sharper_than_a_step_may_be_what_looks_like_play(ground, score, said):
    play = chosen(ground, 0.0, backlash=[2.0])
    finer = chosen(ground, score, friction=[1.4, 0.08, 0.0])
    assert plainly(finer.fit) == ["backlash"]
    found = standing("backlash", play, [play, finer], ground.problem)
    assert ("friction" in found.alternatives) == said
    assert found.tied == (score < 0.0)
