"""A sweep's job is composed as Hydra composes it."""

import pytest
from hydra._internal.config_loader_impl import ConfigLoaderImpl
from hydra._internal.utils import create_config_search_path
from hydra.core.config_store import ConfigStore
from hydra.core.utils import setup_globals
from hydra.errors import ConfigCompositionException
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf

from pipeline.config import CONF, register_schemas
from pipeline.quick_compose import QuickLoader

register_schemas(ConfigStore.instance())
setup_globals()
JOBS = [
    ["selection.k=3", "split.index=4"],
    ["compensation/step_rule=newton", "selection.k=5"],
    ["split=k_fold", "split.index=1", "compensation/step_rule=constant",
     "compensation.step_rule.step=0.25"],
    ["experiment=close_the_gap", "twin.pitch.noise_deg=0.1", "stages=[acquisition]"],
    ["+camera.sources.yaw=somewhere", "~robot.limit_deg.yaw", "hydra.job.name=other"],
    ["selection.k=3", "split.index=5"],
]  # fmt: skip


@pytest.fixture(scope="module")
def loaders() -> tuple[QuickLoader, ConfigLoaderImpl]:
    path = create_config_search_path(str(CONF))
    return QuickLoader(path), ConfigLoaderImpl(path)


@pytest.fixture(scope="module")
def master(loaders: tuple[QuickLoader, ConfigLoaderImpl]) -> DictConfig:
    return loaders[1].load_configuration("config", ["hydra.sweep.dir=x"], RunMode.MULTIRUN)


@pytest.mark.parametrize("overrides", JOBS)
def test_a_job_is_composed_as_hydra_does_it(
    overrides: list[str], loaders: tuple[QuickLoader, ConfigLoaderImpl], master: DictConfig
) -> None:
    quick, hydras = (loader.load_sweep_config(master, overrides) for loader in loaders)
    assert OmegaConf.to_container(quick) == OmegaConf.to_container(hydras)


@pytest.mark.parametrize("override", ["selection.kk=3", "selection.k=many", "robot.k=1"])
def test_a_wrong_value_is_refused_as_hydra_does(
    override: str, loaders: tuple[QuickLoader, ConfigLoaderImpl], master: DictConfig
) -> None:
    for loader in loaders:
        with pytest.raises(ConfigCompositionException, match=override.replace(".", r"\.")):
            loader.load_sweep_config(master, [override])
