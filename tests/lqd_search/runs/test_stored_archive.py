import io
import re

import numpy as np
import pytest

from lqd_search.archives.grid_spec import GridSpec
from lqd_search.archives.multi_bd_archive import MultiBDArchive
from lqd_search.runs.stored_archive import StoredArchive, StoredArchiveError, StoredGrid

FIELDS = ("solution", "objective", "success", "evaluation")


def small_archive() -> StoredArchive:
    return StoredArchive(
        fields={
            "solution": np.arange(27.0).reshape(3, 9),
            "objective": np.array([0.5, -1.0, 2.0]),
            "success": np.array([True, False, True]),
            "evaluation": np.array([4, 5, 9]),
            "expert": np.array([True, False, False]),
            "ground_truth": np.array([[0.1], [np.nan], [0.3]]),
            "digest": np.array([1, 2, 3], np.uint64),
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

    read = StoredArchive.load(str(path))

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


def test_a_column_of_objects_is_not_written():
    archive = small_archive()
    fields = {**archive.fields, "objective": np.array([object()] * 3)}

    with pytest.raises(ValueError, match="allow_pickle=False"):
        StoredArchive(fields, archive.grids).to_bytes()


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


SENTENCE = re.compile(r"Expected an archive in \S+archive\.npz, but [^\n]+; run the search again\.")


def refusal(path):
    """Load what must be refused, and return the one sentence that says why."""
    with pytest.raises(StoredArchiveError) as caught:
        StoredArchive.load(path)
    assert SENTENCE.fullmatch(str(caught.value))
    return str(caught.value)


def columns_of(archive):
    with np.load(io.BytesIO(archive.to_bytes())) as file:
        return {name: file[name] for name in file.files}


def same(one, other):
    return all(np.array_equal(a, b, equal_nan=True) for a, b in zip(one, other, strict=True))


def test_a_flipped_byte_is_found_or_harmless(tmp_path):
    path, content = tmp_path / "archive.npz", small_archive().to_bytes()
    read, sentences = [], []
    for i in range(len(content)):
        flip = (0x01, 0x08, 0xFF)[i % 3]
        path.write_bytes(content[:i] + bytes([content[i] ^ flip]) + content[i + 1 :])
        try:
            read.append(StoredArchive.load(path))
        except StoredArchiveError as error:
            sentences.append(str(error))
    assert len(sentences) > len(read) > 0
    assert all(SENTENCE.fullmatch(sentence) for sentence in sentences)
    for archive in read:
        assert same(archive.fields.values(), small_archive().fields.values())


def test_an_archive_without_passive_columns_is_read_again(tmp_path):
    fields = {name: small_archive().fields[name] for name in FIELDS}
    own = StoredArchive(fields=fields, grids=small_archive().grids)
    (tmp_path / "own.npz").write_bytes(own.to_bytes())

    read = StoredArchive.load(tmp_path / "own.npz")

    assert tuple(read.fields) == FIELDS
    assert same(read.fields.values(), fields.values())


def test_a_single_array_in_its_place_is_refused(tmp_path):
    path = tmp_path / "archive.npz"
    with path.open("wb") as file:
        np.save(file, np.zeros(3))

    assert "cannot be read" in refusal(path)


@pytest.mark.parametrize(
    "name",
    [
        *(f"elites/{field}" for field in FIELDS),
        *(f"grids/start.pose/{key}" for key in ("ranges", "cells", "elites", "measures")),
    ],
)
def test_a_missing_column_is_named(tmp_path, name):
    columns = columns_of(small_archive())
    del columns[name]
    np.savez(tmp_path / "archive.npz", **columns)

    assert f"expected a column {name}, but there is none" in refusal(tmp_path / "archive.npz")


@pytest.mark.parametrize(
    ("name", "column", "message"),
    [
        ("elites/digest", np.zeros(2, np.uint64), "as many rows in elites/digest as in"),
        ("elites/expert", np.zeros(3), "1 dimensions of bool in elites/expert, got 1 of float64"),
        ("elites/solution", np.zeros(3), "2 dimensions of float64 in elites/solution, got 1 of"),
        ("elites/success", np.array(["a", "b", "c"]), "1 dimensions of bool in elites/success"),
        ("elites/other", np.array(3.0), "as many rows in elites/other"),
        ("grids/start.pose/cells", np.array([0, 7, 20]), "from 0 to 19 in grids/start.pose/cells"),
        ("grids/start.pose/elites", np.array([0, 1, 3]), "from 0 to 2 in grids/start.pose/elites"),
        ("grids/start.pose/elites", np.array([0, 1]), "as many rows in grids/start.pose/elites"),
        ("grids/start.pose/measures", np.zeros((3, 1)), "a row of measures for each cell"),
        ("grids/start.pose/ranges", np.zeros((2, 3)), "two bounds for each dimension"),
        ("grids/start.pose/ranges", np.zeros((2, 2)), "finite lower bound below"),
    ],
)
def test_a_column_of_another_form_is_named(tmp_path, name, column, message):
    np.savez(tmp_path / "archive.npz", **columns_of(small_archive()) | {name: column})

    assert message in refusal(tmp_path / "archive.npz")


def test_a_column_that_damage_hides_is_missed(tmp_path):
    content = bytearray(small_archive().to_bytes())
    # The last column but one says in the zip's directory that its comment is as long as the entry
    # of the last one.
    last, hidden = b"grids/start.pose/measures.npy", b"grids/start.pose/elites.npy"
    content[content.rindex(hidden) - 46 + 32] = 46 + len(last)
    (tmp_path / "archive.npz").write_bytes(content)

    assert "(expected 12 columns, but there are 11)" in refusal(tmp_path / "archive.npz")


class Method:
    def __init__(self, archive, output):
        self.archive, self._output = archive, output

    def output(self):
        return self._output


def test_what_a_method_without_an_archive_puts_out_is_stored_without_grids(tmp_path):
    fields = dict(small_archive().fields)
    (tmp_path / "archive.npz").write_bytes(StoredArchive.of(Method(None, fields)).to_bytes())

    read = StoredArchive.load(tmp_path / "archive.npz")

    assert read.grids == {}
    assert same(read.fields.values(), fields.values())


def test_of_a_method_with_an_archive_the_elites_and_their_grids_are_stored():
    archive = MultiBDArchive(
        descriptors={"end.place": 2, "end.none": 2},
        solution_dim=3,
        extra_fields={"evaluation": ((), np.int64)},
        seed=0,
    )
    spec = GridSpec(dims=(2, 2), ranges=((0.0, 1.0), (0.0, 1.0)))
    archive.set_grid("end.place", spec)
    places = np.array([[0.1, 0.1], [0.9, 0.9]])
    archive.add(
        np.arange(6.0).reshape(2, 3),
        np.array([0.5, 0.7]),
        np.hstack([places, np.full((2, 2), np.nan)]),
        success=np.array([True, False]),
        evaluation=np.array([4, 5]),
    )

    stored = StoredArchive.of(Method(archive, None))

    assert stored.fields["evaluation"].tolist() == [4, 5]
    grid = stored.grids["end.place"]
    assert stored.grids.keys() == {"end.place"}
    assert grid.spec == spec
    assert (grid.cells.tolist(), grid.cells.dtype) == ([0, 3], np.int64)
    assert (grid.elites.tolist(), grid.elites.dtype) == ([0, 1], np.int64)
    assert grid.measures.tolist() == places.tolist()
