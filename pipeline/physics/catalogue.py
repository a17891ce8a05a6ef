"""The catalogue: every term by its name, in the forms that a search tries."""

from collections.abc import Iterable

import numpy as np

from pipeline.errors import did_you_mean, refusal
from pipeline.physics.activated_creep import ActivatedCreep
from pipeline.physics.backlash import AHEAD, Backlash
from pipeline.physics.camera_tilt import CameraTilt
from pipeline.physics.capstan_friction import CapstanFriction
from pipeline.physics.coasting_play import CoastingPlay
from pipeline.physics.contact import LOSSY, SIDES, Contact
from pipeline.physics.coulomb_friction import CoulombFriction
from pipeline.physics.coupling import CUBIC, CURVED, OFFERED, Coupling
from pipeline.physics.creep import Creep
from pipeline.physics.delayed_motor import SLEWING, DelayedMotor
from pipeline.physics.driven_bank import DrivenBank
from pipeline.physics.driven_stretch import DrivenStretch
from pipeline.physics.early_frames import EarlyFrames
from pipeline.physics.end_stop import EndStop
from pipeline.physics.force_contact import ForceContact
from pipeline.physics.force_idle_way import ForceIdleWay
from pipeline.physics.force_lag import SWINGING, ForceLag
from pipeline.physics.force_lost_way import FREE, ForceLostWay
from pipeline.physics.force_play import ForcePlay
from pipeline.physics.force_slack import ASIDE, ForceSlack
from pipeline.physics.force_waves import ForceGravity, ForceRipple
from pipeline.physics.frame_lag import AT_DRIVE, OF_TIME, OLD, FrameLag
from pipeline.physics.friction import Friction
from pipeline.physics.gravity import SAGGING, Gravity
from pipeline.physics.held import STEP_AND_WAIT_S
from pipeline.physics.inertia import Inertia
from pipeline.physics.late_damper import LateDamper
from pipeline.physics.lens_distortion import LensDistortion
from pipeline.physics.loaded_wire import LoadedWire
from pipeline.physics.long_ripple import LongOffCentreRipple, LongRipple
from pipeline.physics.lost_steps import BEHIND, LostSteps
from pipeline.physics.marker_outliers import MarkerOutliers
from pipeline.physics.motion import Motion
from pipeline.physics.moved_frames import BLURRED, MOVED, MovedFrames
from pipeline.physics.moved_lag import moved_as
from pipeline.physics.off_centre_ripple import OffCentreRipple
from pipeline.physics.own_amount import OWN_AMOUNTS
from pipeline.physics.queued_frames import QueuedFrames
from pipeline.physics.recurring_slip import RecurringSlip
from pipeline.physics.response_lag import LOADED, RUNNING, ResponseLag
from pipeline.physics.rubbing_wire import RUBBING
from pipeline.physics.running_clock import RunningClock
from pipeline.physics.saw_ripple import SawRipple
from pipeline.physics.second_order_lag import SecondOrderLag, swinging_as
from pipeline.physics.settling_drift import SettlingDrift
from pipeline.physics.sheath_force import SheathForce
from pipeline.physics.sheath_line import SheathLine
from pipeline.physics.sheath_stretch import SheathStretch
from pipeline.physics.single_bump import SingleBump
from pipeline.physics.slack import Slack
from pipeline.physics.slanted_view import SlantedView
from pipeline.physics.slewing_motor import SlewingMotor
from pipeline.physics.slip_spectrum import AT_DRIVE as OF_DRIVE
from pipeline.physics.slip_spectrum import SlipSpectrum
from pipeline.physics.smooth_drift import SmoothDrift
from pipeline.physics.snapping_joint import SnappingJoint
from pipeline.physics.soft_wire import SoftWire
from pipeline.physics.softer_side import SofterSide
from pipeline.physics.steady_drift import SteadyDrift
from pipeline.physics.stiffening_joint import StiffeningJoint
from pipeline.physics.stiffness import Stiffness
from pipeline.physics.stribeck_friction import StribeckFriction
from pipeline.physics.swelling_ripple import SwellingRipple
from pipeline.physics.tension_loss import TensionLoss
from pipeline.physics.term import Surroundings, Term, TermError, Told
from pipeline.physics.top_speed import TopSpeed
from pipeline.physics.transmission_ripple import TransmissionRipple
from pipeline.physics.turned_gravity import SAGS, TURNED, TurnedGravity
from pipeline.physics.two_ripples import TwoRipples
from pipeline.physics.uneven_play import OPENING, UnevenPlay
from pipeline.physics.viscous_friction import ViscousFriction
from pipeline.physics.waving_drift import WavingDrift
from pipeline.physics.worn_play import WornPlay
from pipeline.physics.yielding_play import FOLLOWING, YieldingPlay
from pipeline.physics.yielding_wire import YieldingWire

