"""Numbers as sentences say them."""

LARGE, LARGEST = 999.5, 1e15


def worded(value: float, sign: str = "-") -> str:
    """At least three significant digits; an exponent only where a number is tiny, or beyond 1e15.

    Encoder counts and seconds of a clock are large, and their last digits count. sign: "+" to put
    one before positive numbers, too.
    """
    return format(value, f"{sign}.0f" if LARGE <= abs(value) < LARGEST else f"{sign}.3g")
