import io
import re

import numpy as np
import pytest

from lqd_search.runs.stored_outcomes import (
    OutcomeError,
    load_outcomes,
    read_segments,
    to_bytes,
    write_segment,
)


def outcomes(n=3, *, first=4):
    count = np.arange(n)
    return {
        "solution": (first + np.arange(9.0 * n)).reshape(n, 9),
        "evaluation": first + count,
        "success": count % 2 == 0,
        "expert": count < 2,
        "ground_truth": np.where(count == 1, np.nan, 0.5)[:, None],
        "digest": count.astype(np.uint64),
        "fitness/near": np.where(count == 0, np.nan, -1.0),
        "measures/end.place": np.full((n, 2), 0.25),
    }


def same(one, other):
    return {name: (c.dtype, c.shape, c.tobytes()) for name, c in one.items()} == {
        name: (c.dtype, c.shape, c.tobytes()) for name, c in other.items()
    }


def test_what_is_read_is_what_was_written(tmp_path):
    path = tmp_path / "outcomes.npz"
    path.write_bytes(to_bytes(outcomes()))
    assert same(load_outcomes(path), outcomes())
    with np.load(path, allow_pickle=False) as file:
        assert file["measures/end.place"].shape == (3, 2)


def test_equal_outcomes_give_equal_bytes():
    assert to_bytes(outcomes()) == to_bytes(outcomes())


def test_segments_are_read_up_to_a_generation(tmp_path):
    folder = tmp_path / "outcomes"
    blocks = [outcomes(2), outcomes(0), outcomes(3, first=9), outcomes(1, first=30)]
    paths = [write_segment(folder, i, block) for i, block in enumerate(blocks, 1)]
    assert [path.name for path in paths] == [f"00000{i}.npz" for i in range(1, 5)]
    read = read_segments(folder, upto_generation=3)
    assert [same(*pair) for pair in zip(read, blocks[:3], strict=True)] == [True] * 3
    assert read_segments(folder, upto_generation=0) == []
    assert sorted(folder.iterdir()) == paths


def test_a_segment_is_written_again(tmp_path):
    for block in (outcomes(3), outcomes(2)):
        write_segment(tmp_path, 1, block)
        (read,) = read_segments(tmp_path, upto_generation=1)
        assert same(read, block)


def test_later_segments_may_be_damaged(tmp_path):
    write_segment(tmp_path, 1, outcomes())
    (tmp_path / "000002.npz").write_bytes(b"half a fi")
    assert len(read_segments(tmp_path, upto_generation=1)) == 1
    with pytest.raises(OutcomeError, match=r"Expected outcomes in \S+000002\.npz, but"):
        read_segments(tmp_path, upto_generation=2)


def test_a_missing_segment_is_named(tmp_path):
    write_segment(tmp_path, 1, outcomes())
    with pytest.raises(
        OutcomeError,
        match=r"in \S+000002\.npz, but they cannot be read \(No such file or directory\); restore",
    ):
        read_segments(tmp_path, upto_generation=2)


def test_a_folder_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "outcomes").write_text("a file in its place")
    with pytest.raises(OutcomeError, match=r"write the outcomes \S+000001\.npz, but that failed"):
        write_segment(tmp_path / "outcomes", 1, outcomes())


SENTENCE = re.compile(
    r"Expected outcomes in \S+outcomes\.npz, but they cannot be read \([^\n]+\); restore the file, "
    r"or begin the run again from its start\."
)


def refusal(path):
    """Load what must be refused, and return the one sentence that says why."""
    with pytest.raises(OutcomeError) as caught:
        load_outcomes(path)
    assert SENTENCE.fullmatch(str(caught.value))
    return str(caught.value)


def test_every_truncation_is_found(tmp_path):
    path, content = tmp_path / "outcomes.npz", to_bytes(outcomes())
    for end in range(0, len(content), 7):
        path.write_bytes(content[:end])
        refusal(path)


def test_a_column_that_damage_hides_is_missed(tmp_path):
    content = bytearray(to_bytes(outcomes()))
    # The last column but one says in the zip's directory that its comment is as long as the entry
    # of the last one.
    content[content.rindex(b"fitness/near.npy") - 46 + 32] = 46 + len(b"measures/end.place.npy")
    (tmp_path / "outcomes.npz").write_bytes(content)
    assert "expected 8 columns, but there are 7" in refusal(tmp_path / "outcomes.npz")


def test_a_flipped_byte_is_found_or_harmless(tmp_path):
    path, content = tmp_path / "outcomes.npz", to_bytes(outcomes())
    read, refused = [], []
    for i in range(0, len(content), 4):
        flip = (0x01, 0x08, 0xFF)[i % 3]
        path.write_bytes(content[:i] + bytes([content[i] ^ flip]) + content[i + 1 :])
        try:
            read.append(load_outcomes(path))
        except OutcomeError as error:
            refused.append(str(error))
    assert len(refused) > len(read) > 0
    assert all(SENTENCE.fullmatch(sentence) for sentence in refused)
    assert all(same(one, outcomes()) for one in read)


@pytest.mark.parametrize("name", ["solution", "evaluation", "success", "expert", "digest"])
def test_a_missing_column_is_named(tmp_path, name):
    columns = outcomes()
    del columns[name]
    np.savez(tmp_path / "outcomes.npz", **columns)
    assert f"expected a column {name}, but there is none" in refusal(tmp_path / "outcomes.npz")


@pytest.mark.parametrize(
    ("name", "column", "message"),
    [
        ("digest", np.zeros(2, np.uint64), "as many rows in digest as in solution, got 2 and 3"),
        ("expert", np.zeros(3), "1 dimensions of bool in expert, got 1 of float64"),
        ("ground_truth", np.zeros(3), "2 dimensions of float64 in ground_truth, got 1 of"),
        ("fitness/near", np.zeros(3, np.int64), "of float64 in fitness/near, got 1 of int64"),
        ("measures/end.place", np.zeros(3), "2 dimensions of float64 in measures/end.place"),
        ("other", np.zeros(3), "expected no column other"),
        ("evaluation", np.array([1, 1, 2]), "numbers that ascend from 0 in evaluation"),
        ("evaluation", np.array([-1, 1, 2]), "numbers that ascend from 0 in evaluation"),
        ("success", np.zeros(3, bool), "a success in each row by success or expert"),
    ],
)
def test_a_column_of_another_form_is_named(tmp_path, name, column, message):
    np.savez(tmp_path / "outcomes.npz", **outcomes() | {name: column})
    assert message in refusal(tmp_path / "outcomes.npz")


def test_an_array_of_objects_is_not_unpickled(tmp_path):
    buffer = io.BytesIO()
    np.savez(buffer, **outcomes() | {"digest": np.array([{}, {}, {}])})
    (tmp_path / "outcomes.npz").write_bytes(buffer.getvalue())
    assert "Object arrays cannot be loaded" in refusal(tmp_path / "outcomes.npz")
