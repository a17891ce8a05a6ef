"""Errors that tell a user what was expected, what was found and what to do."""

import difflib
from collections.abc import Iterable


class LoopgapError(Exception):
    """The work could not be done (exit status 1)."""

    exit_status = 1


class UsageError(LoopgapError):
    """The program was asked for something that it can't take (exit status 2)."""

    exit_status = 2


class RecordingError(LoopgapError):
    """A recording is not as the format says."""


def refusal(where: str, expected: str, found: str, remedy: str) -> str:
    """One message with the four things that a user needs to mend bad input."""
    return f"{where}: expected {expected}; found {found}. {remedy}"


def did_you_mean(wanted: str, names: Iterable[str]) -> str:
    """`Did you mean 'x'? `: the name that was probably meant, whatever its case; "" if none was."""
    lower = {name.lower().strip(): name for name in names}
    close = difflib.get_close_matches(wanted.lower().strip(), list(lower), n=1)
    return f"Did you mean {lower[close[0]]!r}? " if close else ""
