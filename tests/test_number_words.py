import pytest

from pipeline.number_words import worded


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (0.000523, "0.000523"), (1.5e-7, "1.5e-07"), (-3.14159, "-3.14"), (999.6, "1000"),
        (12345.6, "12346"), (1.7e9 + 3.2, "1700000003"), (1e16, "1e+16"), (0.0, "0"),
    ],
)  # fmt: skip
def test_a_number_keeps_its_digits(value, words):
    assert worded(value) == words


def test_a_sign_may_stand_before_a_positive_number():
    assert (worded(4210.0, "+"), worded(0.25, "+"), worded(-0.25, "+")) == (
        "+4210",
        "+0.25",
        "-0.25",
    )
