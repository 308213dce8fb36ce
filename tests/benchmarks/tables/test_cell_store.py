import subprocess
import sys
from dataclasses import replace

import pytest

from benchmarks.tables.cell import Cell
from benchmarks.tables.cell_figures import CellError
from benchmarks.tables.cell_store import CellStore
from lqd_search.methods.by_name import METHODS

CELL = Cell.of("faucet", "ours", 3)


@pytest.fixture
def store(tmp_path) -> CellStore:
    store = CellStore(tmp_path / "out", 320, 8)
    store.prepare()
    return store


def test_what_is_kept_is_there_again(store, make_figures):
    assert store.load([CELL]) == {}

    path = store.keep(make_figures(CELL))

    assert path == store.out / "cells" / "faucet.ours.seed-3.sample-3.json"
    assert store.load([Cell.of("faucet", "ours", 4), CELL]) == {CELL: make_figures(CELL)}


def test_the_runs_are_not_for_a_repository(store):
    assert (store.out / "runs" / ".gitignore").read_text() == "*\n"
    store.prepare()


def test_a_folder_has_the_cells_of_one_scale(store, make_figures):
    with pytest.raises(CellError, match=r"Expected a cell of 320 .*, but got one of 640, 8 a"):
        store.keep(make_figures(CELL, evaluations=640))
    with pytest.raises(CellError, match=r", 8 a generation, in .*, but got one of 320, 16 a gen"):
        store.keep(make_figures(CELL, batch_size=16))

    store.keep(make_figures(CELL))
    with pytest.raises(
        CellError, match=r"of 640 .*, but got one of 320, 8 a generation; name a folder of the"
    ):
        replace(store, evaluations=640).load([CELL])


def test_a_file_in_the_place_of_another_cell_is_refused(store, make_figures):
    path = store.keep(make_figures(CELL))
    path.rename(path.with_name("faucet.ours.seed-4.sample-4.json"))

    with pytest.raises(
        CellError, match=r"the cell faucet\.ours\.seed-4.*seed-3.*; delete the file"
    ):
        store.load([Cell.of("faucet", "ours", 4)])


def test_other_switches_than_the_method_has_now_are_refused(store, make_figures):
    message = r"Expected the switches none of ours in .*, but it was run with line\+screen; delete"
    with pytest.raises(CellError, match=message):
        store.keep(make_figures(CELL, switches=("line", "screen")))

    plus = Cell.of("faucet", "ours_plus", 3)
    kept = tuple(sorted(METHODS["ours_plus"].switches))
    store.keep(make_figures(plus, switches=kept))
    with pytest.raises(CellError, match=r"of ours_plus in .*, but it was run with random; delete"):
        store.keep(make_figures(plus, switches=("random",)))


def test_a_variant_of_ours_has_no_switches(store, make_figures):
    store.keep(make_figures(Cell.of("faucet", "one_grid", 3)))


def test_cells_of_a_recording_have_its_functionals(store, make_figures):
    cells = [CELL, Cell.of("faucet", "ours", 8), Cell.of("faucet", "random", 3)]
    store.keep(make_figures(cells[0], functionals="new"))
    store.keep(make_figures(cells[2], functionals="new"))
    # Those of another steering are of no account.
    store.keep(make_figures(Cell.of("faucet", "direct", 3), functionals="", steering="direct"))
    assert len(store.load(cells)) == 2

    message = (
        r"in the cells faucet\.ours\.seed-3\S+ and .*seed-8\S+, .* new and old; of those that are "
        r"out of date, delete the files in \S+/cells and the folders in \S+/runs"
    )
    with pytest.raises(CellError, match=message):
        store.keep(make_figures(cells[1], functionals="old"))
    assert len(store.load(cells)) == 2

    other = store.out / "cells" / f"{cells[1].name}.json"
    other.write_text(make_figures(cells[1], functionals="old").to_json())
    with pytest.raises(CellError, match=message):
        store.load(cells)


def test_a_damaged_file_is_named(store, make_figures):
    path = store.keep(make_figures(CELL))
    path.write_text("{}")

    with pytest.raises(CellError, match=r"seed-3\.sample-3\.json: Expected the figures of a cell"):
        store.load([CELL])


def test_a_cell_is_held_by_one_at_a_time(store):
    with store.claim(CELL) as lock:
        assert lock is not None
        with store.claim(CELL) as other:
            assert other is None
        with store.claim(Cell.of("faucet", "ours", 4)) as another:
            assert another is not None
    with store.claim(CELL) as lock:
        assert lock is not None


def test_a_process_that_outlives_its_parent_still_holds_its_cell(store):
    with store.claim(CELL) as lock:
        child = subprocess.Popen(
            [sys.executable, "-S", "-c", "input()"], stdin=subprocess.PIPE, pass_fds=(lock,)
        )
    with child:
        with store.claim(CELL) as other:
            assert other is None
        child.communicate(b"\n")
    with store.claim(CELL) as lock:
        assert lock is not None
