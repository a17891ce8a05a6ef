"""A joint that is driven as it was before from where it was before: then it goes as it went.

Robots repeat their cycles. Whatever a joint remembers of its motion, once two cycles begin alike
it has forgotten all that was before them, and what it is asked for is all that counts (a state:
`balance.py`). Most of a recording need not be worked out, then.
"""

from numba import njit

from pipeline.physics.equilibrium import balance
from pipeline.physics.tabled import inlined

BACK = 20


@inlined
def _close(one, other, within):  # type: ignore[no-untyped-def]
    """Whether two arrays (n,) are the same but for so much."""
    close = True
    for i in range(one.size):
        close &= abs(one[i] - other[i]) <= within
    return close


@inlined
def _copy(source, target):  # type: ignore[no-untyped-def]
    for i in range(source.size):
        target[i] = source[i]


@inlined
def _as_before(i, q, pushed, begins, within, states):  # type: ignore[no-untyped-def]
    """Which of the BACK cycles before began and went as the i-th, -1 where none did."""
    here = slice(begins[i], begins[i + 1])
    for k in range(i - 1, max(i - BACK, 0) - 1, -1):
        there = slice(begins[k], begins[k + 1])
        if (
            q[there].size == q[here].size
            and _close(states[k], states[i], within)
            and _close(q[there], q[here], within)
            and _close(pushed[there], pushed[here], within)
        ):
            return k
    return -1


@njit(cache=True, error_model="numpy", _nrt=False)  # type: ignore[call-overload]
def balanced_by_cycle(q, pushed, loads, begins, within, states, state, out):  # type: ignore[no-untyped-def]
    """As `equilibrium.balance` of a joint whose loads don't go by time, cycle by cycle.

    begins: (cycles + 1,) their first rows and the number of rows. within: which angles, asked for
    or remembered, count as the same [angle unit]. states: (cycles, state.size), room for the states
    in which they begin. What is copied is off by no more than about `within`.
    """
    for i in range(begins.size - 1):
        here = slice(begins[i], begins[i + 1])
        _copy(state, states[i])
        k = _as_before(i, q, pushed, begins, within, states)
        if k >= 0:
            _copy(out[slice(begins[k], begins[k + 1])], out[here])
            _copy(states[k + 1], state)
        else:
            balance(q[here], pushed[here], pushed[here], loads, state, out[here])
