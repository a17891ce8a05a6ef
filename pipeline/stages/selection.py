"""Selection: how many Gaussians each model takes, by BIC, AIC or the error on held-out cycles.

Only cycles of the training set are looked at: the test cycles have no say in K.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from pipeline.config import SelectionConfig, TrainingConfig
from pipeline.errors import LoopgapError, UsageError, refusal
from pipeline.models.loop_model import MODELS, BranchSamples, branch_samples
from pipeline.models.mixture import MixtureError, MixtureRegression, largest_k
from pipeline.recording import Recording
from pipeline.tracking.tables import METRIC_COLUMNS

COLUMNS = ("axis", "model", "k", "bic", "aic", "heldout_rmse_deg")
CRITERIA = {"bic": "bic", "aic": "aic", "heldout": "heldout_rmse_deg"}
HELDOUT_FOLDS = 3
AS_GOOD = 1.01


@dataclass(frozen=True)
class Selection:
    """`table`: a row (`COLUMNS`) for each axis, model and K; `chosen`: axis -> model -> K.

    Scores are empty (NaN) for a K that the samples don't allow, and where nobody asks for them;
    the held-out error also where fewer than two cycles train.
    """

    table: pd.DataFrame
    chosen: dict[str, dict[str, int]]


def select(
    config: SelectionConfig,
    training: TrainingConfig,
    recordings: Mapping[str, Recording],
    train_cycles: Sequence[int],
    seed: int,
) -> Selection:
    """Score K = 1 .. `k_max` (or the fixed `k`) for every axis's models, and choose.

    BIC and AIC choose the smallest score. Held-out error, which is flat over K, chooses the
    smallest K that comes within 1 % of the best. The held-out error is that of a model fitted to
    the other training cycles, in up to three interleaved folds.
    """
    _check(config)
    training = replace(training, n_init=config.n_init)
    rows = [
        (axis, model, k, *scores)
        for axis, recording in recordings.items()
        for model, samples in branch_samples(recording, axis, train_cycles).items()
        for k, scores in _scores(f"{axis}, {model} model", samples, config, training, seed)
    ]
    table = pd.DataFrame(rows, columns=list(COLUMNS))
    return Selection(table, {axis: _choose(table, axis, config) for axis in recordings})


def selection_metrics(selection: Selection) -> pd.DataFrame:
    """The chosen K of each axis and model (as `method`) and its scores, in `METRIC_COLUMNS`."""
    rows = [
        (row["axis"], row["model"], None, metric, value, unit, None)
        for row in selection.table.to_dict("records")
        if row["k"] == selection.chosen[row["axis"]][row["model"]]
        for metric, value, unit in (
            ("chosen_k", row["k"], "Gaussians"),
            ("bic", row["bic"], "1"),
            ("aic", row["aic"], "1"),
            ("heldout_rmse", row["heldout_rmse_deg"], "deg"),
        )
    ]
    table = pd.DataFrame(rows, columns=list(METRIC_COLUMNS)).dropna(subset=["value"])
    return table.astype({"cycle": "Int64", "n": "Int64"})


def _scores(
    name: str, samples: BranchSamples, config: SelectionConfig, training: TrainingConfig, seed: int
) -> Iterator[tuple[int, tuple[float, float, float]]]:
    """Each candidate K with its BIC, AIC and held-out RMSE [deg]."""
    allowed = max(1, largest_k(int(np.isfinite(samples.angle_deg).sum())))
    asked = {config.criterion, *config.scores}
    candidates = range(1, config.k_max + 1) if config.k is None else [config.k]
    for k in candidates:
        if config.k is None and k > allowed:
            yield k, (np.nan, np.nan, np.nan)
            continue
        try:
            fitted = MixtureRegression.fit(
                samples.command_deg, samples.angle_deg, k, training, seed
            )
        except MixtureError as error:
            raise MixtureError(f"{name}: {error}") from error
        heldout = heldout_rmse_deg(samples, k, training, seed) if "heldout" in asked else np.nan
        yield (
            k,
            (
                fitted.bic() if "bic" in asked else np.nan,
                fitted.aic() if "aic" in asked else np.nan,
                heldout,
            ),
        )


def heldout_rmse_deg(samples: BranchSamples, k: int, training: TrainingConfig, seed: int) -> float:
    """RMSE [deg] over all cycles, each predicted by a mixture fitted to cycles of other folds.

    NaN where there are fewer than two cycles, or where a fold's samples don't allow K.
    """
    cycles = [int(cycle) for cycle in np.unique(samples.cycle)]
    folds = min(HELDOUT_FOLDS, len(cycles))
    if folds < 2:
        return float("nan")
    once = replace(training, n_init=1)
    errors = []
    for fold in range(folds):
        test = samples.only(cycles[fold::folds])
        train = samples.only([c for c in cycles if c not in cycles[fold::folds]])
        if k > largest_k(int(np.isfinite(train.angle_deg).sum())):
            return float("nan")
        mixture = MixtureRegression.fit(train.command_deg, train.angle_deg, k, once, seed)
        errors.append(test.angle_deg - mixture.predict(test.command_deg)[0])
    return float(np.sqrt(np.nanmean(np.concatenate(errors) ** 2)))


def _check(config: SelectionConfig) -> None:
    if config.criterion not in CRITERIA:
        raise UsageError(
            refusal("selection.criterion", f"one of {', '.join(CRITERIA)}",
                    repr(config.criterion), "Choose one of them.")
        )  # fmt: skip
    unknown = sorted(set(config.scores) - set(CRITERIA))
    if unknown:
        raise UsageError(
            refusal("selection.scores", f"some of {', '.join(CRITERIA)}", repr(unknown[0]),
                    "Choose among them.")
        )  # fmt: skip
    if config.k_max < 1:
        raise UsageError(
            refusal("selection.k_max", "at least 1", f"{config.k_max}", "Set it to 1 or more.")
        )


def _choose(table: pd.DataFrame, axis: str, config: SelectionConfig) -> dict[str, int]:
    if config.k is not None:
        return dict.fromkeys(MODELS, config.k)
    score = CRITERIA[config.criterion]
    chosen = {}
    for model in MODELS:
        scored = table[(table["axis"] == axis) & (table["model"] == model)].dropna(subset=[score])
        if scored.empty:
            raise LoopgapError(
                refusal(f"selection of {axis}, {model} model", f"a score {score!r} for some K",
                        "none", "Train on at least two cycles, or choose selection=bic.")
            )  # fmt: skip
        if config.criterion == "heldout":
            scored = scored[scored[score] <= AS_GOOD * scored[score].min()]
            chosen[model] = int(scored["k"].min())
        else:
            best = int(np.argmin(scored[score].to_numpy()))
            chosen[model] = int(scored["k"].iloc[best])
    return chosen
