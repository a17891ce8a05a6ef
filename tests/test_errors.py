"""What was probably meant, wherever a name is asked for."""

import pytest
from play_loop import play_recording

from pipeline.config import Config, RobotConfig, SplitConfig
from pipeline.config_check import check_config
from pipeline.errors import LoopgapError, UsageError, did_you_mean
from pipeline.physics.catalogue import term


@pytest.mark.parametrize("wanted", ["Backlash", "backlsh", " BACKLASH", "backlash_"])
def test_a_name_is_known_whatever_its_case_and_with_a_slip(wanted: str) -> None:
    assert did_you_mean(wanted, ["friction", "backlash"]) == "Did you mean 'backlash'? "


def test_nothing_is_meant_by_what_is_like_nothing() -> None:
    assert did_you_mean("pitch", ["backlash", "drift"]) == did_you_mean("pitch", []) == ""


def test_a_term_a_form_a_channel_and_a_stage_are_suggested() -> None:
    with pytest.raises(LoopgapError, match="Did you mean 'lost_steps'"):
        term("Lost_Steps")
    with pytest.raises(LoopgapError, match="Did you mean 'friction/driven'"):
        term("friction", "Driven")
    with pytest.raises(LoopgapError, match="Did you mean 'pitch_angle_deg'"):
        play_recording("pitch", 2.0, 0.3, seed=2).channel("Pitch_Angle_deg")
    config = Config(
        stages=["diagnose"], robot=RobotConfig(kind="emulated"), split=SplitConfig(kind="paper")
    )
    with pytest.raises(UsageError, match="Did you mean 'diagnosis'"):
        check_config(config)
