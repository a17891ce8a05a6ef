"""What a mapping may say, whatever the files hold."""

from pipeline.config_importing import ImportedChannel, ImportedTable, ImportingConfig
from pipeline.errors import UsageError, refusal
from pipeline.foreign import resample
from pipeline.recording import CONTEXT_COLUMNS, ROLES, Channel, check_channels

FILLS = ("previous", "linear")
CONTEXT = "context"


def check_mapping(config: ImportingConfig) -> tuple[Channel, ...]:
    """The recording's channels; UsageError where the mapping itself can't be right."""
    if not any(table.channels for table in config.tables.values()):
        raise UsageError(
            refusal("importing.tables", "a table with `channels`", "none", "Choose a mapping, "
                    "importing=NAME (those there are: conf/importing), or write your own.")
        )  # fmt: skip
    channels = []
    for number, (name, table) in enumerate(config.tables.items()):
        _check_resampling(name, table, first=number == 0)
        for channel, mapping in table.channels.items():
            _check_channel(f"importing.tables.{name}.channels.{channel}", channel, mapping)
            if mapping.role != CONTEXT:
                channels.append(Channel(channel, mapping.role, mapping.unit, mapping.of))
    check_channels("importing", channels)
    return tuple(channels)


def _check_resampling(name: str, table: ImportedTable, first: bool) -> None:
    expected = (
        "nothing: the first table sets the times"
        if first
        else (f"one of {', '.join(resample.RULES)}")
    )
    fits = table.resample is None if first else table.resample in resample.RULES
    if not fits:
        raise UsageError(
            refusal(f"importing.tables.{name}.resample", expected, str(table.resample),
                    "Say how its samples come to the times of the first table." if not first
                    else "Take it out, or put another table first.")
        )  # fmt: skip
    if table.frames is not None and table.resample == "linear":
        raise UsageError(
            refusal(f"importing.tables.{name}.resample", "previous or nearest for images",
                    table.resample, "Choose one.")
        )  # fmt: skip


def _check_channel(where: str, name: str, mapping: ImportedChannel) -> None:
    if mapping.role not in (*ROLES, CONTEXT):
        raise UsageError(
            refusal(f"{where}.role", f"one of {', '.join((*ROLES, CONTEXT))}", repr(mapping.role),
                    "Choose one.")
        )  # fmt: skip
    if (mapping.role == CONTEXT) != (name in CONTEXT_COLUMNS[1:]) or name == "time_s":
        raise UsageError(
            refusal(where, f"the role {CONTEXT!r} for `cycle` and `step` and for these alone",
                    f"{mapping.role!r}", "Time has its own key, `time`; give others another role.")
        )  # fmt: skip
    if not mapping.unit and mapping.role != CONTEXT:
        raise UsageError(refusal(f"{where}.unit", "a unit", "none", "Say in what unit it is."))
    if abs(mapping.sign) != 1:
        raise UsageError(refusal(f"{where}.sign", "1 or -1", f"{mapping.sign}", "Choose one."))
    if mapping.fill is not None and (mapping.fill not in FILLS or mapping.role != "command"):
        raise UsageError(
            refusal(f"{where}.fill", f"one of {', '.join(FILLS)}, for a command",
                    f"{mapping.fill!r} for a {mapping.role}",
                    "Only commands are filled; a measurement may be empty.")
        )  # fmt: skip
