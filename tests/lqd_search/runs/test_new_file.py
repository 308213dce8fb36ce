import pytest

from lqd_search.runs.new_file import why_no_new_file


def test_a_file_may_be_new_in_a_folder_that_is_there(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    assert why_no_new_file(tmp_path / "new") is None
    assert why_no_new_file(type(tmp_path)("new")) is None


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("file", "exists already"),
        ("folder", "exists already"),
        ("link", "exists already"),
        ("nowhere/new", "is in a folder that does not exist"),
        ("file/new", "cannot be used (Not a directory)"),
        ("a" * 300, "cannot be used (File name too long)"),
    ],
)
def test_otherwise_the_reason_is_said(name, reason, tmp_path):
    (tmp_path / "file").touch()
    (tmp_path / "folder").mkdir()
    (tmp_path / "link").symlink_to("nothing")

    assert why_no_new_file(tmp_path / name) == reason
