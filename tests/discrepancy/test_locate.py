from collections.abc import Callable

import numpy as np
import pytest
from scipy.signal import lfilter

from pipeline.discrepancy.location.coordinates import ground_of
from pipeline.discrepancy.location.locate import (
    Located,
    Work,
    combined,
    holm,
    locate,
    order_p_value,
    parts_of,
)
from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import play
from pipeline.recording import branch_of

DWELL_S = 3.36


def plain(cycles: int = 9, steps: int = 200, amplitude: float = 60.0) -> Motion:
    phase = np.arange(cycles * steps) / steps
    drive = amplitude * (4.0 * np.abs((phase + 0.75) % 1.0 - 0.5) - 1.0)
    cycle = np.arange(cycles * steps) // steps
    return Motion(drive, DWELL_S * np.arange(len(drive)), cycle)


def rich() -> Motion:
    """Nine cycles; the fourth and fifth at another dwell, the yaw moves in the seventh to ninth."""
    motion = plain()
    slow = np.isin(motion.cycle, (3, 4))
    time_s = np.cumsum(np.where(slow, 5.0 * DWELL_S, DWELL_S))
    late = motion.cycle >= 6
    yaw = np.where(late, 40.0 * np.sin(np.arange(len(late)) / 37.0), 0.0)
    return Motion(motion.drive, time_s, motion.cycle, {"yaw_command_deg": yaw})


def serial(n: int, correlation: float, sigma: float, rng: np.random.Generator) -> np.ndarray:
    driven = rng.standard_normal(n + 300) * np.sqrt(1.0 - correlation**2)
    return sigma * lfilter([1.0], [1.0, -correlation], driven)[300:]


def noise(motion: Motion, seed: int = 0, jitter: float = 0.05) -> np.ndarray:
    rng = np.random.default_rng(seed)
    zero = jitter * rng.standard_normal(int(motion.cycle.max()) + 1)
    return serial(len(motion), 0.5, 0.2, rng) + zero[motion.cycle]


def curve(drive: np.ndarray) -> np.ndarray:
    return 0.7 * drive + 1e-5 * drive**3


def located(motion: Motion, error: np.ndarray, seed: int = 0) -> dict[str, Located]:
    found = locate(error + noise(motion, seed), motion, curve(motion.drive), "deg", "deg")
    return {entry.coordinate: entry for entry in found}


def sure(found: dict[str, Located]) -> list[str]:
    return [name for name, entry in found.items() if entry.where is not None]


def test_play_lies_along_direction_and_the_travel_after_a_reversal() -> None:
    motion = plain()
    error = curve(play(motion.drive, 3.0, 0.0)) - curve(motion.drive)
    found = located(motion, error)
    assert sure(found) == ["direction", "travel"]
    assert found["direction"].share > 0.85
    assert found["direction"].share + found["travel"].share == pytest.approx(0.99, abs=0.02)
    words = found["direction"].where or ""
    assert words.startswith("after each reversal, over ")
    assert float(words.split()[4]) == pytest.approx(6.0, abs=1.5)


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (lambda u: -0.1 * np.maximum(0.0, u - 31.0), "on the positive side"),
        (lambda u: 0.1 * np.maximum(0.0, -31.0 - u), "on the negative side"),
        (lambda u: 1.2 * np.sin(2 * np.pi * u / 12.4), "periodically, every 12.4 deg of command"),
        (lambda u: 0.0008 * u**2, "as a smooth bend over the whole range"),
        (lambda u: 0.7 * np.clip(u, -4.0, 4.0), "of command of home"),
    ],
)
def test_what_the_command_explains_is_said_with_its_shape(
    error: Callable[[np.ndarray], np.ndarray], words: str
) -> None:
    motion = plain()
    found = located(motion, error(motion.drive))
    assert sure(found) == ["command"]
    assert found["command"].share > 0.8
    assert (found["command"].where or "").endswith(words)


def test_the_angle_at_which_it_begins_is_read_off() -> None:
    motion = plain()
    found = located(motion, -0.1 * np.maximum(0.0, motion.drive - 31.0))
    assert float((found["command"].where or "").split()[1]) == pytest.approx(31.0, abs=2.5)


