"""A joint that is driven as it was before from where it was before: then it goes as it went.

Robots repeat their cycles. Whatever a joint remembers of its motion, once two cycles begin alike
it has forgotten all that was before them, and what it is asked for is all that counts (a state:
`balance.py`). Most of a recording need not be worked out, then.
"""

from numba import njit

from pipeline.physics.equilibrium import balance
from pipeline.physics.tabled import inlined


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


@njit(cache=True, error_model="numpy", _nrt=False)  # type: ignore[call-overload]
def balanced_by_cycle(q, pushed, loads, begins, within, states, state, out):  # type: ignore[no-untyped-def]
    """As `equilibrium.balance` of a joint whose loads don't go by time, cycle by cycle.

    begins: (cycles + 1,) their first rows and the number of rows. within: which angles, asked for
    or remembered, count as the same [angle unit]. states: (cycles, state.size), room for the states
    in which they begin. What is copied is off by no more than about `within`.
    """
    for i in range(begins.size - 1):
        here = slice(begins[i], begins[i + 1])
        asked, push = q[here], pushed[here]
        _copy(state, states[i])
        last = i - 1
        while last >= 0:
            before = slice(begins[last], begins[last + 1])
            if (
                q[before].size == asked.size
                and _close(states[last], state, within)
                and _close(q[before], asked, within)
                and _close(pushed[before], push, within)
            ):
                break
            last -= 1
        if last >= 0:
            _copy(out[slice(begins[last], begins[last + 1])], out[here])
            _copy(states[last + 1], state)
        else:
            balance(asked, push, push, loads, state, out[here])
