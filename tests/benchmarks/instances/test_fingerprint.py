"""The fingerprint of what is declared."""

import numpy as np
import pytest

from benchmarks.instances import candidates as candidates_module
from benchmarks.instances import fingerprint as module
from benchmarks.instances.fingerprint import fingerprint
from lqd_search.adaptation import SELECTORS, NamedSelector


def test_it_is_the_same_for_the_same_declarations():
    assert fingerprint(500) == fingerprint(500)
    assert len(fingerprint(500)) == 16


def test_it_tells_caps_apart_however_large():
    assert len({fingerprint(cap) for cap in (3, 499, 500, 501)}) == 4


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("RULES", 0),
        ("SIZES", (1, 2, 5)),
        ("SUBSETS", 21),
        ("TRIES", (1, 5, 50)),
        ("FILTERS", {"inferred": None}),
    ],
)
def test_it_tells_declarations_apart(monkeypatch, name, value):
    before = fingerprint(500)

    monkeypatch.setattr(module, name, value)

    assert fingerprint(500) != before


def test_it_tells_a_selector_apart_that_chooses_otherwise_under_the_same_name(monkeypatch):
    before = fingerprint(500)

    def worst_first(view, count):
        return np.argsort(view.objective, kind="stable")[:count]

    changed = {**SELECTORS, "best": NamedSelector("best", "", worst_first)}
    monkeypatch.setattr(candidates_module, "SELECTORS", changed)

    assert fingerprint(500) != before
