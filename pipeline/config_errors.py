"""Say of a configuration error which key is meant and what it may be."""

import dataclasses
import re
import typing

from omegaconf import DictConfig, OmegaConf

from pipeline.config import EXTRA_STAGES, STAGES, STEP_RULES, Config, StepRuleConfig
from pipeline.errors import UsageError, did_you_mean


def explain(error: BaseException) -> str:
    """One message for a Hydra or OmegaConf error: the key, what was found, what it may be."""
    chain = list(_causes(error))
    text = str(chain[-1]).strip() or str(error).strip()
    key = _key_of(chain)
    override = getattr(error, "override", None)
    where = f"configuration, {override!r}" if override else "configuration"
    message = f"{where}: {_without_innards(str(error).strip())}"
    if override in (*STAGES, *EXTRA_STAGES):
        return f"{where}: expected key=value; found a stage. Say stages=[{override}]."
    if "LexerNoViableAltException" in message:
        message += "\nQuote a value with letters such as ä twice: 'key=\"value\"'."
    option = re.search(r"Could not find '([\w/]+)/([^/']+)'\n\nAvailable options", str(error))
    if option:
        there = re.findall(r"^\t(?!schema_)(\S+)$", str(error), re.MULTILINE)
        message = f"{message}\n{did_you_mean(option.group(2), there)}".rstrip()
    extra = re.search(r"Could not find 'hydra/launcher/(?:submitit_)?(slurm|ray)'", message)
    if extra:
        message += "\nIt comes with an extra; say in the folder of the project: "
        message += f"pip install '.[{extra.group(1)}]'."
    if str(text).splitlines()[0] not in message:
        message += f"\n{text}"
    return message if key is None else f"{message}\n{_what_it_may_be(Config, key.split('.'))}"


def refuse_added_keys(config: DictConfig, before: str = "") -> None:
    """`+key=value` adds a key beside the schema's, which nothing would ever read."""
    schema = OmegaConf.get_type(config)
    for name in config:
        here = f"{before}.{name!s}" if before else str(name)
        if dataclasses.is_dataclass(schema) and name not in _fields(typing.cast(type, schema)):
            raise UsageError(f"configuration: {_neighbours(before, str(name), schema)}")
        if not OmegaConf.is_missing(config, name) and OmegaConf.is_dict(config._get_node(name)):
            refuse_added_keys(config[name], here)


def _without_innards(text: str) -> str:
    """Hydra lists schemas beside the choices, and where it looked for them: of use to nobody."""
    shown = re.sub(r"\nConfig search path:(\n\t.*)*", "", text)
    return "\n".join(line for line in shown.splitlines() if not line.strip().startswith("schema_"))


def _causes(error: BaseException) -> typing.Iterator[BaseException]:
    cause: BaseException | None = error
    while cause is not None:
        yield cause
        cause = cause.__cause__


def _key_of(chain: list[BaseException]) -> str | None:
    for error in reversed(chain):
        key = getattr(error, "full_key", None)
        if key:
            return str(key)
        found = re.search(r"full_key: (\S+)|override '([\w./]+)", str(error))
        if found:
            return found.group(1) or found.group(2)
    return None


def _what_it_may_be(kind: object, names: list[str], before: str = "") -> str:
    """Sentence on a key, `names` below `before`: its type where it exists, else its neighbours."""
    values = typing.get_args(kind)[1] if typing.get_origin(kind) is dict else None
    if not names or not dataclasses.is_dataclass(values or kind):
        return f"{before} takes {_type_name(kind)}."
    name, *rest = names
    here = f"{before}.{name}" if before else name
    if values is not None:  # the name is the user's own
        return _what_it_may_be(values, rest, here)
    schema = typing.cast(type, kind)
    if name not in _fields(schema):
        return _neighbours(before, name, schema)
    return _what_it_may_be(_fields(schema)[name], rest, here)


def _neighbours(parent: str, wrong: str, schema: type) -> str:
    known = list(_fields(schema))
    where = f"under {parent!r}" if parent else "at the top"
    told = f"Key {wrong!r} is unknown {where}; it may be: {', '.join(known)}."
    return f"{told} {did_you_mean(wrong, known)}".rstrip()


def _fields(schema: type) -> dict[str, object]:
    hints = typing.get_type_hints(schema)
    names = {f.name: hints[f.name] for f in dataclasses.fields(schema)}
    if schema is StepRuleConfig:
        for rule in STEP_RULES.values():
            names |= _fields(rule)
    return names


def _type_name(kind: object) -> str:
    plain = {int: "a whole number", float: "a number", str: "text", bool: "true or false"}
    if isinstance(kind, type) and kind in plain:
        return plain[kind]
    arguments = typing.get_args(kind)
    if typing.get_origin(kind) is list:
        return f"a list, each {_type_name(arguments[0])}"
    if typing.get_origin(kind) is dict:
        return f"a mapping of names, each to {_type_name(arguments[1])}"
    if type(None) in arguments:
        return f"{_type_name(next(a for a in arguments if a is not type(None)))} or null"
    if dataclasses.is_dataclass(kind):
        return f"the keys {', '.join(_fields(typing.cast(type, kind)))}"
    return str(kind)
