from dataclasses import replace

from lqd_search.report.figures import figure_rows, notes, settings_rows


def test_rows_of_several_runs_stand_where_the_run_that_has_them_has_them(new_run):
    one, two = new_run("one"), new_run("two")
    two = replace(two, summary=two.summary | {"exploration": {"other": 1200}})

    rows = {row.name: row.cells for row in figure_rows([one, two])}

    names = list(rows)
    assert rows["found when exploring flat"] == ("3 (kept)", "")
    assert rows["found when exploring other"] == ("", "1,200")
    assert names.index("found when exploring flat") < names.index("seconds") == len(names) - 1


def test_precision_and_recall_are_shares_of_the_verdicts(new_run):
    run = new_run()
    verdicts = {"both": 3, "inferred_only": 1, "expert_only": 0, "neither": 5}
    run = replace(run, summary=run.summary | {"confusion": verdicts})

    rows = {row.name: row.cells for row in figure_rows([run])}

    assert rows["inferred condition's precision, valid motions"] == ("75.0%",)
    assert rows["inferred condition's recall, valid motions"] == ("100.0%",)


def test_solutions_out_of_range_are_summed_over_the_grids(new_run):
    run = new_run()
    grids = [run.summary["grids"][0] | {"clipped": count} for count in (1000, 34)]
    run = replace(run, summary=run.summary | {"grids": grids})

    rows = {row.name: row.cells for row in figure_rows([run])}

    assert rows["solutions out of range, over all grids"] == ("1,034",)


def test_a_setting_that_no_run_has_is_left_out(new_run):
    run = new_run()
    rows = settings_rows([replace(run, config=replace(run.config, usage_in_words=""))])

    assert "usage" not in {row.name for row in rows}
    assert ("model", ("plain",)) in {(row.name, row.cells) for row in rows}
    assert not any(row.shared for row in rows)
    assert all(row.shared for row in settings_rows([run, run]))


def test_what_is_part_of_another_figure_is_named_after_it(new_run):
    names = [row.name for row in figure_rows([new_run()])]

    assert "distinct elites: inferred successes" in names
    assert "ground-truth cells: successes outside that grid" in names
    assert len(set(names)) == len(names)


def test_where_the_expert_steered_the_notes_say_whose_condition_it_is(new_run):
    run = new_run()
    sentence = "Steered by the expert; the inferred condition here is the expert's own."

    assert sentence not in notes(run)
    assert sentence in notes(replace(run, summary=run.summary | {"llm": "none"}))


def test_notes_say_what_was_dropped_refused_and_found_alike(new_run):
    sentences = "\n".join(notes(new_run()))

    assert "Not used: plain" in sentences
    assert "Refused values of plain plain: 3 (plain)." in sentences
    assert "Without a grid, since too few motions defined them: plain." in sentences
