"""Commitments: a truth is sealed before the diagnosis, and proved unchanged when it is opened.

The commitment is the SHA-256 of a salt and the truth's canonical JSON; the salt, kept with the
truth, stops anyone from finding the truth by trying all of them.
"""

import hashlib
import json
import secrets
from typing import Any

from pipeline.errors import LoopgapError, refusal

Truth = dict[str, Any]


class SealError(LoopgapError):
    """A truth is not the one that was sealed."""


def canonical(truth: Truth) -> str:
    """JSON text that is the same for equal truths."""
    return json.dumps(truth, sort_keys=True, separators=(",", ":"), allow_nan=False)


def commitment(truth: Truth, salt: str) -> str:
    """Hexadecimal SHA-256 of salt and truth."""
    return hashlib.sha256(f"{salt}\n{canonical(truth)}".encode()).hexdigest()


def seal(truth: Truth) -> tuple[dict[str, Any], str]:
    """The sealed envelope (truth and salt, to be kept away) and its commitment (to be shown)."""
    salt = secrets.token_hex(16)
    return {"salt": salt, "truth": truth}, commitment(truth, salt)


def opened(name: str, envelope: dict[str, Any], promised: str) -> Truth:
    """The truth of an envelope; SealError if it isn't the one that was promised."""
    truth: Truth = envelope["truth"]
    found = commitment(truth, str(envelope["salt"]))
    if found != promised:
        raise SealError(
            refusal(f"truth of {name}", f"the sealed one, {promised[:12]}...", f"{found[:12]}...",
                    "Draw the benchmark anew: this truth was changed after it was sealed.")
        )  # fmt: skip
    return truth
