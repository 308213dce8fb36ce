from dataclasses import replace

from lqd_search.report.curves import FIGURES, curves_of


def test_an_archive_s_line_breaks_between_stages_and_that_of_the_outcomes_does_not(new_run):
    curves = dict(zip(FIGURES, curves_of([new_run()]), strict=True))

    assert curves["coverage"]["lines"][0]["x"] == [32, None, 64, None, 96]
    assert curves["coverage"]["lines"][0]["y"] == [0.25, None, 0.25, None, 0.25]
    assert curves["outcomes"]["lines"][0]["x"] == [32, 64, 96]


def test_a_run_without_grids_has_unbroken_lines_and_no_coverage(new_run):
    run = new_run()
    gridless = replace(run, metrics=tuple(replace(row, coverage=None) for row in run.metrics))

    curves = dict(zip(FIGURES, curves_of([run, gridless]), strict=True))

    assert [line["run"] for line in curves["coverage"]["lines"]] == [0]
    assert curves["success_archive_size"]["lines"][1]["x"] == [32, 64, 96]
