"""Composing configuration without doing so twice; the jobs of a sweep in milliseconds.

Hydra composes a job's configuration from all its files again, twice a job (once to check it). The
files depend on the choices of groups alone (`compensation/step_rule=newton`); values
(`selection.k=4`) are set on what they give. So here the files are read once for each combination
of choices in a process, and the values are set on a copy, by Hydra's own functions.
"""

import copy
from functools import cache

import hydra._internal.hydra as hydra_entry
from hydra._internal.config_loader_impl import ConfigLoaderImpl, get_overrides_dirname
from hydra.core.object_type import ObjectType
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import Override
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf

from pipeline.config import CONF

SEARCH_PATH = "hydra.searchpath"
_HYDRAS_MODE = hydra_entry.Hydra.get_mode
_COMPOSED: dict[tuple[str | None, ...], DictConfig] = {}


class QuickLoader(ConfigLoaderImpl):
    """Hydra's loader; the configuration of a sweep's job comes out the same, sooner."""

    def load_sweep_config(
        self, master_config: DictConfig, sweep_overrides: list[str]
    ) -> DictConfig:
        """A job's configuration: the choices' files, then its values in their order."""
        lines = [*master_config.hydra.overrides.hydra, *sweep_overrides]
        parsed = [_parsed(line) for line in lines]
        if any(o.package is not None or o.key_or_group == SEARCH_PATH for o in parsed):
            return super().load_sweep_config(master_config, sweep_overrides)
        choices = [o for o in parsed if self.repository.group_exists(o.key_or_group)]
        config = copy.deepcopy(self._composed(master_config, choices))
        self._apply_overrides_to_config([o for o in parsed if o not in choices], config)
        task = [o for o in parsed if not o.is_hydra_override()]
        config.hydra.overrides.task = [o.input_line for o in task]
        config.hydra.overrides.hydra = [o.input_line for o in parsed if o.is_hydra_override()]
        naming = config.hydra.job.config.override_dirname
        config.hydra.job.override_dirname = get_overrides_dirname(
            overrides=task,
            kv_sep=naming.kv_sep,
            item_sep=naming.item_sep,
            exclude_keys=naming.exclude_keys,
        )
        OmegaConf.copy_cache(from_config=master_config, to_config=config)
        return config

    def get_group_options(
        self, group_name: str, results_filter: ObjectType | None = ObjectType.CONFIG,
        config_name: str | None = None, overrides: list[str] | None = None,
    ) -> list[str]:  # fmt: skip
        """The choices of a group; a schema that they are checked by is none."""
        if config_name is None and not overrides:  # Hydra would copy its repository for each group
            found = self.repository.get_group_options(group_name, results_filter)
        else:
            found = super().get_group_options(group_name, results_filter, config_name, overrides)
        return [option for option in found if not option.startswith("schema_")]

    def _composed(self, master_config: DictConfig, choices: list[Override]) -> DictConfig:
        name = master_config.hydra.job.config_name
        lines = [override.input_line or "" for override in choices]
        key = (name, *lines)
        if key not in _COMPOSED:
            _COMPOSED[key] = self.load_configuration(name, lines, RunMode.RUN)
        return _COMPOSED[key]


def install() -> None:
    """Let Hydra use the quick loader from now on, in this process and in those of its launchers.

    To learn whether a sweep is asked for, Hydra composes everything once more: now only where the
    command line or files from elsewhere may tell it.
    """
    hydra_entry.ConfigLoaderImpl = QuickLoader  # type: ignore[misc]
    hydra_entry.Hydra.get_mode = _mode  # type: ignore[method-assign]


def _mode(self: hydra_entry.Hydra, config_name: str | None, overrides: list[str]) -> RunMode | None:
    """The mode that configuration sets; None where only `-m` tells it: no file of ours sets one."""
    places = {str(place.path) for place in self.config_loader.get_search_path().get_path()}
    elsewhere = bool(places - {"pkg://hydra.conf", str(CONF), "structured://"})
    told = any(key in line for line in overrides for key in ("hydra.mode", SEARCH_PATH))
    if elsewhere or told or config_name != "config":
        return _HYDRAS_MODE(self, config_name, overrides)
    return None


@cache
def _parsed(line: str) -> Override:
    return OverridesParser.create().parse_override(line)
