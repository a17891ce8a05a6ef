"""Laws of force that one would try first, fitted to some rows and asked about other motions.

A law sees a motion as a table of features and learns from a measured force; none names anything.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
from sklearn.linear_model import LinearRegression, Ridge
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures, StandardScaler

from pipeline.physics.pre_sliding import sliding

MOST_GP_ROWS = 600
DEGREE = 3
REACHES = np.geomspace(1e-5, 0.5, 12)

Answer = Callable[["Features"], np.ndarray]


@dataclass(frozen=True)
class Features:
    """What a law may look at, (n,) each: position, its derivatives, and the simulated force.

    stops: (n, k) elasto-plastic sliders of several reaches that the position drags, -1 to 1.
    """

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    simulated: np.ndarray
    stops: np.ndarray

    @property
    def kinematic(self) -> np.ndarray:
        """Position, velocity and acceleration, (n, 3)."""
        return np.column_stack([self.position, self.velocity, self.acceleration])


def stops_of(position: np.ndarray, span: float) -> np.ndarray:
    """Sliders of 12 reaches from 1e-5 to half of a span, (n, 12)."""
    return np.column_stack([sliding(position, r * span, 0.0, None)[0] for r in REACHES])


def as_it_came(features: Features, force: np.ndarray) -> Answer:
    """The simulation itself."""
    return lambda f: f.simulated


def affine(features: Features, force: np.ndarray) -> Answer:
    """Gain and offset of the simulation refitted."""
    model = LinearRegression().fit(features.simulated[:, None], force)
    return lambda f: np.asarray(model.predict(f.simulated[:, None]))


def polynomial(features: Features, force: np.ndarray) -> Answer:
    """Polynomial of degree 3 in position, velocity and acceleration (ridge on standardised)."""
    model = make_pipeline(
        StandardScaler(), PolynomialFeatures(DEGREE), StandardScaler(), Ridge(1e-3)
    ).fit(features.kinematic, force)
    return lambda f: np.asarray(model.predict(f.kinematic))


def symmetric(features: Features, force: np.ndarray) -> Answer:
    """Least squares of mass, viscous and Coulomb friction and an offset: the published model."""
    weights = symmetric_weights(features, force)
    return lambda f: symmetric_columns(f) @ weights


def symmetric_columns(f: Features) -> np.ndarray:
    """Acceleration, velocity, its sign, 1: (n, 4)."""
    ones = np.ones(len(f.velocity))
    return np.column_stack([f.acceleration, f.velocity, np.sign(f.velocity), ones])


def symmetric_weights(features: Features, force: np.ndarray) -> np.ndarray:
    """Mass, viscous and Coulomb coefficient and offset, (4,), by ordinary least squares."""
    return np.asarray(np.linalg.lstsq(symmetric_columns(features), force, rcond=None)[0])


def prandtl_ishlinskii(features: Features, force: np.ndarray) -> Answer:
    """A bank of stops of the position with non-negative weights, beside the refitted simulation.

    Source: Kuhnen, European J. Control 9 (2003) 407.
    """

    def columns(f: Features) -> np.ndarray:
        ones = np.ones((len(f.position), 1))
        signed = np.column_stack([f.simulated, ones, f.position])
        return np.column_stack([signed, -signed, f.stops])

    size = np.linalg.norm(columns(features), axis=0)
    weights = nnls(columns(features) / size, force)[0] / size
    return lambda f: columns(f) @ weights


def gaussian_process(features: Features, force: np.ndarray) -> Answer:
    """Gaussian process over position, velocity and acceleration, on 600 rows evenly chosen."""
    rows = np.linspace(0, len(force) - 1, min(len(force), MOST_GP_ROWS)).astype(int)
    kernel = ConstantKernel(1.0) * RBF(np.ones(3), (0.01, 100.0)) + WhiteKernel(0.01, (1e-6, 1.0))
    process = GaussianProcessRegressor(kernel, normalize_y=True, random_state=0)
    model = make_pipeline(StandardScaler(), process)
    model.fit(features.kinematic[rows], force[rows])
    return lambda f: np.asarray(model.predict(f.kinematic))


LAWS: dict[str, Callable[[Features, np.ndarray], Answer]] = {
    "simulation as it came": as_it_came,
    "its gain and offset refitted": affine,
    "polynomial, degree 3": polynomial,
    "symmetric least squares (published)": symmetric,
    "Prandtl-Ishlinskii bank": prandtl_ishlinskii,
    "Gaussian process": gaussian_process,
}
