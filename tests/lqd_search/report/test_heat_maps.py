import numpy as np

from lqd_envs import GroundTruth
from lqd_search.archives.grid_spec import GridSpec
from lqd_search.report.heat_maps import grid_map, ground_truth_map
from lqd_search.runs.stored_archive import StoredArchive, StoredGrid

FIELDS = {
    "solution": np.zeros((4, 9)),
    "objective": np.array([0.5, 0.25, np.nan, 0.75]),
    "success": np.array([True, True, False, False]),
    "expert": np.array([True, False, False, True]),
    "evaluation": np.array([10, 20, 30, 40]),
    "ground_truth": np.array([[0.1], [0.1], [0.9], [5.0]]),
}


def map_of(dims, cells, elites):
    spec = GridSpec(dims=dims, ranges=((0.0, 1.0),) * len(dims))
    grid = StoredGrid(
        spec,
        np.array(cells, np.int64),
        np.array(elites, np.int64),
        np.zeros((len(cells), len(dims))),
    )
    return grid_map("end.place", grid, fields=FIELDS)


def test_a_place_of_a_flat_grid_has_its_cell_s_values():
    drawn = map_of((3, 2), [1, 4], [0, 2])

    assert drawn["title"] == "2 of 6 cells are filled, 1 with a success"
    assert drawn["panels"] == [
        {
            "axes": [0, 1],
            "place": [1, 4],
            "filled": [1, 1],
            "successes": [1, 0],
            "experts": [1, 0],
            "best": [0.5, None],
            "elite": [0, 2],
            "evaluation": [10, 30],
        }
    ]


def test_cells_behind_one_another_are_one_place_with_its_best_success():
    # All but the last lie behind one another along the last axis.
    drawn = map_of((2, 2, 4), [0, 1, 2, 15], [3, 1, 0, 2])

    along_last = drawn["panels"][0]
    assert [panel["axes"] for panel in drawn["panels"]] == [[0, 1], [0, 2], [1, 2]]
    assert along_last["place"] == [0, 3]
    assert (along_last["filled"], along_last["successes"]) == ([3, 1], [2, 0])
    # The fittest of all is no success.
    assert (along_last["elite"][0], along_last["best"][0]) == (0, 0.5)
    assert [sum(panel["filled"]) for panel in drawn["panels"]] == [4, 4, 4]


def test_a_grid_of_one_measure_has_one_panel_along_it():
    (panel,) = map_of((5,), [0, 3], [0, 1])["panels"]

    assert (panel["axes"], panel["place"]) == ([0], [0, 3])


def test_a_grid_without_elites_has_empty_panels():
    drawn = map_of((2, 2, 2), [], [])

    assert len(drawn["panels"]) == 3
    assert not any(column for panel in drawn["panels"] for column in list(panel.values())[1:])


def test_the_ground_truth_holds_what_the_expert_approves_within_its_grid():
    ground_truth = GroundTruth(lambda _: np.zeros((0, 1)), ("angle (rad)",), (10,), ((0.0, 1.0),))

    drawn = ground_truth_map(ground_truth, archive=StoredArchive(FIELDS, {}))

    assert drawn["title"] == "1 of 10 cells are filled; successes in them: 1"
    assert drawn["axes"] == ["angle (rad)"]
    assert (drawn["panels"][0]["place"], drawn["panels"][0]["elite"]) == ([1], [0])
