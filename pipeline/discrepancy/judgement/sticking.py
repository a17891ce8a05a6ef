"""What stays where it is while it should go on, and leaps after: it sticks and slips."""

import numpy as np

ROUNDS, FIRST_SHARE, NARROWEST = 40, 0.3, 0.05
LEAST_SHARE, FEWEST = 0.05, 50


def sticks(errors: np.ndarray, ways: np.ndarray) -> tuple[float, float]:
    """How much likelier (log) steps are those of what sticks than of noise, and how many stuck [1].

    ways: how far each step should go, > 0, (k,). errors: how much farther it went, (k,). What
    sticks goes nowhere: some errors lie about minus their way, the others anywhere. Noise whose
    distribution has no side has as many about plus their way (mirrored), or about none. Two normal
    distributions each (EM: Dempster, Laird and Rubin, J. R. Stat. Soc. B 39 (1977) 1). 0.0 of
    FEWEST steps or fewer.
    """
    if len(errors) <= FEWEST:
        return 0.0, 0.0
    stuck, share = likelihood(errors, -ways)
    others = [likelihood(errors, places)[0] for places in (ways, 0.0 * ways)]
    return (stuck - max(others), share) if share > LEAST_SHARE else (0.0, share)


def likelihood(errors: np.ndarray, places: np.ndarray) -> tuple[float, float]:
    """Log likelihood of errors (k,), some of them about places (k,), and which share these are."""
    spread = max(float(errors.std()), 1e-300)
    share, near = FIRST_SHARE, 0.5 * spread
    middle, wide = float(np.mean(errors) - FIRST_SHARE * np.mean(places)), spread
    off, density = errors - places, np.ones(len(errors))
    for _ in range(ROUNDS):
        at_place = share * np.exp(-0.5 * (off / near) ** 2) / near
        density = at_place + (1.0 - share) * np.exp(-0.5 * ((errors - middle) / wide) ** 2) / wide
        belongs = at_place / np.maximum(density, 1e-300)
        here, there = max(float(belongs.sum()), 1e-9), max(float((1.0 - belongs).sum()), 1e-9)
        share = here / len(errors)
        near = max(np.sqrt(float(belongs @ off**2) / here), NARROWEST * spread)
        middle = float((1.0 - belongs) @ errors) / there
        around = float((1.0 - belongs) @ (errors - middle) ** 2) / there
        wide = max(np.sqrt(around), NARROWEST * spread)
    return float(np.log(np.maximum(density, 1e-300)).sum()), share
