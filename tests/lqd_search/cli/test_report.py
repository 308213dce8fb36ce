"""`lqd report`."""

import json
import re


def report_of(path):
    found = re.search(
        r'<script id="data" type="application/json">(.*?)</script>', path.read_text("utf-8")
    )
    return json.loads(found[1])


def test_a_report_shows_the_run(run, call, tmp_path):
    path = tmp_path / "report.html"

    status, out, err = call("report", run[0], "--rollouts", 1, "--out", path)

    assert (status, out, err) == (0, f"report: {path}\n", "")
    (shown,) = report_of(path)["runs"]
    summary = json.loads((run[0] / "summary.json").read_text())
    assert shown["label"] == run[0].name
    assert [grid["name"] for grid in shown["maps"][1:]] == [g["name"] for g in summary["grids"]]
    assert shown["maps"][0]["filled"] == summary["ground_truth_cells"]
    assert all(motion["same"] for motion in shown["rollouts"])
    functionals = len(list((run[0] / "functionals").glob("*.py")))
    assert path.read_text("utf-8").count('<pre class="source">') == functionals > 0


def test_a_second_report_of_the_same_runs_is_the_same_file(run, call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    arguments = ("report", run[0], run[0], "--rollouts", 0)

    first = call(*arguments)
    content = (tmp_path / "report.html").read_bytes()

    assert first == call(*arguments) == (0, "report: report.html\n", "")
    assert (tmp_path / "report.html").read_bytes() == content


def test_the_report_of_one_run_is_in_its_folder(run, call):
    status, out, _ = call("report", run[0], "--rollouts", 0)

    assert (status, out) == (0, f"report: {run[0] / 'report.html'}\n")
    (run[0] / "report.html").unlink()


def test_a_run_that_is_not_finished_is_refused(stopped, call, tmp_path):
    status, out, err = call("report", stopped[0], "--out", tmp_path / "report.html")

    assert (status, out) == (2, "")
    assert re.match(r"lqd: Expected a finished run in \S+, but it has not finished", err)
    assert not list(tmp_path.iterdir())


def test_another_file_is_not_replaced(run, call, tmp_path):
    path = tmp_path / "page.html"
    path.write_text("mine")

    status, out, err = call("report", run[0], "--out", path)

    assert (status, out, path.read_text()) == (2, "", "mine")
    assert re.fullmatch(
        r"lqd: Expected a new file for the report, or an earlier report, but [^\n]+\n", err
    )