def test_a_jump_of_the_zero_lies_along_time() -> None:
    motion = plain()
    found = located(motion, 2.8 * (motion.time_s > 3000.0))
    assert sure(found) == ["time"]
    begin, jump = (found["time"].where or "").removeprefix("from ").split(" s on, by ")
    assert float(begin) == pytest.approx(3000.0, abs=120.0)
    assert float(jump.split()[0]) == pytest.approx(2.8, abs=0.2)


def test_a_zero_that_is_another_from_a_cycle_on_names_the_cycle() -> None:
    motion = plain()
    found = located(motion, 1.5 * (motion.cycle >= 4))
    assert next(iter(found)) in ("cycle", "time")
    if "cycle" in sure(found):
        assert found["cycle"].where == "from cycle 4 on"


def test_a_loop_that_widens_is_found_along_cycles() -> None:
    motion = plain()
    way = np.sign(np.diff(motion.drive, prepend=motion.drive[0] - 1.0))
    found = located(motion, -0.2 * way * motion.cycle)
    assert found["cycle"].where == "the loop widens from cycle to cycle"


def test_another_axis_is_named_while_it_moves() -> None:
    motion = rich()
    found = located(motion, 0.05 * motion.others["yaw_command_deg"])
    assert sure(found) == ["other_command:yaw_command_deg"]
    assert found["other_command:yaw_command_deg"].where == "while yaw moves"


@pytest.mark.filterwarnings("error")
def test_another_axis_that_moves_only_where_nothing_is_known_explains_nothing() -> None:
    motion = rich()
    unknown = np.where(motion.cycle >= 6, np.nan, 0.0)
    found = located(motion, unknown + 0.3 * branch_of(motion.drive))
    assert "other_command:yaw_command_deg" not in found
    assert sure(found) == ["direction"]


def test_a_loop_that_closes_at_a_longer_dwell_is_found_there() -> None:
    motion = rich()
    way = np.sign(np.diff(motion.drive, prepend=motion.drive[0] - 1.0))
    long = np.isin(motion.cycle, (3, 4))
    found = located(motion, np.where(long, -0.2, -0.8) * way)
    assert sure(found)[0] == "direction"
    assert found["dwell"].where == "less behind the motion at a dwell of 16.8 s than at 3.36 s"


def test_single_frames_do_not_hide_the_rest() -> None:
    motion = plain()
    wrong = np.zeros(len(motion))
    wrong[40::60] = 25.0
    found = located(motion, wrong - 0.1 * np.maximum(0.0, motion.drive - 31.0))
    assert found["single_frames"].share > 0.9
    assert (found["single_frames"].where or "").startswith("in 30 single frames")
    assert (found["command"].where or "").endswith("on the positive side")


@pytest.mark.parametrize("motion", [plain(6, 100), rich()], ids=["plain", "rich"])
@pytest.mark.long
def test_p_values_are_uniform_when_only_noise_is_there(motion: Motion) -> None:
    rng = np.random.default_rng(11)
    p_values, alarms, trials = [], 0, 50
    for _ in range(trials):
        zero = 0.2 * rng.standard_normal(int(motion.cycle.max()) + 1)
        error = serial(len(motion), 0.8, 0.2, rng) + zero[motion.cycle]
        parts = parts_of(Work(ground_of(motion, curve(motion.drive)), error, np.arange(len(error))))
        own = [part.p_value for part in parts]
        p_values += own
        alarms += min(holm(own)) <= 0.05
    assert alarms <= 8
    assert np.mean(np.array(p_values) <= 0.05) == pytest.approx(0.05, abs=0.035)
    assert np.mean(np.array(p_values) <= 0.5) == pytest.approx(0.5, abs=0.12)


