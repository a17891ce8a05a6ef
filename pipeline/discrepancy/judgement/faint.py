"""Names too faint to be physics beside others: what they explain is the form of these."""

from dataclasses import replace

import numpy as np

from pipeline.discrepancy.judgement.structure import structure_of
from pipeline.discrepancy.judgement.verdict import mean_square, without
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.weighing import LEAST_GAIN, Choice, names

FAINTEST, SMALL = 0.25, 0.5
BESIDE = 2
ROUNDS = 3


def without_faint(explanation: Explanation) -> Explanation:
    """The explanation without choices that owe their place to faint names.

    Terms are plainer than what they stand for. What two of them leave of its form is small, but
    many samples make it sure, and a third name follows it. So a name beside two or more others
    that explains less than a quarter of the noise (RMS) goes, unless what is left without it is
    found to be structured. On 160 pairs of effects of other forms, 5 of 10 false names were as
    faint, and 2 of 280 true ones. So does one beside a single other name, unless it is slow: any
    real thing comes a little earlier or later than its term, and a camera errs alike in the same
    pose. So does a name beside others that earns nothing once these are fitted anew without it, or
    less than a search asks of a further one and explains less than half of the noise: what is as
    large as that and stands apart from the others earns far more. Nor may other names take the lead
    for less, of which there are more than of those that stay. Of a force, small parts are physics,
    too: there a name goes that earns less than a search asks of a further one, however large.
    """
    choices = explanation.choices
    firms: list[Choice] = []
    for _ in range(ROUNDS):
        fewer = firm(explanation, choices[0])
        if fewer is choices[0]:
            break
        firms.append(fewer)
        known = [*firms, *explanation.choices]
        kept = [c for c in known if not any(names(c) > names(f) for f in firms)]
        choices = sorted((charged(c, fewer) for c in kept), key=lambda c: c.score)
    firmer = replace(explanation, choices=choices)
    if choices is explanation.choices or structure_of(firmer, choices[0]).found:
        return explanation
    return firmer


def charged(choice: Choice, firmer: Choice) -> Choice:
    """A choice that has more names than a firm one: each has to earn what a search asks of one."""
    more = max(len(names(choice)) - len(names(firmer)), 0)
    return replace(choice, score=choice.score + more * LEAST_GAIN)


def firm(explanation: Explanation, choice: Choice) -> Choice:
    """The choice without its faintest name, if that is too faint, refitted and weighed."""
    search, ground = explanation.search, choice.fit.ground
    told, force = names(choice), explanation.problem.motion.kinetics is not None
    own = search.weighed(choice.fit, choice.place).score
    found: list[tuple[float, Choice]] = []
    for name in told if len(told) > 1 else ():
        trial = without(explanation, choice, name)
        grew = mean_square(explanation, trial) - mean_square(explanation, choice)
        size = float(np.sqrt(max(grew, 0.0))) / ground.noise.deviation
        fewer = search.weighed(trial.fit, choice.place)
        asked = LEAST_GAIN if size < SMALL or force else 0.0
        kept = force or (len(told) <= BESIDE and name in choice.fit.slow)
        faint = size < FAINTEST and not kept
        if faint or fewer.score - own < asked:
            found.append((size, fewer))
    return min(found, key=lambda f: f[0], default=(0.0, choice))[1]
