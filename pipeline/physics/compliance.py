"""Compliance: what gives way lowers the gain and hardens."""

import numpy as np

from pipeline.physics.term import Parameter, Surroundings, Term

STRETCH = Parameter("stretch", "", 0.0, 2.0, 0.02, 0.1, weak=True)


class Compliance(Term):
    """What the laws of the name share: they act in the balance of forces, beside stretch * theta.

    Each has a file of its own: a soft wire, a joint that stiffens, one wire softer than the other,
    stretch before the nominal curve.
    """

    name = "compliance"
    site = "transmission"
    in_balance = True
    group = "bend"
    lowers_gain = True
    means = "stretch: less motion than commanded, hardening"
    says = (
        "The wire stretches under the joint's stiffness, and hardens: it moves less than commanded."
    )


def centre(around: Surroundings) -> Parameter:
    """The angle at which a law that is not about the simulated zero has its middle."""
    half = 0.5 * around.angle_span
    middle, far = around.angle_low + half, 0.7 * half
    return Parameter("centre", around.angle_unit, middle - far, middle + far, middle, 0.1 * half)


def centres(around: Surroundings, shares: tuple[float, ...]) -> np.ndarray:
    """Middles to begin a search from, at shares of the half range off its middle; (k,)."""
    half = 0.5 * around.angle_span
    return np.array([around.angle_low + half + share * half for share in shares])
