import numpy as np
import pytest

from lqd_search.grid_spec import GridSpec
from lqd_search.stored_archive import StoredArchive, StoredArchiveError, StoredGrid


def small_archive() -> StoredArchive:
    return StoredArchive(
        fields={
            "solution": np.arange(27.0).reshape(3, 9),
            "objective": np.array([0.5, -1.0, 2.0]),
            "success": np.array([True, False, True]),
        },
        grids={
            "start.pose": StoredGrid(
                spec=GridSpec(dims=(4, 5), ranges=((0.0, 1.0), (-2.0, 2.0))),
                cells=np.array([0, 7, 19]),
                elites=np.array([2, 0, 1]),
                measures=np.array([[0.1, -1.9], [0.3, -0.5], [0.9, 1.9]]),
            )
        },
    )


def test_what_is_read_is_what_was_written(tmp_path):
    archive = small_archive()
    path = tmp_path / "archive.npz"
    path.write_bytes(archive.to_bytes())

    read = StoredArchive.load(path)

    assert len(read) == 3
    assert read.fields.keys() == archive.fields.keys()
    for name, column in archive.fields.items():
        np.testing.assert_array_equal(read.fields[name], column)
        assert read.fields[name].dtype == column.dtype
    grid, expected = read.grids["start.pose"], archive.grids["start.pose"]
    assert grid.spec == expected.spec
    np.testing.assert_array_equal(grid.cells, expected.cells)
    np.testing.assert_array_equal(grid.elites, expected.elites)
    np.testing.assert_array_equal(grid.measures, expected.measures)


def test_equal_archives_give_equal_bytes():
    assert small_archive().to_bytes() == small_archive().to_bytes()


def test_numpy_reads_it_without_pickle(tmp_path):
    path = tmp_path / "archive.npz"
    path.write_bytes(small_archive().to_bytes())

    with np.load(path, allow_pickle=False) as file:
        assert file["grids/start.pose/dims"].tolist() == [4, 5]
        assert file["elites/success"].tolist() == [True, False, True]


@pytest.mark.parametrize("cut", [0, 10, 200])
def test_a_truncated_file_is_named(tmp_path, cut):
    path = tmp_path / "archive.npz"
    path.write_bytes(small_archive().to_bytes()[:cut])

    with pytest.raises(StoredArchiveError, match=r"Expected an archive in .*archive\.npz"):
        StoredArchive.load(path)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(StoredArchiveError, match="cannot be read"):
        StoredArchive.load(tmp_path / "archive.npz")


def test_a_file_of_another_form_is_refused(tmp_path):
    path = tmp_path / "archive.npz"
    np.savez(path, other=np.zeros(3))

    with pytest.raises(StoredArchiveError, match="solution"):
        StoredArchive.load(path)
