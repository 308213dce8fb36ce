from typing import TypedDict

import pytest

from lqd_search.runs.json_form import FormError, check_form, known_keys


class Leaf(TypedDict):
    name: str
    share: float


class Tree(TypedDict):
    leaves: list[Leaf]
    counts: dict[str, int]
    best: str | None
    notes: tuple[str, ...]


def tree(**changes):
    fitting = {
        "leaves": [{"name": "a", "share": 0.5}, {"name": "b", "share": 1, "more": []}],
        "counts": {"all": 3},
        "best": None,
        "notes": ["one"],
    }
    return fitting | changes


@pytest.mark.parametrize("data", [tree(), tree(leaves=[], counts={}, best="a"), tree(unknown=1)])
def test_data_of_the_form_pass(data):
    check_form(data, Tree)


def test_what_a_class_does_not_know_is_left_out():
    assert known_keys(tree(unknown=1), Tree) == tree()


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ([], "Expected an object at '', but got a list."),
        ({}, "Expected the key 'leaves', but it is not there."),
        (tree(leaves=3), "Expected a list at 'leaves', but got 3."),
        (tree(leaves=[{}]), "Expected the key 'leaves[0].name', but it is not there."),
        (tree(leaves=["a"]), "Expected an object at 'leaves[0]', but got 'a'."),
        (
            tree(leaves=[{"name": "a", "share": float("nan")}]),
            "Expected a number at 'leaves[0].share', but got nan.",
        ),
        (
            tree(leaves=[{"name": "a", "share": float("inf")}]),
            "Expected a number at 'leaves[0].share', but got inf.",
        ),
        (tree(counts={"all": True}), "Expected an integer at 'counts.all', but got True."),
        (tree(counts=None), "Expected an object at 'counts', but got None."),
        (tree(best=3), "Expected a string or null at 'best', but got 3."),
        (tree(notes="one"), "Expected a list at 'notes', but got 'one'."),
    ],
)
def test_the_first_misfit_is_named(data, message):
    with pytest.raises(FormError) as caught:
        check_form(data, Tree)
    assert str(caught.value) == message


def test_a_number_too_large_for_a_float_is_none():
    with pytest.raises(FormError, match="Expected a number at 'share', but got 1000"):
        check_form({"name": "a", "share": 10**400}, Leaf)
