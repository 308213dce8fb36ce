import os

import pytest

from lqd_llm.atomic_file import write_atomically


def test_file_is_replaced_as_a_whole(tmp_path):
    path = tmp_path / "answer.json"
    path.write_bytes(b"old")
    write_atomically(path, b"new")

    assert path.read_bytes() == b"new"
    assert list(tmp_path.iterdir()) == [path]


def test_old_file_stays_when_writing_fails(tmp_path, monkeypatch):
    path = tmp_path / "answer.json"
    path.write_bytes(b"old")

    def fail(_: int) -> None:
        assert path.read_bytes() == b"old"
        raise OSError(5, "Input/output error")

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(OSError, match="Input/output error"):
        write_atomically(path, b"new")

    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]
