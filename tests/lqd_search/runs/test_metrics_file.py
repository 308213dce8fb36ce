import csv

import pytest

from lqd_search.runs.metrics_file import MetricsFile
from lqd_search.runs.run_folder_error import RunFolderError


@pytest.fixture
def file(tmp_path):
    return MetricsFile(tmp_path / "metrics.csv")


def rows_of(file):
    with file.path.open(newline="") as opened:
        return list(csv.DictReader(opened))


def test_it_grows_by_a_complete_row_a_generation(file, make_metrics):
    file.write([])
    for generation in range(1, 5):
        file.append(make_metrics(generation, stage='exploring "a", then b'))

        assert file.path.read_bytes().endswith(b",1.5\r\n")
        assert [row["generation"] for row in rows_of(file)] == [
            str(i) for i in range(1, generation + 1)
        ]
    assert rows_of(file)[1]["evaluations"] == "64"
    assert rows_of(file)[1]["coverage"] == "0.25"
    assert rows_of(file)[1]["stage"] == 'exploring "a", then b'


def test_what_is_written_anew_is_what_was_appended(file, make_metrics, tmp_path):
    rows = [make_metrics(1, coverage=1 / 3), make_metrics(2, coverage=None)]
    other = MetricsFile(tmp_path / "other.csv")
    file.write([])
    for row in rows:
        file.append(row)
    other.write(rows)

    assert file.path.read_bytes() == other.path.read_bytes()
    assert [row["coverage"] for row in rows_of(file)] == [repr(1 / 3), ""]


def test_half_a_row_is_gone_when_it_is_written_anew(file, make_metrics):
    file.write([make_metrics(1)])
    whole = file.path.read_bytes()
    with file.path.open("ab") as opened:
        opened.write(b"2,explo")

    file.write([make_metrics(1)])

    assert file.path.read_bytes() == whole


def test_a_full_disk_is_one_sentence(file, make_metrics):
    file.path.symlink_to("/dev/full")

    with pytest.raises(RunFolderError, match=r"failed \(No space left on device\); see to the"):
        file.append(make_metrics())