RUBS = (0.3, 1.0)
ONE_WAVE = 0.6  # of the drive's range: a cubic beside its gain is hardly more than one wave
MET_FIRMLY = (1.0, 4.0)  # over the stiffness of the wire
BEND, BENDING, RISING = "bend", LensDistortion("second"), StiffeningJoint("progressive")
SHEATH_FORCES = tuple(SheathForce(f) for f in ("near", "far", "near falling", "far falling"))
PRESSED = tuple(
    CoulombFriction(form)
    for form in (
        "smoothed sprung",
        "smoothed dashpot",
        "bristle bent",
        "loaded",
        "spread loaded",
        "bristle bent loaded",
    )
)
SPECTRA = SlipSpectrum(), SlipSpectrum(OF_DRIVE)
DRIVEN, CARRYING = Friction("driven"), Friction("driven on")
SPRUNG, LATE_DAMPER = ViscousFriction("sprung"), LateDamper()
LATE = (ForceLag(), ForceLag(SWINGING), FrameLag(OLD))
WORN, FLANKS, QUEUE = WornPlay(), YieldingPlay(FOLLOWING), QueuedFrames()
UNEVENLY_WORN = WORN, UnevenPlay(OPENING)
LOSSY_SIDES = tuple(Contact(f"{side} {LOSSY}") for side in SIDES)
ODD = (
    SingleBump(), LongRipple(), LongOffCentreRipple(), YieldingWire(), LoadedWire(),
    ActivatedCreep(),
    SmoothDrift(), RunningClock(), EarlyFrames(), SnappingJoint(), *LOSSY_SIDES,
)  # fmt: skip
LAGS = (
    ResponseLag(), ResponseLag(RUNNING), SecondOrderLag("second"), SecondOrderLag("motor"),
    FrameLag(AT_DRIVE),
)  # fmt: skip
ONE_LATE = (ResponseLag(), Creep(), SecondOrderLag("second"), SecondOrderLag("motor"))
RECURRING = (RecurringSlip("every top"), RecurringSlip("every bottom"))
SKIPS = tuple(
    LostSteps(f"{times}{place}") for times in ("thrice", "fourfold") for place in ("", *BEHIND)
)
UNEVEN = (SofterSide("upper"), SofterSide("lower"))
OFF_CENTRE, TWO, SAW = OffCentreRipple(), TwoRipples(), SawRipple()
RIPPLES = {
    "first": (TWO, SwellingRipple(), OFF_CENTRE),
    "first afloat": (TWO, SwellingRipple(), OFF_CENTRE),
    "second": (TWO,),
    "second afloat": (TWO,),
    "third afloat": (TWO,),
    OFF_CENTRE.form: (SAW,),
}
"""What is no ripple of one period and its overtones, by the forms that it grows from."""
MANY_WAVES = ("both afloat", "all afloat")


