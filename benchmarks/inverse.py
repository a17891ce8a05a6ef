"""The inverse search against scipy.optimize.brentq for each target: python benchmarks/inverse.py

One thread, 400 targets, tolerance 1e-6 deg, K = 9, best of seven rounds in turn. brentq searches
the same rising branch between the same bounds; in a second row it searches the mixture's own mean,
which is what a user without the branch would do. The branch's own cost is shown apart.
"""

import numpy as np
from scipy.optimize import brentq
from threadpoolctl import threadpool_limits
from timing import best_s, pitch_recording

from pipeline.config import (
    ArmijoConfig,
    BarzilaiBorweinConfig,
    CompensationConfig,
    ConstantConfig,
    DiminishingConfig,
    NewtonConfig,
    TrainingConfig,
)
from pipeline.control.inverse import Solution, State, directions_of, follow, loop_branches
from pipeline.control.trial import trial_path
from pipeline.models.loop_model import MODELS, LoopModel

TARGETS = 400
RULES = (ArmijoConfig, BarzilaiBorweinConfig, ConstantConfig, DiminishingConfig, NewtonConfig)


def main() -> None:
    k = dict.fromkeys(MODELS, 9)
    model = LoopModel.fit(pitch_recording(), "pitch", range(6), k, TrainingConfig(n_init=3), seed=0)
    targets = [float(target) for target in trial_path(TARGETS, 38.0)]
    directions = directions_of(targets, State())
    branches = loop_branches(model)
    low, high = model.cw.range_deg

    def brent_on_branch() -> list[float]:
        return [
            brentq(lambda q, t=t, b=branches[d]: b.at(q)[0] - t, low, high, xtol=1e-7)
            for t, d in zip(targets, directions, strict=True)
        ]

    def brent_on_mixture() -> list[float]:
        mixtures = {1: model.cw, -1: model.ccw}
        return [
            brentq(lambda q, t=t, m=mixtures[d]: m.predict(q)[0][0] - t, low, high, xtol=1e-7)
            for t, d in zip(targets, directions, strict=True)
        ]

    configs = {rule().name: CompensationConfig(step_rule=rule()) for rule in RULES}
    with threadpool_limits(limits=1):
        times = best_s(
            {name: lambda c=c: follow(branches, targets, c) for name, c in configs.items()}
            | {"brentq, branch": brent_on_branch, "brentq, mixture": brent_on_mixture}
            | {"(making the two branches)": lambda: loop_branches(model)}
        )
    reference = brent_on_branch()
    print(
        f"{'search':26} {'us/target':>10} {'ratio':>7} {'steps':>6} {'max':>4}  converged, differs"
    )
    for name, time_s in times.items():
        ratio = times["brentq, branch"] / time_s
        line = f"{name:26} {1e6 * time_s / TARGETS:10.2f} {ratio:6.2f}x"
        if name in configs:
            line += summary(follow(branches, targets, configs[name]), reference)
        print(line)
    changed = max(branch.changed_deg for branch in branches.values())
    print(f"the branches differ from the mixtures' means by at most {changed:.3f} deg")


def summary(solutions: list[Solution], reference: list[float]) -> str:
    steps = np.array([s.iterations for s in solutions])
    converged = sum(s.status == "converged" for s in solutions)
    commands = np.array([s.command_deg for s in solutions])
    differs = np.abs(commands - np.array(reference)).max()
    return f" {steps.mean():6.1f} {steps.max():4d}  {converged}/{len(solutions)}, {differs:.0e} deg"


if __name__ == "__main__":
    main()
