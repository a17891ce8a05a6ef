"""Which jobs a sweep was to run: what Hydra made of `multirun.yaml`, in its own order."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hydra._internal.core_plugins.basic_sweeper import BasicSweeper
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.errors import HydraException
from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException
from yaml import YAMLError

PLAN_FILE = "multirun.yaml"
UNREADABLE = (OSError, YAMLError, OmegaConfBaseException, ValueError)


@dataclass(frozen=True)
class Plan:
    """`jobs`: the overrides of each job, in the order of their numbers.

    `experiment` is the study that was asked for, if any.
    """

    jobs: list[list[str]]
    experiment: str | None


def read_plan(sweep: Path) -> Plan | None:
    """The plan that a multirun left; None where there is none, or where it needs more than itself.

    (A sweep over `glob(*)` depends on the configuration of the machine that it was begun on.)
    """
    try:
        hydra = read_yaml(sweep / PLAN_FILE)["hydra"]
        params = [f"{k}={v}" for k, v in (hydra["sweeper"]["params"] or {}).items()]
        parsed = OverridesParser.create().parse_overrides([*params, *hydra["overrides"]["task"]])
        (jobs,) = BasicSweeper.split_arguments(parsed, max_batch_size=None)
        experiment = hydra["runtime"]["choices"].get("experiment")
    except (*UNREADABLE, HydraException, KeyError, TypeError):
        return None
    return Plan(jobs, experiment)


def config_options(sweep: Path) -> list[str]:
    """`--config-dir DIR` where the sweep was begun with one of its user's own."""
    try:
        sources = read_yaml(sweep / PLAN_FILE)["hydra"]["runtime"]["config_sources"]
        own = [source["path"] for source in sources if source["provider"] == "command-line"]
    except (*UNREADABLE, KeyError, TypeError):
        return []
    return [part for folder in own for part in ("--config-dir", str(folder))]


def override(key: str, value: object) -> str:
    """`key=value` as Hydra's grammar reads it: quoted where there is more than plain letters."""
    text = str(value)
    if re.fullmatch(r"[\w./:%+@?|-]+( +[\w./:%+@?|-]+)*", text, re.ASCII):
        return f"{key}={text}"
    quoted = re.sub(r"(\\*)'", r"\1\1\\'", text)
    return f"{key}='{quoted}'"


def read_yaml(file: Path) -> Any:
    """What a YAML file says, as plain lists and mappings; one of `UNREADABLE` if it can't."""
    return OmegaConf.to_container(OmegaConf.load(file), resolve=False)


def settings(overrides: list[str]) -> dict[str, str]:
    """Overrides by key, as `job.json` has them."""
    return dict(o.lstrip("+~").split("=", 1) for o in overrides if "=" in o)
