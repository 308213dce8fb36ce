import json
import math

import pytest

from benchmarks.tables.cell import Cell
from benchmarks.tables.cell_figures import CellError, CellFigures, Verdicts
from benchmarks.tables.measures import BY_NAME, MEASURES

CELL = Cell.of("faucet", "ours", 7)


def test_seed_k_goes_with_recording_k_modulo_5():
    assert (CELL.seed, CELL.sample) == (7, 2)
    assert CELL.name == "faucet.ours.seed-7.sample-2"
    assert CELL.task_id == "LQD/Faucet-v0"


def test_what_is_written_is_read_again(make_figures):
    figures = make_figures(CELL)

    assert CellFigures.from_json(figures.to_json()) == figures
    assert figures.cell == CELL


def test_what_another_version_wrote_beside_is_left_out(make_figures):
    figures = make_figures(CELL)
    data = json.loads(figures.to_json())
    for part in (data, data["motions"], data["elites"]):
        part["new"] = 1
    data["curve"]["new"] = [1, 2]

    assert CellFigures.from_json(json.dumps(data)) == figures


@pytest.mark.parametrize(
    ("harm", "message"),
    [
        (lambda data: data.pop("curve"), "Expected the key 'curve'"),
        (lambda data: data.update(valid="many"), "Expected an integer at 'valid'"),
        (lambda data: data["motions"].update(both=None), "Expected an integer at 'motions.both'"),
    ],
)
def test_a_damaged_file_is_one_sentence(make_figures, harm, message):
    data = json.loads(make_figures(CELL).to_json())
    harm(data)

    with pytest.raises(CellError, match=message):
        CellFigures.from_json(json.dumps(data))


def test_what_is_no_json_is_one_sentence():
    with pytest.raises(CellError, match="Expected the figures of a cell, but they cannot be read"):
        CellFigures.from_json("{")


def value(name, figures):
    return BY_NAME[name].of(figures)


def test_precision_and_recall_are_judged_by_the_expert(make_figures):
    figures = make_figures(CELL)

    assert value("precision", figures) == 9 / 12
    assert value("recall", figures) == 9 / 16
    assert value("elite_precision", figures) == 6 / 8
    assert value("elite_recall", figures) == 1.0


def test_where_there_is_no_inferred_condition_they_are_not_defined(make_figures):
    by_the_expert = make_figures(Cell.of("faucet", "handcrafted", 0))
    nothing_found = make_figures(CELL, motions=Verdicts(0, 0, 0, 110))

    for figures in (by_the_expert, nothing_found):
        assert math.isnan(value("precision", figures))
        assert math.isnan(value("recall", figures))


def test_every_measure_has_a_name_of_its_own():
    assert len(BY_NAME) == len(MEASURES)
