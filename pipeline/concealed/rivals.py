"""Which names these data can't tell apart: the other names that a diagnosis may state with reason."""

from pipeline.concealed.draw import BENDS, Case, Hidden

IMPLIED = {"tension_loss": frozenset({"backlash"})}
ALWAYS = (BENDS,)
PLAIN = (
    frozenset({"friction", "creep"}),
    frozenset({"backlash", "frame_lag"}),
)


def rivals_of(case: Case, hidden: Hidden) -> list[str]:
    """Catalogue names that can't be told from this effect in this case."""
    groups = ALWAYS + (PLAIN if case.excitation == "plain" else ())
    name = hidden.effect.name
    found = {other for group in groups if name in group for other in group} - {name}
    return sorted(found)
