"""Nobody changes or guesses a truth between the sealing and the opening."""

import hashlib

import pytest

from pipeline.concealed.seal import SealError, canonical, commitment, opened, seal

TRUTH = {"case": "case-000", "effects": [{"name": "backlash", "size": 3.25}], "kind": "one"}


def test_a_commitment_is_the_hash_of_salt_and_canonical_truth():
    text = '{"case":"case-000","effects":[{"name":"backlash","size":3.25}],"kind":"one"}'
    assert canonical(dict(reversed(TRUTH.items()))) == text
    assert commitment(TRUTH, "ab") == hashlib.sha256(f"ab\n{text}".encode()).hexdigest()


def test_what_was_sealed_opens():
    envelope, promised = seal(TRUTH)
    assert opened("case-000", envelope, promised) == TRUTH


def test_salts_differ_so_that_equal_truths_look_different():
    assert seal(TRUTH)[1] != seal(TRUTH)[1]


@pytest.mark.parametrize("change", [{"kind": "two"}, {"effects": []}])
def test_a_changed_truth_is_refused(change):
    envelope, promised = seal(TRUTH)
    envelope["truth"] = TRUTH | change
    with pytest.raises(SealError, match=r"truth of case-000: expected the sealed one, .* changed"):
        opened("case-000", envelope, promised)
