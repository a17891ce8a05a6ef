"""The part of a nested file that holds the samples."""

from collections.abc import Mapping

from pipeline.errors import UsageError, refusal
from pipeline.foreign.table import listed, suggestion


def below(where: str, content: object, root: str | None) -> object:
    """What `content` holds at the dotted path `root`; UsageError lists what is there."""
    for key in root.split(".") if root else []:
        names = [str(name) for name in content] if isinstance(content, Mapping) else []
        if not isinstance(content, Mapping) or key not in content:
            raise UsageError(
                refusal(f"{where}, reading.root={root}", f"{key!r}", listed(names),
                        suggestion(key, names) + "Correct `reading.root`.")
            )  # fmt: skip
        content = content[key]
    return content
