"""The catalogue: every term by its name."""

from pipeline.errors import refusal
from pipeline.physics.backlash import Backlash
from pipeline.physics.friction import Friction
from pipeline.physics.term import Term, TermError

TERMS: dict[str, tuple[Term, ...]] = {
    "backlash": (Backlash(),),
    "friction": (Friction(),),
}


def term(name: str, form: str = "") -> Term:
    """The term of a name (and form); TermError names those that exist."""
    for candidate in TERMS.get(name, ()):
        if candidate.form == form or not form:
            return candidate
    raise TermError(
        refusal("physics", f"one of {', '.join(TERMS)}", repr(name), "Name one of these.")
    )
