"""Creep of a wire under the joint's own load: what has arrived is taken back."""

from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np

from pipeline.physics.creep import Creep
from pipeline.physics.loaded_wire import CONVERSE, LoadedWire, ahead
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term, Told

YIELDING = "yielding wire"


class YieldingWire(Creep):
    """x = u + share (foreseen u - late), late' = (u - late) / time_constant, before the curve.

    A wire that pulls against the joint's own spring goes on stretching as long as that pulls back,
    and a joint that has followed sags toward home again. Of that the share `foreseen` is in the
    simulation's gain: none where it is the wire's at once, all where it is that in the long run.
    So this is creep that takes back, not creep that arrives late. Other loads: `loaded_wire.py`.
    What has settled within a dwell is not told from motion. Form "yielding wire two" has two
    arms. `moving` and `begun`: see `Creep`. Source: standard linear solid in series with a spring
    (Zener); Fung, Biomechanics (1993), section 7.6.
    """

    grows: ClassVar = {YIELDING: (f"{YIELDING} two",)}
    says = (
        "Of each motion {share} is taken back, with a time constant of {time_constant}: the wire "
        "goes on stretching under the joint's load."
    )

    def __init__(self, form: str = YIELDING) -> None:
        super().__init__(form)
        self.unlikely = CONVERSE

    def richer(self) -> tuple[Term, ...]:
        more = tuple(YieldingWire(form) for form in self.grows.get(self.form, ()))
        return (*more, LoadedWire()) if self.form == YIELDING else more

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        own = tuple(
            replace(p, low=around.dwell_s) if p.name.startswith("time_constant") else p
            for p in super().parameters(around)
        )
        foreseen = Parameter("foreseen", "", 0.0, 1.0, 0.5, 0.5, weak=True)
        return (*own[:FORESEEN], foreseen, *own[FORESEEN:])

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        arms = np.delete(values, FORESEEN)
        late, carried = super().respond(signal, motion, arms, state)
        whole = sum(share for share, _ in self.arms(arms))
        return (2.0 - whole * (1.0 - values[FORESEEN])) * signal - late, carried

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        return np.insert(super().candidates(motion, around), FORESEEN, 0.5, axis=1)

    def retold(self, starts: np.ndarray) -> np.ndarray:
        apart = super().retold(np.delete(starts, FORESEEN, axis=1))
        return np.insert(apart, FORESEEN, starts[0, FORESEEN], axis=1)

    def beyond_at(self, values: np.ndarray, around: Surroundings) -> str:
        return ahead(values, around)

    def other_names(self, values: np.ndarray, around: Surroundings) -> tuple[str, ...]:
        return ()

    def instead(self, values: np.ndarray, motion: Motion, around: Surroundings) -> Sequence[Told]:
        return ()


FORESEEN = 4
