"""The report of made-up cells."""

import csv
import io
import json

import pytest

from benchmarks.tables.ablation_study import ABLATIONS
from benchmarks.tables.box_picture import draw_boxes
from benchmarks.tables.cell import Cell
from benchmarks.tables.comparison_table import comparison_section
from benchmarks.tables.curve_picture import draw_curves
from benchmarks.tables.figure_files import figure_files
from benchmarks.tables.long_form import long_form
from benchmarks.tables.measures import SIZE
from benchmarks.tables.paper_figures import PaperError, PaperFigure, PaperFigures
from benchmarks.tables.report import describe, table_sections, write_report
from benchmarks.tables.results import Results
from benchmarks.tables.study import TABLES
from benchmarks.tables.task_tables import final_archive_table

SIZES = {"ours": (10, 12, 20), "handcrafted": (4, 7, 9)}


@pytest.fixture(scope="module")
def results(study, make_figures) -> Results:
    """Return results in which one cell of the drawer is missing."""
    cells = {
        cell: make_figures(cell, success_archive_size=SIZES[cell.method][cell.seed])
        for cell in study.cells
        if cell != Cell.of("drawer", "handcrafted", 2)
    }
    return Results(study, cells)


@pytest.fixture(scope="module")
def files(results, tmp_path_factory):
    """Return the files of the report."""
    return write_report(tmp_path_factory.mktemp("report"), results, sections=table_sections)


@pytest.fixture(scope="module")
def tables(files) -> str:
    return files[0].read_text()


def section(tables, heading):
    return tables.split(f"\n## {heading}\n")[1].split("\n## ")[0]


def test_the_report_has_tables_and_pictures(files):
    assert [path.name for path in files[:2]] == ["tables.md", "tables.csv"]
    pictures = files[0].parent / "pictures"
    names = sorted(path.name for path in pictures.iterdir())
    assert names == sorted(
        f"{kind}.{task}.{ending}"
        for kind in ("curves", "boxes")
        for task in ("faucet", "drawer")
        for ending in ("png", "svg")
    )
    for path in pictures.iterdir():
        start = path.read_bytes()[:8]
        assert (
            start == b"\x89PNG\r\n\x1a\n" if path.suffix == ".png" else start.startswith(b"<?xml")
        )


def test_the_same_cells_give_the_same_bytes(files, results):
    again = figure_files("curves.faucet", draw_curves(results, "faucet"))

    before = {path.name: path.read_bytes() for path in files}
    assert set(again) == {"curves.faucet.png", "curves.faucet.svg"}
    assert {name: before[name] for name in again} == again
    assert before["tables.csv"].decode() == long_form(results)


def test_means_and_medians_stand_side_by_side(tables):
    table = section(tables, "Faucet: the final archive")

    assert (
        "| ours | 3 | 14.0 ± 5.3 | 12.0 [11.0, 16.0] | 5.0 ± 0.0 | 5.0 [5.0, 5.0] | 160,000 |"
    ) in table
    assert "The paper's own figures are not at hand." in table
    assert "Three of the paper's methods fill exactly 85" in table
    assert "85" not in section(tables, "Drawer: the final archive")


def test_what_is_not_finished_is_said(tables):
    assert "11 of 12 cells are finished" in tables
    assert "| handcrafted | 2 of 3 | 5.5 ± 2.1 |" in section(tables, "Drawer: the final archive")
    assert "2 of the 4 declared comparisons are complete" in tables
    assert "| drawer | success archive size | ours : handcrafted | - | - | - | - |" in tables


def test_a_task_that_was_not_begun_has_one_line_and_no_picture(results, tmp_path):
    cells = {cell: figures for cell, figures in results.cells.items() if cell.task == "faucet"}

    tables, *others = write_report(tmp_path, Results(results.study, cells), sections=table_sections)

    text = tables.read_text()
    assert "\n## Drawer\n\nNo cell of this task is finished.\n" in text
    assert "## Drawer:" not in text
    assert "## Faucet: the outcome archive" in text
    assert "drawer" not in {path.name.split(".")[1] for path in others[1:]}