def terms(other_commands: Iterable[str] = ()) -> tuple[Term, ...]:
    """Every term in the forms that a search begins with; a coupling for each other command.

    Friction that the drive bends is no step from friction at the joint where that is held.
    """
    return (
        LostSteps(),
        TransmissionRipple(),
        Backlash(),
        CoastingPlay(),
        Friction(),
        DRIVEN,
        CapstanFriction(),
        CapstanFriction("capstan begun"),
        CapstanFriction("pretensioned"),
        SheathStretch(),
        Slack("home"),
        Slack(),
        SoftWire("wire"),
        SoftWire("off home"),
        DrivenStretch(),
        StiffeningJoint(),
        Creep(),
        Creep("whole"),
        Creep("running"),
        TensionLoss(),
        TensionLoss("cycle"),
        Gravity(),
        Gravity(SAGGING),
        *(TurnedGravity(f"{name}{TURNED}{how}") for name in other_commands for how in ("", SAGS)),
        Contact("upper"),
        Contact("lower"),
        EndStop("upper"),
        EndStop("lower"),
        *(Coupling(f"{name}{how}") for name in other_commands for how in OFFERED),
        ResponseLag(),
        TopSpeed(),
        ResponseLag("whole"),
        ResponseLag(RUNNING),
        ResponseLag(LOADED),
        CameraTilt(),
        SlantedView(),
        LensDistortion(),
        FrameLag("time"),
        FrameLag(AT_DRIVE),
        FrameLag("frames"),
        FrameLag("held"),
        MovedFrames(),
        MarkerOutliers(),
        SteadyDrift("linear"),
        SteadyDrift("cycle"),
        SettlingDrift("settling cycle"),
        SettlingDrift(),
        WavingDrift(),
        *(LostSteps(f"once{place}") for place in BEHIND),
        Backlash(AHEAD),
        TensionLoss(f"linear {AHEAD}"),
        TensionLoss(f"cycle {AHEAD}"),
    )


BENDS = frozenset(t.name for t in terms() if t.group == BEND)


def force_terms() -> tuple[Term, ...]:
    """Terms that a force measured against a position can show, as `terms` does for a chain.

    A spring may harden from the start: beside a simulated one, that is all that is missing. Nor
    does a contact without pre-sliding come from one that has it: no step leads there.
    No drift that settles: settled at once, it is the offset that dry friction of two sizes needs.
    """
    return (
        Inertia(),
        CoulombFriction(),
        CoulombFriction("smoothed"),
        ViscousFriction(),
        ViscousFriction("square"),
        StribeckFriction(),
        StribeckFriction("smoothed"),
        Stiffness(),
        Stiffness("hardening"),
        ForceContact("upper buffer"),
        ForceContact("lower buffer"),
        ForceGravity(),
        ForceRipple(),
        SteadyDrift("linear"),
        SteadyDrift("cycle"),
        WavingDrift(),
    )


def further_force_terms() -> tuple[Term, ...]:
    """Terms that a force can show in fewer names than `force_terms`, which come near each of them.

    No step of a search leads to them from there: a spring that differs for its two sides is a
    spring and a contact, as a gas is, a power of the speed is dry and viscous friction.
    """
    return (
        ViscousFriction("power"),
        StribeckFriction("tustin"),
        StribeckFriction("smoothed tustin"),
        Stiffness("asymmetric"),
        Stiffness("gas"),
        ForcePlay(),
        ForceLostWay(),
        ForceLostWay(FREE),
        ForceIdleWay(),
        ForceSlack(),
        ForceSlack(ASIDE),
        SettlingDrift("settling"),
    )


FORCES = {t.name for t in force_terms()} - {t.name for t in terms([""])}
"""Names that show in a force measured against a position alone."""

MEANINGS = {t.name: t.means for t in (*terms([""]), *force_terms()) if t.means}
"""What each name of the catalogue is, in words that stand after a colon."""


