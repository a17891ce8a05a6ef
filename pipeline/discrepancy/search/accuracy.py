"""What is smaller than the measurement's declared accuracy: calibration, and no name."""

from dataclasses import replace

import numpy as np

from pipeline.discrepancy.fitting.calibration import with_smooth_error
from pipeline.discrepancy.fitting.fit import evaluate
from pipeline.discrepancy.fitting.ground import Ground
from pipeline.discrepancy.noise.force_noise import LEAST_SPELL, spell_of
from pipeline.discrepancy.noise.learning import FINEST
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.search.choose import extended
from pipeline.discrepancy.search.foretold import error_ahead, parts_of
from pipeline.discrepancy.search.weighing import Choice, Search

BETTER, NEARLY = 0.9, 0.9


def within_accuracy(base: Choice, used: np.ndarray) -> bool:
    """Whether calibration alone leaves no more on used rows (n,) than the accuracy declared."""
    problem = base.fit.ground.problem
    left = (problem.measured - base.fit.predicted)[used]
    accuracy = problem.tolerance.accuracy
    return bool(accuracy > 0.0 and np.mean(left**2) <= accuracy**2)


def calibrated_alone(base: Choice, used: np.ndarray) -> Choice:
    """The choice without terms, calibrated where all that is left is the measurement's own error.

    That error is declared by its size, so rows weigh alike: under noise that walks, the offset
    would be where the zero was at first. And it may be the same wherever the mechanism is the same,
    as a camera's is: a smooth error of the size declared, over the simulated angle and the other
    commands, is taken in where it foretells later training rows better than gain and offset alone.
    """
    ground = base.fit.ground
    accuracy, others = ground.problem.tolerance.accuracy, ground.problem.motion.others
    smooth = replace(ground, nuisances=with_smooth_error(ground.nuisances, others, accuracy))
    rows = np.flatnonzero(used)
    choices = [replace(base, fit=evaluate(plainly(g, rows), ())) for g in (ground, smooth)]
    parts = parts_of(ground)
    return min(choices, key=lambda choice: error_ahead(choice, parts))


def evenly_calibrated(base: Choice, used: np.ndarray) -> Choice:
    """The choice without terms, with gain and offset at which it errs least on used rows (n,).

    For where all that is left is structured: it is no noise that walks, under which the offset
    would be where the zero was at first.
    """
    even = evaluate(plainly(base.fit.ground, np.flatnonzero(used)), ())
    return replace(base, fit=replace(base.fit, nuisance=even.nuisance))


def centred(choice: Choice, used: np.ndarray) -> Choice:
    """The choice with the offset at which used rows (n,) are on average neither above nor below.

    For a zero that wanders: under noise that walks, the offset would be where it was at first.
    """
    fit = choice.fit
    left = float(np.mean((fit.ground.problem.measured - fit.predicted)[used]))
    nuisance = fit.nuisance.copy()
    nuisance[1] += left
    return replace(choice, fit=replace(fit, nuisance=nuisance))


def hidden(search: Search, choice: Choice) -> tuple[str, float, float] | None:
    """The plainest of the terms that nearly best foretell what is left, None where none does.

    Its name, and the errors (RMS) [measurement's unit] on later training rows without and with it.
    """
    parts = parts_of(choice.fit.ground)
    without = error_ahead(choice, parts)
    children = [c for c in extended(search, choice) if not c.fit.slow]
    errors = [
        error_ahead(replace(choice, fit=evaluate(choice.fit.ground, c.fit.pieces)), parts)
        for c in children
    ]
    if not errors or min(errors) > BETTER * without:
        return None
    near = [k for k, error in enumerate(errors) if error < min(errors) / NEARLY]
    plainest = min(near, key=lambda k: (len(children[k].fit.pieces[-1].values), errors[k]))
    return children[plainest].fit.names[-1], without, errors[plainest]


def plainly(ground: Ground, rows: np.ndarray) -> Ground:
    """The ground with white noise of the size that its calibration leaves on rows (indices).

    Neighbouring rows that say the same count as one (`spell_of`).
    """
    white = ground.with_noise(NoiseModel(max(ground.problem.tolerance.accuracy, 1e-12)))
    left = (ground.problem.measured - evaluate(white, ()).predicted)[rows]
    size = max(float(np.sqrt(np.mean(left**2))), FINEST * ground.problem.around.angle_span)
    return ground.with_noise(NoiseModel(size, spell=max(spell_of(left, rows), LEAST_SPELL)))
