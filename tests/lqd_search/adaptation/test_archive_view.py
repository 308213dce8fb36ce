"""What a selector may see of an archive."""

import dataclasses
from dataclasses import fields

import numpy as np

from lqd_search.adaptation import ArchiveView
from lqd_search.archives.grid_spec import GridSpec


def test_it_has_no_expert_and_no_ground_truth(make_archive):
    archive = make_archive()

    view = ArchiveView.of(archive)

    names = {field.name for field in fields(view)}
    assert names == {"solution", "objective", "success", "digest", "measures"}
    assert not hasattr(view, "__dict__") or set(vars(view)) == names
    for forbidden in ("expert", "ground_truth"):
        column = archive.fields[forbidden]
        assert not any(np.shares_memory(column, getattr(view, n)) for n in names - {"measures"})


def test_measures_are_shares_of_the_ranges_and_nan_where_a_motion_holds_no_cell(
    make_archive, make_grid
):
    view = ArchiveView.of(make_archive(4, grids={"h.g": make_grid([2, 0], [5.0, 12.0])}))

    assert np.array_equal(view.measures["h.g"], [[1.0], [np.nan], [0.5], [np.nan]], equal_nan=True)


def test_rows_come_in_the_order_asked_for(make_archive, make_grid):
    archive = make_archive(4, grids={"h.g": make_grid([2, 0], [5.0, 1.0])})

    chosen = ArchiveView.of(archive).rows(np.array([2, 0]))

    assert len(chosen) == 2
    assert chosen.objective.tolist() == archive.fields["objective"][[2, 0]].tolist()
    assert chosen.digest.tolist() == [2, 0]
    assert chosen.measures["h.g"].tolist() == [[0.5], [0.1]]


def test_a_measure_far_out_of_range_is_at_the_edge(make_archive, make_grid):
    grid = make_grid([0, 1, 2], [1e308, -1e308, 10.5])
    narrow = dataclasses.replace(grid, spec=GridSpec(dims=(10,), ranges=((0.0, 1e-3),)))

    view = ArchiveView.of(make_archive(3, grids={"h.g": narrow}))

    assert view.measures["h.g"].tolist() == [[1.0], [0.0], [1.0]]
