from dataclasses import replace

from lqd_search.report.listings import listings_of
from lqd_search.runs.function_text import FunctionText


def test_each_functional_has_a_title_its_description_and_its_source(new_run):
    functionals = (
        FunctionText("success", "success", "It is < there.", "def success(_):\n    return 1 < 2\n"),
        FunctionText("quantity", "place", "Where it is.", "def quantity(_): ..."),
        FunctionText("direct.success", "success", "", "def success(_): ..."),
    )

    (group,) = listings_of([new_run(functionals=functionals)])

    titles = [(listing.title, listing.description) for listing in group.listings]
    assert titles == [
        ("success", "It is < there."),
        ("quantity place", "Where it is."),
        ("direct success", ""),
    ]
    assert "&lt;" in group.listings[0].code
    assert '<span class="k">return</span>' in group.listings[0].code


def test_runs_of_the_same_functionals_share_them(new_run):
    one, two, three = (new_run(label) for label in ("one", "two", "three"))
    two = replace(two, functionals=(FunctionText("success", "success", "Other.", "x = 1"),))
    none = new_run("none", functionals=())

    groups = listings_of([one, two, three, none])

    assert [group.runs for group in groups] == [("one", "three"), ("two",)]