def test_the_comparisons_are_those_that_were_declared(tables):
    # 3 against 3 that do not overlap: 2 of 20 deals, times 4 declared comparisons.
    assert "ours : handcrafted | 1.00 [1.00, 1.00] | 0.100 | 0.400 | no |" in tables
    assert "the smallest adjusted one 0.400: at this scale no comparison can be" in tables


def test_a_comparison_that_capacity_decides_is_marked(study, make_figures):
    def marks(*sizes, ground_truth_cells=(70, 80, 90), room_of_ours=160_000):
        cells = {
            cell: make_figures(
                cell,
                success_archive_size=sizes[cell.seed] if cell.method == "ours" else 100,
                ground_truth_cells=ground_truth_cells[cell.seed],
                capacity=room_of_ours if cell.method == "ours" else 100,
            )
            for cell in study.cells
        }
        lines = comparison_section(Results(study, cells)).splitlines()
        return [line.rsplit("|", 2)[1].strip() for line in lines if line.startswith("| faucet")]

    # `handcrafted` has room for 100 elites, and so can fill no more than 100 cells.
    assert marks(101, 300, 500) == ["yes", "no"]
    assert marks(100, 300, 500) == ["no", "no"]
    assert marks(101, 300, 500, ground_truth_cells=(101, 200, 300)) == ["yes", "yes"]
    assert marks(101, 300, 500, ground_truth_cells=(100, 200, 300)) == ["yes", "no"]
    # The other one may have more than there is room for in `ours`.
    assert marks(10, 20, 30, room_of_ours=99) == ["yes", "no"]
    assert marks(10, 20, 30, room_of_ours=100) == ["no", "no"]


def test_the_papers_figures_stand_beside_ours_where_they_are_at_hand(results):
    figure = PaperFigure("faucet", "ours", SIZE.name, 41.5, 3.0, "a table")
    paper = PaperFigures((figure,), ())

    table = final_archive_table(results, "faucet", paper=paper)
    assert (
        "| ours | 3 | 14.0 ± 5.3 | 41.5 ± 3 | 12.0 [11.0, 16.0] "
        "| 5.0 ± 0.0 | not at hand | 5.0 [5.0, 5.0] | 160,000 |"
    ) in table
    assert "the paper's" not in final_archive_table(results, "drawer", paper=paper)


def test_at_which_commits_cells_were_run_is_said(study, make_figures):
    def said(*commits):
        cells = {
            c: make_figures(c, commit=one) for c, one in zip(study.cells, commits, strict=False)
        }
        return describe(Results(study, cells))

    assert "\n\nCommit: abc.\n" in said("abc", "abc")
    assert (
        "\n\nCommits, with the number of cells: abc (ours 2); def+ (handcrafted 1); unknown "
        "(handcrafted 1).\n"
    ) in said("abc", "def+", "abc", "")


def test_which_recordings_served_is_said():
    assert "seed k with recording k mod 5." in describe(Results(TABLES["small"], {}))
    assert "seed k with recording k mod 5; 24 cells beside them cross recordings and seeds." in (
        describe(Results(ABLATIONS["small"], {}))
    )


def test_precision_and_recall_leave_out_what_the_expert_steers(tables):
    table = section(tables, "The inferred success condition")

    assert (
        "| faucet | ours | mesh | 3 | 16 | 0.750 ± 0.000 | 0.750 [0.750, 0.750] | 0.562 ± 0.000"
        in table
    )
    assert "handcrafted" not in table


def test_machine_versions_model_and_duration_are_named(tables):
    assert "They took 5.5 hours in all, each on one thread." in tables
    assert "Machine: a machine." in tables
    assert "Versions: python 3.11.0; numpy 2.0." in tables
    assert "Model: a model. Made up for a test." in tables


