"""A rival is true where the best fit of its parts leaves nothing that the noise doesn't hide."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.concealed.draw import Case, Hidden, draw_case
from pipeline.concealed.effects import Effect, Settings
from pipeline.concealed.names import BENDS
from pipeline.concealed.noise import Noise
from pipeline.concealed.rivals import TOLD_APART, rivals_of, separation


def case_of(excitation: str, effect: Effect, size: float, over_noise: float) -> tuple[Case, Hidden]:
    hidden = Hidden(effect, size, over_noise, over_noise)
    bare = draw_case(3, "case-000", "none", excitation, None)
    quiet = replace(bare, noise=Noise(0.2), tolerance_shape_deg=0.0, hidden=(hidden,))
    return quiet, hidden


def play(width_deg: float) -> tuple[Effect, float]:
    return Effect("backlash", {"clearance_deg": 1.0}, ("clearance_deg",), 30.0), width_deg


def test_a_play_narrower_than_a_step_is_a_lag_in_plain_cycles_and_none_in_rich_ones():
    effect, size = play(0.8)
    plain, hidden = case_of("plain", effect, size, 1.4)
    rich, same = case_of("rich", effect, size, 1.4)
    assert separation(plain, hidden, "frame_lag") < TOLD_APART
    assert separation(rich, same, "frame_lag") > TOLD_APART
    assert "frame_lag" in rivals_of(plain, hidden)
    assert "frame_lag" not in rivals_of(rich, same)


def test_a_wide_play_is_no_rounded_friction():
    case, hidden = case_of("plain", *play(4.0), 6.0)
    assert separation(case, hidden, "friction") > 10 * TOLD_APART
    assert rivals_of(case, hidden) == ["frame_lag"]


def test_what_bends_one_static_curve_is_never_told_apart():
    effect = Effect("gravity", {"weight": 1.0, "mounting_rad": 1.5}, ("weight",), 900.0)
    for excitation in ("plain", "rich"):
        assert set(rivals_of(*case_of(excitation, effect, 600.0, 6.0))) == BENDS - {"gravity"}


def test_a_hardening_stretch_and_a_sharp_slack_are_told_apart_where_they_stand_out():
    soft: Settings = {
        "pretension_deg": 0.0, "wire_softness": 1.0, "toe_share": 0.2, "toe_deg": 8.0,
    }  # fmt: skip
    stretch = Effect("compliance", soft, ("wire_softness",), 5.0)
    assert separation(*case_of("rich", stretch, 2.0, 2.0), "slack") > TOLD_APART
    sharp: Settings = {"pretension_deg": -1.0, "straightening_deg": 0.0}
    slack = Effect("slack", sharp, ("pretension_deg",), 15.0)
    assert separation(*case_of("rich", slack, 2.0, 2.0), "compliance") > TOLD_APART


def test_separation_grows_with_the_effect_and_falls_with_the_noise():
    small, hidden = case_of("plain", *play(2.0), 2.0)
    large, same = case_of("plain", *play(4.0), 4.0)
    correlated = replace(small, noise=Noise(0.2, correlation=0.8))
    found = separation(small, hidden, "creep")
    assert separation(large, same, "creep") > 2 * found
    assert separation(correlated, hidden, "creep") != pytest.approx(found, rel=0.2)


def test_no_separation_from_itself():
    case, hidden = case_of("plain", *play(3.0), 4.0)
    assert separation(case, hidden, "backlash") < 1.0


def test_an_effect_with_no_candidates_has_no_rivals():
    case, hidden = case_of(
        "rich", Effect("coupling", {"other_lever": 1.0}, ("other_lever",), 0.5), 0.1, 0.8
    )
    assert rivals_of(case, hidden) == []
    assert np.isfinite(hidden.size)
