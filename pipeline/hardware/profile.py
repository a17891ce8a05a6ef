"""Trapezoidal motion profiles: pieces of constant acceleration, looked up at any time."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Piece:
    """`duration_s` of constant acceleration [qc/s^2] from a position [qc] and velocity [qc/s]."""

    duration_s: float
    position_qc: float
    velocity_qc_s: float
    acceleration_qc_s2: float

    def at(self, time_s: float) -> tuple[float, float]:
        """(position, velocity) `time_s` after the piece began."""
        velocity = self.velocity_qc_s + self.acceleration_qc_s2 * time_s
        return self.position_qc + 0.5 * (self.velocity_qc_s + velocity) * time_s, velocity


@dataclass(frozen=True)
class Profile:
    """Pieces one after the other, and the position [qc] at which the motion rests."""

    pieces: tuple[Piece, ...]
    rest_qc: float

    @property
    def duration_s(self) -> float:
        return sum(piece.duration_s for piece in self.pieces)

    def at(self, time_s: float) -> tuple[float, float]:
        """(position [qc], velocity [qc/s]) `time_s` after the start; at rest after the end.

        Before the start it is as if the first velocity had been held.
        """
        if time_s < 0 and self.pieces:
            velocity = self.pieces[0].velocity_qc_s
            return self.pieces[0].position_qc + velocity * time_s, velocity
        for piece in self.pieces:
            if time_s < piece.duration_s:
                return piece.at(time_s)
            time_s -= piece.duration_s
        return self.rest_qc, 0.0


def resting(position_qc: float) -> Profile:
    """No motion."""
    return Profile((), position_qc)


def braking(position_qc: float, velocity_qc_s: float, deceleration_qc_s2: float) -> Profile:
    """Come to rest as fast as `deceleration_qc_s2` (positive) allows."""
    if velocity_qc_s == 0.0:
        return resting(position_qc)
    duration = abs(velocity_qc_s) / deceleration_qc_s2
    brake = math.copysign(deceleration_qc_s2, -velocity_qc_s)
    piece = Piece(duration, position_qc, velocity_qc_s, brake)
    return Profile((piece,), piece.at(duration)[0])


def trapezoid(
    start_qc: float,
    target_qc: float,
    velocity_qc_s: float,
    acceleration_qc_s2: float,
    deceleration_qc_s2: float,
) -> Profile:
    """From rest to rest: accelerate, cruise where the way is long enough, decelerate."""
    distance = abs(target_qc - start_qc)
    sign = math.copysign(1.0, target_qc - start_qc)
    up, down = acceleration_qc_s2, deceleration_qc_s2
    peak = min(velocity_qc_s, math.sqrt(2.0 * distance * up * down / (up + down)))
    if peak == 0.0:
        return resting(target_qc)
    ramp_qc = peak**2 / (2.0 * up)
    cruise_qc = max(0.0, distance - ramp_qc - peak**2 / (2.0 * down))
    pieces = (
        Piece(peak / up, start_qc, 0.0, sign * up),
        Piece(cruise_qc / peak, start_qc + sign * ramp_qc, sign * peak, 0.0),
        Piece(peak / down, start_qc + sign * (ramp_qc + cruise_qc), sign * peak, -sign * down),
    )
    return Profile(pieces, target_qc)


def then(first: Profile, second: Profile) -> Profile:
    """One profile after the other; the second begins where the first rests."""
    return Profile(first.pieces + second.pieces, second.rest_qc)
