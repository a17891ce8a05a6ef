"""What foretells the rows after a recording: the explanation, refitted to all that was measured."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from pipeline.discrepancy.fitting.charge import complexity
from pipeline.discrepancy.fitting.fit import Fit, evaluate, improve
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.fitting.moments import moments, moments_of, moved, settle_moments
from pipeline.discrepancy.fitting.reform import reformed
from pipeline.discrepancy.judgement.rivals import predicted_by
from pipeline.discrepancy.judgement.slipped_again import slipped_again
from pipeline.discrepancy.model.intervals import moment_interval, undated
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.counted import INCREDIBLE, set_aside, settled_rows
from pipeline.discrepancy.search.elsewhere import differing
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.weighing import Choice, names
from pipeline.physics.catalogue import with_richer
from pipeline.physics.term import Term

COARSE = 8


def likeliest(explanation: Explanation, choice: Choice) -> Choice:
    """The likeliest of the choices that differ from one in slow terms alone.

    A zero that may as well wander by chance is not named; it goes on as it most likely does.
    """
    quiet = names(choice) - choice.fit.slow
    alike = [c for c in explanation.choices if names(c) - c.fit.slow == quiet]
    return min([choice, *alike], key=lambda c: c.score)


def refitted(problem: Problem, explanation: Explanation, choice: Choice) -> Choice:
    """A choice fitted to the held-out rows too, with the terms and noise that were chosen.

    For rows after the recording alone: what is said of its own rows has seen no held-out one.
    Held-out rows that stand off are left out, but not those between which a slip lies: now they
    tell when it was. Slips that are named may go on in them, see `slipped_again`. problem: its rows
    as a fit takes them, all of them.
    """
    fit, prior = choice.fit, explanation.prior
    known = replace(problem, train=problem.train | problem.heldout)
    ground = ground_of(known, fit.ground.noise, problem.train & settled_rows(problem, prior))
    again = None
    if problem.by_row(fit.pieces):
        answer = predicted_by(problem, choice)
        again = slipped_again(problem, choice, answer)
    pieces = fit.pieces if again is None else (*fit.pieces, again.piece)
    predicted = evaluate(ground, pieces).predicted
    off = known.measured - predicted
    noise = fit.ground.noise
    odd = set_aside(known, predicted, prior)
    odd |= np.abs(off) > INCREDIBLE * np.hypot(noise.deviation, noise.jitter)
    odd &= ~undated(fit, known.motion.time_s)
    used = known.train & settled_rows(known, prior) & ~odd
    whole = dated(evaluate(replace(ground, used=used), pieces), fit)
    return replace(choice, fit=in_course(settle_moments(improve(whole)), explanation.search.terms))


def in_course(fit: Fit, terms: Iterable[Term]) -> Fit:
    """The fit with each term that evolves in the course that suits its rows best.

    The training rows alone chose it before, and what they hardly tell apart parts after them.
    """
    for i, piece in enumerate(fit.pieces):
        if piece.term.evolves:
            forms = differing(with_richer(t for t in terms if t.name == piece.term.name), fit)
            others = (reformed(fit, i, t) for t in forms if t.evolves and t.form != piece.term.form)
            fit = min([fit, *others], key=lambda f: f.cost + complexity(f))
    return fit


def dated(fit: Fit, earlier: Fit) -> Fit:
    """The fit with each slip near the likeliest of the moments that an earlier fit left open."""
    times = moments(fit)
    for i, piece in enumerate(earlier.pieces):
        for j in moments_of(earlier, piece):
            low, high = moment_interval(earlier, i, j)
            open_s = times[(times > low) & (times < high)][::COARSE]
            trials = [moved(fit, i, j, t) for t in open_s]
            fit = min([fit, *trials], key=lambda trial: trial.cost)
    return fit
