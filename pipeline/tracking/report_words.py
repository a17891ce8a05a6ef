"""What a diagnosis says in sentences for people who have never seen diagnosis.json."""

import math
from collections.abc import Iterable

from pipeline.discrepancy.model.result import FOLLOWS, Diagnosis, NamedPhysics
from pipeline.number_words import LARGEST

LEAVES_OUT, TOO_MUCH = "leaves out", "has too much"

TITLES = {
    "no_mismatch": "Nothing left out",
    "explained": "Explained",
    "partly_explained": "Partly explained",
    "unknown_physics": "Unknown physics",
    "ambiguous": "More than one answer",
}
TONES = {
    "no_mismatch": "good",
    "explained": "good",
    "partly_explained": "open",
    "ambiguous": "open",
    "unknown_physics": "bad",
}
COORDINATES = {
    "command": "Command",
    "direction": "Direction of motion",
    "travel": "Travel since the last reversal",
    "dwell": "Dwell",
    "rate": "Rate",
    "image_position": "Position in the image",
    "time": "Time",
    "cycle": "Cycle",
    "single_frames": "Single frames",
}
PLACED = ("everywhere", "on", "at", "after")


def said(name: str) -> str:
    """A catalogue name as people say it."""
    return name.replace("_", " ")


def number(value: float) -> str:
    """At least three significant digits, an exponent where it must be; a dash for what is not."""
    if not math.isfinite(value):
        return "–"
    if value != 0.0 and not 1e-3 <= abs(value) < LARGEST:
        return f"{value:.2e}".replace("-", "−")
    digits = 0 if value == 0.0 else max(0, 2 - math.floor(math.log10(abs(value))))
    text = f"{value:.{digits}f}"
    return (text.rstrip("0").rstrip(".") if "." in text else text).replace("-", "−")


def percent(share: float) -> str:
    """`71 %`, `< 1 %`, `> 99 %`."""
    if 0.0 < share < 0.01:
        return "< 1 %"
    return "> 99 %" if 0.99 < share < 1.0 else f"{100.0 * share:.0f} %"


def chance(p_value: float) -> str:
    """A p-value in words."""
    if p_value < 1e-3:
        return "noise alone would look so in fewer than one recording in 1000"
    return f"noise alone would look so in {percent(p_value)} of recordings"


def coordinate(name: str) -> str:
    """A coordinate as people say it."""
    kind, _, channel = name.partition(":")
    if kind == "other_command":
        return f"Command of {said(channel.partition('_command')[0] or channel)}"
    return COORDINATES.get(kind, said(kind).capitalize())


def placed(where: str) -> str:
    """Where a rest shows, with its preposition: some bring their own."""
    return where if where.split()[0] in PLACED else f"in {where}"


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """The verdict in a sentence."""
    named, surplus = claims(diagnosis.physics), any(p.surplus for p in diagnosis.physics)
    where = diagnosis.unexplained.where
    rest = f" (it shows {placed(where)})" if where else ""
    if diagnosis.verdict == "explained":
        return f"The simulation {named}."
    if diagnosis.verdict == "partly_explained":
        more = f"{LEAVES_OUT} something more" if surplus else "something more"
        return f"The simulation {named}, and {more} that nothing in the catalogue explains{rest}."
    if diagnosis.verdict == "unknown_physics":
        return (
            f"The simulation leaves something out, and nothing in the catalogue explains it{rest}."
        )
    if diagnosis.verdict == "ambiguous":
        certain = claims(p for p in diagnosis.physics if not p.alternatives)
        either = [_open_claim(p) for p in diagnosis.physics if p.alternatives]
        first, *others = [*([certain] if certain else []), *either]
        if not surplus:
            others = [claim.removeprefix(f"{LEAVES_OUT} ") for claim in others]
        found = ", and ".join([first, *others])
        return f"The simulation {found}; this recording can't tell which."
    return (
        "The simulation leaves nothing out that this recording could show: "
        "what differs is noise and calibration."
    )


def claims(physics: Iterable[NamedPhysics]) -> str:
    """What a simulation leaves out, and of what it has too much, as a predicate."""
    said_of: dict[bool, list[str]] = {}
    for one in physics:
        said_of.setdefault(one.surplus, []).append(_with_site(one))
    verbs = {False: LEAVES_OUT, True: TOO_MUCH}
    return " and ".join(f"{verbs[much]} {listed(said_of[much])}" for much in sorted(said_of))


def _open_claim(physics: NamedPhysics) -> str:
    """The same of one that may be another, which the simulation would then leave out."""
    name, *others = _names(physics)
    if physics.surplus:
        return f"{TOO_MUCH} {name} or {LEAVES_OUT} {one_of(others)}"
    return f"{LEAVES_OUT} {one_of([name, *others])}"


def error_sentence(diagnosis: Diagnosis) -> str:
    """Before and after, on held-out cycles, against the noise."""
    unit, noise = diagnosis.unit, number(diagnosis.noise)
    before, after = (number(e.heldout_rmse) for e in (diagnosis.before, diagnosis.after))
    if not diagnosis.physics:
        followed = any(note.startswith(FOLLOWS) for note in diagnosis.notes)
        right = "that is followed" if followed else "gain and offset are right"
        return (
            f"On cycles that nothing was fitted to, the error is {before} {unit}, and {after} "
            f"{unit} once {right}; the noise is {noise} {unit}."
        )
    return (
        f"Corrected for that, the error on cycles that nothing was fitted to falls from "
        f"{before} to {after} {unit}; the noise is {noise} {unit}.{_rivals(diagnosis)}"
    )


def _rivals(diagnosis: Diagnosis) -> str:
    """What else each name may be, where the verdict's own sentence does not say it."""
    if diagnosis.verdict == "ambiguous":
        return ""
    open_names = [_names(physics) for physics in diagnosis.physics if physics.alternatives]
    return "".join(
        f" {sentence(name)} may also be {' or '.join(others)}." for name, *others in open_names
    )


def sentence(text: str) -> str:
    """The text with a capital in front."""
    return text[:1].upper() + text[1:]


def listed(words: Iterable[str]) -> str:
    """`a`, `a and b`, `a, b and c`."""
    found = list(words)
    if len(found) < 2:
        return "".join(found)
    return f"{', '.join(found[:-1])} and {found[-1]}"


def one_of(words: Iterable[str]) -> str:
    """`a or b`, `one of a, b or c`."""
    found = list(words)
    if len(found) < 3:
        return " or ".join(found)
    return f"one of {', '.join(found[:-1])} or {found[-1]}"


def _names(physics: NamedPhysics) -> list[str]:
    return [said(name) for name in (physics.name, *physics.alternatives)]


def _with_site(physics: NamedPhysics) -> str:
    return f"{said(physics.name)} ({physics.site})"
