"""What may act in the balance at the joint or after it: there what holds the joint answers it not.

The same physics has both forms (`Term.outside`). They differ only beside a term that holds the
joint (`Term.holds`); elsewhere they are one idea and share one place in a search.
"""

from dataclasses import replace

from pipeline.discrepancy.fitting.fit import Fit, evaluate, improve

Key = frozenset[tuple[str, str]]


def held(fit: Fit) -> bool:
    """Whether a term of the fit holds the joint."""
    return any(p.term.holds for p in fit.pieces)


def with_others_outside(fit: Fit) -> Fit | None:
    """The fit with terms after the balance that are in it; None where none can be.

    What holds the joint besides answers to them no more.
    """
    others = [p.term.outside() for p in fit.pieces]
    if not any(others):
        return None
    pieces = [
        p if other is None else replace(p, term=other)
        for p, other in zip(fit.pieces, others, strict=True)
    ]
    moved = evaluate(fit.ground, pieces)
    return improve(moved, 3) if any(p.term.in_balance for p in pieces) else moved


def freed(fit: Fit) -> Fit:
    """The fit; where something holds the joint, with other terms after the balance, if better."""
    moved = with_others_outside(fit) if held(fit) else None
    return fit if moved is None else min(fit, improve(moved), key=lambda f: f.cost)


def kin_of(fit: Fit) -> Key:
    """The names of a fit's terms, forms that differ only beside what loads the joint as one."""
    return frozenset((p.term.name, p.term.kin) for p in fit.pieces)
