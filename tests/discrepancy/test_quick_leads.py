"""What a quick look promises may be of sizes that no bounds allow: then others are looked for."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.fitting.charge import TERM_COST
from pipeline.discrepancy.fitting.effects import effects_of
from pipeline.discrepancy.fitting.fit import evaluate
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.search.choose import trials_beside
from pipeline.physics.catalogue import term
from pipeline.physics.play_operator import play
from tests.discrepancy.made import (
    ANGLE,
    NOISE,
    SIMULATED,
    changed,
    chosen,
    explanation_of,
    posed,
    recorded,
)

WIDTH, PULL = 3.0, 0.01


@pytest.mark.parametrize(("way", "found"), [(-1.0, "coupling"), (1.0, "backlash")])
def test_a_loop_that_runs_the_other_way_hides_no_other_name(way: float, found: str) -> None:
    plain = recorded({}, two_axes=True)
    simulated, yaw = plain.values(SIMULATED), plain.values("yaw_command_deg")
    loop = way * (play(simulated, 0.5 * WIDTH, simulated[0]) - simulated)
    noise = NOISE * np.random.default_rng(1).standard_normal(len(yaw))
    problem = posed(changed(plain, **{ANGLE: simulated + loop + PULL * yaw + noise}))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    terms = term("backlash"), term("coupling", "", ["yaw_command_deg"])
    search = explanation_of([chosen(ground, 0.0)]).search
    search = replace(search, terms=terms, effects=effects_of(problem, terms), quick=True)
    start = evaluate(ground, ())
    trials = trials_beside(search, start, terms, 1, TERM_COST)
    best = min(trials, key=lambda t: t.cost)
    assert best.names == (found,)
    assert best.cost < start.cost - TERM_COST
