"""The catalogue: every term by its name, in the forms that a search tries."""

from collections.abc import Iterable

from pipeline.errors import refusal
from pipeline.physics.backlash import Backlash
from pipeline.physics.camera_tilt import CameraTilt
from pipeline.physics.compliance import Compliance
from pipeline.physics.contact import Contact
from pipeline.physics.coupling import WITH_PLAY, Coupling
from pipeline.physics.creep import Creep
from pipeline.physics.drift import Drift
from pipeline.physics.end_stop import EndStop
from pipeline.physics.frame_lag import FrameLag
from pipeline.physics.friction import Friction
from pipeline.physics.gravity import Gravity
from pipeline.physics.lens_distortion import LensDistortion
from pipeline.physics.lost_steps import LostSteps
from pipeline.physics.marker_outliers import MarkerOutliers
from pipeline.physics.response_lag import ResponseLag
from pipeline.physics.slack import Slack
from pipeline.physics.tension_loss import TensionLoss
from pipeline.physics.term import Term, TermError
from pipeline.physics.transmission_ripple import TransmissionRipple

FORCE_TERMS = (
    "coulomb_friction",
    "viscous_friction",
    "stribeck_friction",
    "stiffness",
    "inertia",
)


def terms(other_commands: Iterable[str] = ()) -> tuple[Term, ...]:
    """Every term in the forms that a search begins with; a coupling for each other command."""
    return (
        LostSteps(),
        TransmissionRipple(),
        Backlash(),
        Friction(),
        Slack(),
        Compliance("wire"),
        Compliance("joint"),
        Creep(),
        TensionLoss(),
        Gravity(),
        Contact("upper"),
        Contact("lower"),
        EndStop("upper"),
        EndStop("lower"),
        *(Coupling(name) for name in other_commands),
        ResponseLag(),
        CameraTilt(),
        LensDistortion(),
        FrameLag("time"),
        MarkerOutliers(),
        Drift("linear"),
        Drift("cycle"),
        Drift("exponential"),
    )


def richer(term: Term) -> tuple[Term, ...]:
    """Forms of a term that hold more of the real thing; their first parameters are the same."""
    others: dict[tuple[str, str], tuple[Term, ...]] = {
        ("transmission_ripple", "first"): (TransmissionRipple("second"),),
        ("friction", "symmetric"): (Friction("asymmetric"),),
        ("creep", "one"): (Creep("two"),),
        ("tension_loss", "linear"): (TensionLoss("late"), TensionLoss("settling")),
        ("contact", "upper"): (Contact("upper unloading"),),
        ("contact", "lower"): (Contact("lower unloading"),),
        ("frame_lag", "time"): (FrameLag("frames"),),
        ("response_lag", "first"): (ResponseLag("second"),),
    }
    if isinstance(term, Coupling) and not term.plays:
        return (Coupling(f"{term.form}{WITH_PLAY}"),)
    return others.get((term.name, term.form), ())


def term(name: str, form: str = "", other_commands: Iterable[str] = ()) -> Term:
    """The term of a name (and form); TermError names those that exist."""
    found = [t for first in terms(other_commands) for t in (first, *richer(first))]
    found.append(Drift("wave"))
    for candidate in found:
        if candidate.name == name and form in ("", candidate.form):
            return candidate
    names = ", ".join(dict.fromkeys(t.name for t in found))
    raise TermError(refusal("physics", f"one of {names}", f"{name} {form}".strip(), "Name one."))
