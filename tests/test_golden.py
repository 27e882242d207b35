"""Has a redesign changed a result? Every set of ``golden.py`` against its kept digest."""

import json

import pytest

from tests import golden

KEPT = json.loads(golden.KEPT.read_text(encoding="utf-8"))


def test_all_sets_are_kept():
    """None is forgotten and none is left over."""
    assert list(KEPT) == list(golden.SETS)


@pytest.mark.parametrize("name", golden.SETS)
def test_as_kept(name):
    """To the digest: ``python -m tests.golden --make`` after a change that was meant."""
    assert golden.SETS[name]() == KEPT[name]


def test_a_digest_notices():
    """A part in a thousand million of one number changes it, and less does not."""

    def text(value):
        out = golden.Digest()
        out.add(value)
        return out.text()

    assert text(1.0) == text(1.0 + 1e-11) != text(1.0 + 1e-9)
    assert text(0.0) == text(-0.0)
