"""Figures of the concealed benchmark: which name each effect got, and how honest the odds are."""

import pandas as pd
from matplotlib.figure import Figure

from pipeline.tracking.figures import COLOURS, new_figure

CELL_IN = 0.34


def confusion_figure(confusion: pd.DataFrame) -> Figure:
    """Counts of hidden effects (index) by the name that they got (columns), shaded by row."""
    named = sorted(confusion.columns, key=lambda name: (name[0] == "(", name))
    hidden = sorted(confusion.index, key=lambda name: (name[0] == "(", name not in named, name))
    table = confusion.reindex(index=hidden, columns=named, fill_value=0)
    share = table.div(table.sum(axis=1).clip(lower=1), axis=0)
    figure, axes = new_figure(
        width_in=2.2 + CELL_IN * len(named), height_in=2.2 + CELL_IN * len(hidden)
    )
    panel = axes[0, 0]
    panel.imshow(share.to_numpy(), cmap="Blues", vmin=0.0, vmax=1.0)
    for row, column in zip(*table.to_numpy().nonzero(), strict=True):
        dark = share.iloc[row, column] > 0.6
        panel.text(column, row, str(table.iloc[row, column]), ha="center", va="center",
                   color="white" if dark else "black", fontsize=8)  # fmt: skip
    panel.set_xticks(range(len(named)), [n.replace("_", " ") for n in named], rotation=90)
    panel.set_yticks(range(len(hidden)), [n.replace("_", " ") for n in hidden])
    panel.grid(visible=False)
    panel.set_xlabel("named")
    panel.set_ylabel("hidden")
    panel.set_title("What was hidden, and what the diagnosis called it")
    return figure


def calibration_figure(calibration: pd.DataFrame, smallest: pd.DataFrame) -> Figure:
    """Stated probability against the share that was right; share found by size over the noise."""
    figure, axes = new_figure(1, 2, height_in=3.2)
    odds, sizes = axes[0]
    odds.plot([0, 1], [0, 1], color=COLOURS["measured"], lw=0.8)
    odds.scatter(calibration["stated"], calibration["right"], s=4 + 2 * calibration["terms"],
                 color=COLOURS["compensated"], clip_on=False)  # fmt: skip
    odds.set(xlabel="stated probability", ylabel="share that was right", xlim=(0, 1.03),
             ylim=(0, 1.03))  # fmt: skip
    odds.set_title("Are the odds honest? (area: terms)")
    sizes.bar(range(len(smallest)), smallest["found"], color=COLOURS["compensated"])
    sizes.set_xticks(range(len(smallest)), smallest["over_noise"].astype(str), rotation=60)
    sizes.set(xlabel="size of the effect over the noise (rms)", ylabel="share found", ylim=(0, 1))
    sizes.set_title("How small may an effect be?")
    return figure
