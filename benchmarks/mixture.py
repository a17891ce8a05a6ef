"""Mixture regression against the `gmr` package: python benchmarks/mixture.py

One thread, the same mixture (K = 9), best of seven rounds in turn. gmr's `predict` gives the mean
only; this project's gives mean and deviation together, and is compared with both of gmr's.
"""

import numpy as np
from gmr import GMM
from threadpoolctl import threadpool_limits
from timing import best_s, pitch_recording

from pipeline.config import TrainingConfig
from pipeline.models.mixture import MixtureRegression

K = 9
GMR_INPUT = np.array([0])


def main() -> None:
    recording = pitch_recording()
    command = recording.values("pitch_command_deg")
    angle = recording.values("pitch_angle_deg")
    points = np.column_stack([command, angle])
    config = TrainingConfig(n_init=1)
    mixture = MixtureRegression.fit(command, angle, K, config, seed=0)
    peer = GMM(K, mixture.weights, mixture.means_deg, mixture.covariances_deg2)
    with threadpool_limits(limits=1):
        times = best_s(
            {
                "gmr": lambda: GMM(K, random_state=0).from_samples(points),
                "ours": lambda: MixtureRegression.fit(command, angle, K, config, seed=0),
            }
        )
        print(f"{'work':34} {'gmr':>12} {'loopgap':>12} {'ratio':>8}")
        say(f"fit of {len(points)} samples, K = {K} [s]", times["gmr"], times["ours"])
        for count, calls in ((1, 200), (100, 50), (10_000, 1), (1_000_000, 1)):
            predict(mixture, peer, count, calls)
        with_variance(mixture, peer)


def predict(mixture: MixtureRegression, peer: GMM, count: int, calls: int) -> None:
    command = np.linspace(-60.0, 60.0, count)
    column = command[:, None]
    difference = np.abs(peer.predict(GMR_INPUT, column)[:, 0] - mixture.predict(command)[0]).max()
    times = best_s(
        {
            "gmr": lambda: [peer.predict(GMR_INPUT, column) for _ in range(calls)],
            "ours": lambda: [mixture.predict(command) for _ in range(calls)],
        }
    )
    points = count * calls
    say(f"predict {count} at a time [points/s]", points / times["gmr"], points / times["ours"])
    print(f"{'':34} largest difference {difference:.1e} deg")


def with_variance(mixture: MixtureRegression, peer: GMM) -> None:
    command = np.linspace(-60.0, 60.0, 500)
    times = best_s(
        {
            "gmr": lambda: [peer.condition(GMR_INPUT, np.array([q])).to_mvn() for q in command],
            "ours": lambda: mixture.predict(command),
        }
    )
    say("mean and variance [points/s]", 500 / times["gmr"], 500 / times["ours"])


def say(work: str, theirs: float, ours: float) -> None:
    ratio = theirs / ours if "[s]" in work else ours / theirs
    print(f"{work:34} {theirs:12.3g} {ours:12.3g} {ratio:7.1f}x")


if __name__ == "__main__":
    main()
