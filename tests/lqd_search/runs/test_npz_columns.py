import io

import numpy as np
import pytest

from lqd_search.runs.npz_columns import ColumnError, column_of, read_columns


def content():
    buffer = io.BytesIO()
    np.savez(buffer, one=np.arange(3), two=np.array([[0.5]]))
    return bytearray(buffer.getvalue())


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_what_is_read_is_what_was_written(tmp_path, save):
    columns = {"a/b": np.arange(3), "c": np.array([[0.5]]), "d": np.array([True])}
    save(tmp_path / "file.npz", **columns)

    read = read_columns(tmp_path / "file.npz")

    assert {name: (c.dtype, c.tolist()) for name, c in read.items()} == {
        "a/b": (np.int64, [0, 1, 2]),
        "c": (np.float64, [[0.5]]),
        "d": (np.bool_, [True]),
    }


def test_a_member_that_damage_hides_is_missed(tmp_path):
    damaged = content()
    damaged[damaged.rindex(b"one.npy") - 46 + 32] = 46 + len(b"two.npy")
    (tmp_path / "file.npz").write_bytes(damaged)

    with pytest.raises(ColumnError, match=r"^expected 2 columns, but there are 1$"):
        read_columns(tmp_path / "file.npz")


def test_a_missing_file_says_so(tmp_path):
    with pytest.raises(ColumnError, match=r"^No such file or directory$"):
        read_columns(tmp_path / "file.npz")


@pytest.mark.parametrize("end", [0, 1, 100, -1])
def test_a_truncated_file_is_refused(tmp_path, end):
    (tmp_path / "file.npz").write_bytes(content()[:end])

    with pytest.raises(ColumnError):
        read_columns(tmp_path / "file.npz")


@pytest.mark.parametrize(
    ("name", "dtype", "ndim", "message"),
    [
        ("two", np.int64, 1, "expected a column two, but there is none"),
        ("one", np.float64, 1, "expected 1 dimensions of float64 in one, got 1 of int64"),
        ("one", np.int64, 2, "expected 2 dimensions of int64 in one, got 1 of int64"),
    ],
)
def test_a_column_is_checked(name, dtype, ndim, message):
    columns = {"one": np.arange(3)}

    assert column_of(columns, "one", dtype=np.int64, ndim=1) is columns["one"]
    with pytest.raises(ColumnError, match=f"^{message}$"):
        column_of(columns, name, dtype=dtype, ndim=ndim)
