"""What a benchmark ran on."""

import re
import subprocess

import pytest

from benchmarks.tables import machine
from benchmarks.tables.machine import describe_commit, describe_machine


def git(*arguments, folder):
    subprocess.run(
        ["git", "-c", "user.name=a", "-c", "user.email=a@b", *arguments], cwd=folder, check=True
    )


@pytest.fixture
def sources(tmp_path, monkeypatch):
    (tmp_path / "machine.py").write_text("first")
    monkeypatch.setattr(machine, "__file__", str(tmp_path / "machine.py"))
    return tmp_path


def test_the_commit_and_whether_the_sources_are_still_its_own(sources):
    git("init", "--quiet", folder=sources)
    git("add", "machine.py", folder=sources)
    git("commit", "--quiet", "--no-verify", "-m", "one", folder=sources)

    commit = describe_commit()
    assert re.fullmatch(r"[0-9a-f]{12,}", commit)
    (sources / "other.txt").write_text("What git does not know is of no account.")
    assert describe_commit() == commit

    (sources / "machine.py").write_text("second")
    assert describe_commit() == f"{commit}+"


def test_sources_that_are_in_no_repository(sources, monkeypatch):
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(sources.parent))
    assert describe_commit() == ""


def test_a_machine_without_git(sources, monkeypatch):
    monkeypatch.setenv("PATH", str(sources))
    assert describe_commit() == ""


def test_the_machine_is_told_by_its_processor():
    assert re.search(r"\d+ CPUs$", describe_machine())