def test_a_wandering_zero_is_structure_over_time_only() -> None:
    motion = plain()
    rng = np.random.default_rng(4)
    names = set()
    for _ in range(6):
        walk = np.cumsum(0.02 * rng.standard_normal(len(motion)))
        error = walk + 0.2 * rng.standard_normal(len(motion))
        found = locate(error, motion, curve(motion.drive), "deg", "deg")
        names |= {entry.coordinate for entry in found if entry.where}
        steady = [entry.p_value for entry in found if entry.coordinate not in ("time", "cycle")]
        assert min(steady) > 0.01
    assert names <= {"time", "cycle"}


def test_missing_samples_and_long_recordings_are_no_hindrance() -> None:
    motion = plain(9, 1000)
    error = -0.1 * np.maximum(0.0, motion.drive - 31.0)
    error[2000:2500] = np.nan
    error[::7] = np.nan
    found = located(motion, error)
    assert sure(found) == ["command"]


@pytest.mark.parametrize("n", [0, 1, 2, 39])
def test_too_few_samples_locate_nothing(n: int) -> None:
    motion = Motion(np.arange(float(n)), np.arange(float(n)), np.zeros(n, dtype=int))
    assert locate(np.ones(n), motion, np.ones(n), "deg", "deg") == []


def test_what_is_not_varied_is_not_reported() -> None:
    still = Motion(np.zeros(300), np.arange(300.0), np.zeros(300, dtype=int))
    error = np.random.default_rng(0).standard_normal(300)
    assert [e.coordinate for e in locate(error, still, np.zeros(300), "deg", "deg")] == ["time"]
    one_way = Motion(np.arange(300.0), np.arange(300.0), np.zeros(300, dtype=int))
    names = {e.coordinate for e in locate(error, one_way, np.arange(300.0), "deg", "deg")}
    assert names == {"command", "time"} or names == {"command"}


def test_a_perfect_simulation_has_nothing_to_locate() -> None:
    motion = plain(2)
    found = locate(np.zeros(len(motion)), motion, curve(motion.drive), "deg", "deg")
    assert all(entry.share == 0.0 and entry.where is None for entry in found)


def test_profiles_follow_the_residual() -> None:
    motion = plain()
    found = located(motion, 0.0008 * motion.drive**2)
    line = found["command"].profile.curves["all"]
    bend = 0.0008 * line[:, 0] ** 2
    assert line[:, 1] - line[:, 1].mean() == pytest.approx(bend - bend.mean(), abs=0.12)
    assert found["command"].profile.x_label == "command [deg]"


def test_holm_multiplies_and_never_falls() -> None:
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([]) == []


def test_cauchy_combination_of_one_is_itself_and_small_ones_count() -> None:
    assert combined([0.2]) == pytest.approx(0.2)
    assert combined([1e-9, 0.9]) == pytest.approx(2e-9, rel=0.01)
    assert combined([]) == 1.0


def test_an_order_of_cycles_is_surer_than_a_shuffle() -> None:
    assert order_p_value(np.array([0.0, 0.1, 0.0, 0.1, 3.0, 3.1, 3.0, 3.1, 3.0])) < 0.002
    assert order_p_value(np.array([0.0, 3.0, 0.1, 3.1, 0.0, 3.0, 0.1, 3.1, 0.0])) > 0.2


def test_a_simulation_that_comes_late_or_early_leaves_a_line_in_the_command():
    time_s = 0.01 * np.arange(3000)

    def at(late_s: float) -> np.ndarray:
        t = time_s - late_s
        return 15.0 * np.sin(0.4 * np.pi * t) + 8.0 * np.sin(1.06 * np.pi * t + 1.0)

    motion = Motion(at(0.0), time_s, np.zeros(3000, dtype=np.int64))
    rough = 0.05 * np.random.default_rng(2).standard_normal(3000)
    for sign in (1.0, -1.0):
        for came, simulated, how in ((0.0, 0.15, "later"), (0.3, 0.1, "earlier")):
            off = sign * (at(came) - at(simulated)) + rough
            first = locate(off, motion, sign * at(simulated), "deg", "deg")[0]
            assert first.coordinate == "command"
            assert f"which the simulation follows {how} than" in str(first.where)
    still = locate(at(0.0) + rough, motion, np.zeros(3000), "deg", "deg")[0]
    assert still.where == "in step with the command"