def test_the_long_form_has_a_row_for_each_cell_and_measure(files):
    rows = list(csv.DictReader(io.StringIO(files[1].read_text())))

    def values(method, measure):
        chosen = [r for r in rows if (r["method"], r["measure"]) == (method, measure)]
        return [r["value"] for r in chosen if r["task"] == "faucet"]

    assert values("ours", "success_archive_size") == ["10", "12", "20"]
    assert {row["role"] for row in rows} == {"compared"}
    assert {(row["method"], row["capacity"]) for row in rows} == {
        ("ours", "160000"),
        ("handcrafted", "100"),
    }
    assert values("ours", "precision") == ["0.75"] * 3
    assert values("handcrafted", "precision") == [""] * 3
    assert {(r["seed"], r["sample"], r["evaluations"], r["scale"]) for r in rows} == {
        (str(seed), str(seed), "320", "smoke") for seed in range(3)
    }


def test_nothing_finished_is_a_report_too(study, tmp_path):
    files = write_report(tmp_path, Results(study, {}), sections=table_sections)

    assert len(files) == 2
    assert "0 of 12 cells are finished" in files[0].read_text()


def test_curves_are_medians_with_a_band_to_the_quartiles(results):
    axes = draw_curves(results, "faucet").axes[0]

    (ours, handcrafted) = axes.get_lines()
    assert ours.get_label() == "ours (3)"
    assert ours.get_xydata().tolist() == [[160.0, 2.0], [320.0, 6.0]]
    assert len(axes.collections) == 2
    assert handcrafted.get_label() == "handcrafted (3)"


def test_boxes_show_every_seed(results):
    axes = draw_boxes(results, "faucet").axes[0]

    assert axes.get_title() == f"final archive: {SIZE.title}"
    points = [line.get_ydata().tolist() for line in axes.get_lines() if line.get_marker() == "."]
    assert points == [[10, 12, 20], [4, 7, 9]]


def test_a_figure_of_the_paper_stands_beside_ours(tmp_path):
    figure = {
        "task": "push", "method": "ga", "measure": "ground_truth_cells",
        "mean": 41.5, "std": 3.0, "source": "a table",
    }  # fmt: skip
    path = tmp_path / "figures.json"
    path.write_text(json.dumps({"figures": [figure], "remarks": []}))

    paper = PaperFigures.load(path)

    assert paper.text("push", "ga", "ground_truth_cells") == "41.5 ± 3"
    assert paper.text("push", "ours", "ground_truth_cells") == "not at hand"


def test_a_figure_without_a_source_is_refused(tmp_path):
    path = tmp_path / "figures.json"
    path.write_text('{"figures": [], "remarks": [{"task": "a", "measure": "b", "text": "c"}]}')

    with pytest.raises(PaperError, match=r"Expected the key 'remarks\[0\]\.source'"):
        PaperFigures.load(path)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"task": "kettle"}, "Expected a task of the paper's figures among grasp, .*'kettle'"),
        ({"method": "best"}, "Expected a method of the paper's figures among ours, .*'best'"),
        ({"measure": "size"}, "Expected a measure of .* among success_archive_size, .*'size'"),
    ],
)
def test_a_name_that_is_none_is_refused(change, message, tmp_path):
    figure = {"task": "push", "method": "ga", "measure": "outcomes", "mean": 1, "std": None}
    path = tmp_path / "figures.json"
    path.write_text(
        json.dumps({"figures": [figure | {"source": "a table"} | change], "remarks": []})
    )

    with pytest.raises(PaperError, match=message):
        PaperFigures.load(path)


def test_a_file_that_is_no_json_is_one_sentence(tmp_path):
    path = tmp_path / "figures.json"
    path.write_text("{")

    with pytest.raises(PaperError, match=r"Expected the paper's figures in .*; correct the file"):
        PaperFigures.load(path)


def test_no_figure_is_claimed_to_be_the_papers_without_a_source():
    paper = PaperFigures.load()

    assert paper.figures == ()
    assert all(remark.source for remark in paper.remarks)
