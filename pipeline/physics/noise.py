"""Pose noise: what a mechanism does besides what its terms say."""

import numpy as np


def pose_noise(deviation: float, samples: int, generator: np.random.Generator) -> np.ndarray:
    """Independent Gaussian noise of a standard deviation, shape (n,); zero where it is zero."""
    return deviation * generator.standard_normal(samples)
