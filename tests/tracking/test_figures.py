from pathlib import Path

import cv2
import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.text import Text
from play_loop import curve, play, triangle

from pipeline.tracking import figures

METHODS = ("nominal", "compensated", "as_printed")


def predictions(half_width: float = 1.5, cycles: int = 2) -> pd.DataFrame:
    command = triangle(cycles, 60.0, 80)
    angle = curve(play(command, half_width))
    table = pd.DataFrame(
        {
            "time_s": 3.0 * np.arange(len(command)),
            "cycle": np.repeat(np.arange(cycles), 80),
            "direction": np.where(np.gradient(command) >= 0, 1, -1),
            "command_deg": command,
            "measured_deg": angle + 0.2 * np.random.default_rng(0).standard_normal(len(command)),
            "nominal_deg": curve(command),
            "nominal_std_deg": 1.2,
            "compensated_deg": angle,
            "compensated_std_deg": 0.2,
        }
    )
    table.loc[5, "measured_deg"] = np.nan
    return table


def landings() -> dict[str, pd.DataFrame]:
    target = triangle(1, 30.0, 60)
    tables = {}
    for i, method in enumerate(METHODS):
        tables[method] = pd.DataFrame(
            {
                "target_deg": target,
                "command_deg": target / 0.7 + i,
                "status": ["unreachable", *["converged"] * 59],
                "measured_deg": target + 1.0 - 0.5 * i,
            }
        )
    tables["as_printed"].loc[0, "command_deg"] = np.nan
    return tables


def selection() -> pd.DataFrame:
    rows = [
        (axis, model, k, 4000 / k + 30 * k, 4000 / k + 20 * k, 0.4 + 1 / k)
        for axis in ("yaw", "pitch")
        for model in ("nominal", "cw", "ccw")
        for k in range(1, 7)
    ]
    table = pd.DataFrame(rows, columns=["axis", "model", "k", "bic", "aic", "heldout_rmse_deg"])
    table.loc[table["k"] == 6, ["bic", "aic", "heldout_rmse_deg"]] = np.nan
    return table


def drawn(name: str) -> Figure:
    chosen = {axis: {"nominal": 4, "cw": 3, "ccw": 3} for axis in ("yaw", "pitch")}
    both = {"yaw": predictions(0.9), "pitch": predictions()}
    landed = {"yaw": landings(), "pitch": landings()}
    return {
        "selection": lambda: figures.selection_figure(selection(), chosen, "bic"),
        "loops": lambda: figures.loops_figure(both),
        "errors": lambda: figures.errors_figure(both),
        "tracking": lambda: figures.tracking_figure(landed),
        "commands": lambda: figures.commands_figure(landed),
    }[name]()


def channel(colour: float) -> float:
    return colour / 12.92 if colour <= 0.04045 else ((colour + 0.055) / 1.055) ** 2.4


@pytest.mark.parametrize("name", ["selection", "loops", "errors", "tracking", "commands"])
def test_figure_is_readable_and_nothing_is_cut_off(name: str) -> None:
    figure = drawn(name)
    figure.draw_without_rendering()
    width, height = figure.get_size_inches() * figure.dpi
    ticks = {
        label
        for panel in figure.axes
        for axis in (panel.xaxis, panel.yaxis)
        for label in axis.get_ticklabels(which="both")
    }
    texts = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip()]
    assert min(t.get_fontsize() for t in texts) >= 8.0
    for text in set(texts) - ticks:
        box = text.get_window_extent()
        assert box.x0 >= -0.5, text.get_text()
        assert box.x1 <= width + 0.5, text.get_text()
        assert box.y0 >= -0.5, text.get_text()
        assert box.y1 <= height + 0.5, text.get_text()
    for panel in figure.axes:
        assert panel.get_title(loc="left")
        assert panel.has_data()


def test_selection_marks_the_chosen_number() -> None:
    panel = drawn("selection").axes[0]
    chosen = [line for line in panel.lines if line.get_linestyle() == "None"]
    assert [line.get_xdata()[0] for line in chosen] == [4, 3, 3]


def test_errors_figure_says_the_errors_it_shows() -> None:
    table = predictions().assign(measured_deg=lambda t: t["nominal_deg"] + 2.0)
    table["compensated_deg"] = table["measured_deg"] - 0.25
    panel = figures.errors_figure({"pitch": table}).axes[0]
    title = panel.get_title(loc="left")
    assert title == "pitch: RMSE 2.00 deg nominal, 0.25 deg compensated"
    assert np.allclose(panel.lines[0].get_ydata(), 2.0)


def test_commands_figure_crosses_what_did_not_converge() -> None:
    panel = drawn("commands").axes[0]
    crosses = [line for line in panel.lines if line.get_marker() == "x"]
    assert [len(line.get_xdata()) for line in crosses] == [1, 1, 1]


def test_a_figure_is_laid_out_once_and_drawn_once_a_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    draw, drawings = Figure.draw, []
    monkeypatch.setattr(Figure, "draw", lambda one, to: (drawings.append(1), draw(one, to))[1])
    figures.save_figure(drawn("loops"), tmp_path, "loops")
    assert len(drawings) == 3


def test_saved_files_are_whole_and_repeatable(tmp_path: Path) -> None:
    paths = figures.save_figure(drawn("loops"), tmp_path / "figures", "loops")
    assert [p.name for p in paths] == ["loops.png", "loops.pdf"]
    first = [p.read_bytes() for p in paths]
    again = figures.save_figure(drawn("loops"), tmp_path / "again", "loops")
    assert [p.read_bytes() for p in again] == first
    assert sorted(p.name for p in paths[0].parent.iterdir()) == ["loops.pdf", "loops.png"]
    image = cv2.imread(str(paths[0]))
    assert image.shape[1] == round(figures.WIDTH_IN * figures.PNG_DPI)
    assert image.std() > 10
    assert first[1].startswith(b"%PDF")
    assert b"%%EOF" in first[1][-32:]


def test_lines_that_share_a_panel_differ_in_lightness_or_marker() -> None:
    for one, other in (("nominal", "compensated"), ("cw", "ccw"), ("nominal", "ccw")):
        light = [
            sum(
                w * channel(c)
                for w, c in zip((0.2126, 0.7152, 0.0722), to_rgb(colour), strict=True)
            )
            for colour in (figures.COLOURS[one], figures.COLOURS[other])
        ]
        assert abs(light[0] - light[1]) > 0.05 or figures.MARKERS[one] != figures.MARKERS[other]


def test_loop_picture_is_one_axis(tmp_path: Path) -> None:
    png = figures.loop_picture("pitch", predictions())
    image = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR)
    assert image.shape[0] > image.shape[1]