def richer(term: Term) -> tuple[Term, ...]:
    """Forms of a term that hold more of the real thing, as it says itself.

    What bends one static curve is one family in any data: each of it may be the one that bends most
    freely, and that one what bends in the middle, lest something else is named for what its own
    form is too narrow to hold. A ripple may be one of RIPPLES.
    """
    if term.name == TransmissionRipple.name:
        return (*term.richer(), *RIPPLES.get(term.form, ()))
    if term.name == DRIVEN.name and term.form in ("symmetric", DRIVEN.form):
        return (DrivenBank(), *term.richer())
    if term.name == FrameLag.name and term.form in ("held", MOVED):
        return (*term.richer(), MovedFrames(BLURRED))
    if term.name == ResponseLag.name and term.form == SlewingMotor.form:
        return (DelayedMotor(SLEWING),)
    if term.group != BEND:
        return term.richer()
    return (*term.richer(), RISING if term.form == BENDING.form else BENDING)


def instead(term: Term, values: np.ndarray, motion: Motion, around: Surroundings) -> list[Told]:
    """What may stand in a term's place (`Term.instead`); for play a wire that rubs, too.

    As wide at the joint, it gives way over some of that or all: where another term stays behind as
    well, it has grown beside sharp corners to what no linear step leads away from. Nor does a step
    lead from what is late to the swing that is as late, of a motion that is sampled finely. Of a
    saw, waves of their own take the first few. A ripple of which the drive sees hardly more than a
    wave may bend as a joint or a lens does, in forms that no search begins with. A stop into which
    a motion goes only a little may be a contact that is soft, past where a search begins with one.
    """
    told = list(term.instead(values, motion, around))
    named = dict(zip((p.name for p in term.parameters(around)), values, strict=True))
    if term.name == Backlash.name and "width" in named:
        width = named["width"] * (around.angle_span / around.drive_span if term.before_curve else 1)
        told += [[(Friction(), np.array([width, part * width, 0.7]))] for part in RUBS]
    if named.get("period", 0.0) > ONE_WAVE * around.drive_span and term.periodic:
        told += [[(t, v)] for t in (RISING, BENDING) for v in t.candidates(motion, around)]
    if term.name == EndStop.name:
        told += [[(Contact(term.form), np.array([k, *values[:2]]))] for k in MET_FIRMLY]
    if term.form in MANY_WAVES:
        told += [[(SAW, values[:3])]]
    lag_s = named.get("lag" if term.form in OF_TIME else "time_constant", 0.0)
    if term.group == "lag" and lag_s > 0.0:
        told += swinging_as(lag_s) if around.dwell_s < STEP_AND_WAIT_S else []
        told += moved_as(lag_s, motion, around)
    return told


def term(name: str, form: str = "", other_commands: Iterable[str] = ()) -> Term:
    """The term of a name (and form); TermError names those that exist."""
    others = tuple(other_commands)
    found = with_richer((*terms(others), *ODD, *force_terms(), *further_force_terms()))
    found += (*SHEATH_FORCES, *PRESSED, SPRUNG, *LATE, WORN, QUEUE, *UNEVEN, *RECURRING, *SKIPS)
    found += (*RUBBING, CARRYING, LATE_DAMPER, FLANKS, *SPECTRA, SheathLine(), *OWN_AMOUNTS)
    found += [Coupling(f"{channel}{how}") for channel in others for how in (CUBIC, CURVED)]
    same = [t for t in found if t.name == name and form in ("", t.form)]
    if same:
        return next((t for t in same if t.form == form), same[0])
    forms = [f"{name}/{t.form}" if t.form else name for t in found if t.name == name]
    names = forms or list(dict.fromkeys(t.name for t in found))
    asked = f"{name}/{form}" if form else name
    meant = (asked, forms) if forms else (name, names)
    raise TermError(refusal("terms", f"one of {', '.join(names)}", repr(asked),
                            f"{did_you_mean(*meant)}Name one."))  # fmt: skip


def with_richer(some: Iterable[Term]) -> list[Term]:
    """Terms, and every form that one of their forms leads to, however many steps away."""
    found = {(t.name, t.form): t for t in some}
    new = list(found.values())
    while new:
        new = [r for t in new for r in richer(t) if (r.name, r.form) not in found]
        found |= {(t.name, t.form): t for t in new}
    return list(found.values())
