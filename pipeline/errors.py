"""Errors that tell a user what was expected, what was found and what to do."""


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
