import pytest

from lqd_search.runs.summary_notes import descriptor_notes, functional_notes

NOTHING = {"stopped": [], "dropped": [], "repaired": [], "remarks": []}
DESCRIPTORS = {
    "grids": [],
    "waiting_descriptors": [],
    "same_descriptors": [["a.x", "b.x"]],
    "degenerate_descriptors": ["c.x"],
    "undefined_descriptors": [],
}


def test_what_became_of_functionals():
    summary = NOTHING | {"dropped": ["One.", "Two."], "stopped": ["Late."], "remarks": ["Odd."]}

    assert functional_notes(NOTHING) == ()
    assert functional_notes(summary) == (
        "Stopped: Late.",
        "Not used: One.",
        "Not used: Two.",
        "To know: Odd.",
    )


def test_of_a_method_without_grids_no_descriptor_is_named():
    assert descriptor_notes(DESCRIPTORS) == ()


@pytest.mark.parametrize("changes", [{"grids": [{"name": "a.x"}]}, {"waiting_descriptors": ["d"]}])
def test_what_descriptors_say(changes):
    notes = descriptor_notes(DESCRIPTORS | changes)

    assert [note.partition(":")[0] for note in notes[-2:]] == [
        "The same on the first batch, up to order, scale and offset",
        "With a single value on the first batch, so that they tell no motions apart",
    ]
    waiting = ("Without a grid, since too few motions defined them: d.",)
    assert notes[:-2] == (waiting if "waiting_descriptors" in changes else ())
