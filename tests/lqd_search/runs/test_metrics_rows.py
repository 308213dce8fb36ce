import re

import pytest

from lqd_search.runs.metrics_file import MetricsFile
from lqd_search.runs.metrics_rows import read_metrics
from lqd_search.runs.run_folder_error import RunFolderError


def test_rows_are_read_as_they_were_written(make_metrics, tmp_path):
    rows = (make_metrics(1, stage='a, "b"'), make_metrics(2, coverage=None, seconds=1e-7))
    MetricsFile(tmp_path / "metrics.csv").write(rows)

    assert read_metrics(tmp_path / "metrics.csv") == rows


@pytest.mark.parametrize(
    "damage",
    [
        lambda text: text.replace(b"2,", b"two,"),
        lambda text: text[:-30],
        lambda text: text.replace(b"coverage", b"cover"),
        lambda text: text + b"\xff",
    ],
    ids=["word", "cut", "column", "bytes"],
)
def test_damaged_rows_are_one_sentence(damage, make_metrics, tmp_path):
    path = tmp_path / "metrics.csv"
    MetricsFile(path).write([make_metrics(1), make_metrics(2)])
    path.write_bytes(damage(path.read_bytes()))

    with pytest.raises(RunFolderError, match=r"^Expected a row of figures .* cannot be read \(\w+"):
        read_metrics(path)


def test_missing_rows_are_one_sentence(tmp_path):
    with pytest.raises(RunFolderError, match="restore the file, or run the search again"):
        read_metrics(tmp_path / "metrics.csv")


@pytest.mark.parametrize(
    ("damage", "reason"),
    [
        (lambda _: b"", "ValueError: no column generation, stage, "),
        (lambda text: text.partition(b"\n")[2], "ValueError: no column generation, "),
        (lambda text: bytes(len(text)), "ValueError: no column "),
        (lambda text: text.replace(b"0.25", b"nan"), "ValueError: no finite number: 'nan'"),
        (lambda text: text.replace(b"0.25", b"-inf"), "ValueError: no finite number: '-inf'"),
        (lambda text: text.replace(b"1.5", b"inf"), "ValueError: no finite number: 'inf'"),
    ],
    ids=["empty", "head", "zeros", "coverage", "infinity", "seconds"],
)
def test_what_is_no_row_of_figures_is_named(damage, reason, make_metrics, tmp_path):
    path = tmp_path / "metrics.csv"
    MetricsFile(path).write([make_metrics(1), make_metrics(2)])
    path.write_bytes(damage(path.read_bytes()))

    with pytest.raises(RunFolderError, match=re.escape(f"cannot be read ({reason}")):
        read_metrics(path)


@pytest.mark.parametrize(("rows", "last"), [(0, 0), (1, 32), (3, 96)])
def test_rows_that_do_not_end_with_the_run_are_refused(rows, last, make_metrics, tmp_path):
    path = tmp_path / "metrics.csv"
    MetricsFile(path).write([make_metrics(1 + i) for i in range(rows)])

    assert len(read_metrics(path)) == len(read_metrics(path, evaluations=last)) == rows
    with pytest.raises(RunFolderError, match=f"its rows end after {last} of 64 evaluations"):
        read_metrics(path, evaluations=64)
