"""What slip elements a simulation's own friction has, at its joint or at its drive.

A joint's angles say what each element of a given reach holds back, and so do a drive's: then the
curve and the strengths are one linear problem, the strengths not negative.
"""

import numpy as np
from scipy.optimize import nnls

from pipeline.physics.piece import Piece
from pipeline.physics.slip_spectrum import (
    AT_DRIVE,
    AT_JOINT,
    SHORTEST,
    SlipSpectrum,
    reaches_from,
    shares_of,
)

LONGEST, ROUNDING = 0.3, 1e-13


def spectrum_at_joint(curve: np.ndarray, angle: np.ndarray, rows: np.ndarray) -> Piece | None:
    """The elements at a joint of these angles (n,): angle + held = curve, columns (n, m) of it."""
    return spectrum(AT_JOINT, angle, angle[rows], curve[rows], rows)


def spectrum_at_drive(inverse: np.ndarray, drive: np.ndarray, rows: np.ndarray) -> Piece | None:
    """The elements at a drive (n,): drive - held = the curve's inverse, columns (n, m) of it."""
    return spectrum(AT_DRIVE, drive, -drive[rows], -inverse[rows], rows)


def spectrum(
    form: str, position: np.ndarray, moved: np.ndarray, columns: np.ndarray, rows: np.ndarray
) -> Piece | None:
    """Elements that hold a position, (n,), so that moved (k,) + held is in columns (k, m) in rows.

    rows: (k,) indices. None where nothing holds.
    """
    span = float(np.ptp(position))
    shortest, longest = SHORTEST * span, LONGEST * span
    held = shares_of(position, reaches_from(shortest, longest))[rows]
    free = columns.shape[1]
    square = factor(np.column_stack([columns, held, moved]))[free:, free:]
    holds = nnls(square[:, :-1], -square[:, -1])[0]
    if not holds.any():
        return None
    return Piece(SlipSpectrum(form), np.concatenate([[shortest, longest], holds]))


def factor(columns: np.ndarray) -> np.ndarray:
    """R (m, m) of columns (k, m) = Q R, by Cholesky: to about 1e-7 of their size, but soon."""
    square = columns.T @ columns
    diagonal = square.diagonal()
    square.flat[:: len(square) + 1] = (1.0 + ROUNDING) * diagonal + np.finfo(float).tiny
    return np.linalg.cholesky(square).T
