import re

import pytest

from lqd_envs import LQDError
from lqd_search.report import check_report_path, labels_of, render_report, write_report


def test_an_earlier_report_may_be_replaced(new_run, tmp_path):
    path = tmp_path / "report.html"
    write_report(path, render_report([new_run()], rollouts=0))

    check_report_path(path)
    write_report(path, "a lone \udcff surrogate")

    assert path.read_text() == "a lone ? surrogate"


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("report.txt", "Expected the name of an .html file for the report"),
        ("other.html", "or an earlier report, but .* exists already; choose another"),
        ("folder.html", "or an earlier report, but .* exists already; choose another"),
        ("nowhere/report.html", "is in a folder that does not exist"),
        ("other.html/report.html", r"cannot be used \(Not a directory\)"),
    ],
)
def test_any_other_name_is_refused(name, reason, tmp_path):
    (tmp_path / "other.html").write_text("<!DOCTYPE html>")
    (tmp_path / "folder.html").mkdir()

    with pytest.raises(LQDError, match=reason):
        check_report_path(tmp_path / name)


def test_a_report_that_cannot_be_written_is_one_sentence(tmp_path):
    with pytest.raises(LQDError, match=r"Expected to write the report .* choose another with"):
        write_report(tmp_path / "nowhere" / "report.html", "page")


def test_runs_are_called_by_the_names_of_their_folders(tmp_path, monkeypatch):
    folders = [tmp_path / name for name in ("a/run", "b/run", "c")]
    for folder in folders:
        folder.mkdir(parents=True)
    monkeypatch.chdir(folders[2])

    assert labels_of([*folders[:2], type(tmp_path)(".")]) == ("run", "run (2)", "c")
    assert not re.search("/", "".join(labels_of(folders)))


def test_no_two_runs_are_called_the_same(tmp_path):
    folders = [tmp_path / name for name in ("a/run", "b/run", "c/run (2)", "d/run")]

    assert labels_of(folders) == ("run", "run (2)", "run (2) (2)", "run (3)")
    assert labels_of([type(tmp_path)("/")]) == ("run",)
