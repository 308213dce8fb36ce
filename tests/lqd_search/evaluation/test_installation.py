import pickle
import subprocess
import sys
from pathlib import Path

import pytest

import lqd_envs
from lqd_search.evaluation.installation import (
    OWN_PACKAGES,
    installation,
    processor,
    sources_digest,
)
from lqd_search.runs.run_config import installed_versions

SOURCES = {"__init__.py": "", "scene.py": "SIZE = 3\n", "tasks/faucet.py": "SIZE = 4\n"}


def package(folder, sources):
    for name, text in sources.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return folder


def test_it_holds_the_versions_and_a_digest_of_each_own_package():
    found = installation()

    assert found.items() >= installed_versions().items()
    assert found.keys() == {*installed_versions(), *OWN_PACKAGES}
    digests = [found[name] for name in OWN_PACKAGES]
    assert len({digest for digest in digests if len(bytes.fromhex(digest)) == 32}) == 3
    assert found["lqd_envs"] == sources_digest(Path(lqd_envs.__file__).parent)


def test_another_process_finds_the_same():
    code = (
        "import pickle, sys; from lqd_search.evaluation.installation import installation;"
        "sys.stdout.buffer.write(pickle.dumps(installation())); sys.exit('lqd_llm' in sys.modules)"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)

    assert pickle.loads(result.stdout) == installation()


def test_the_digest_depends_on_nothing_but_the_sources(tmp_path):
    here = package(tmp_path / "here", SOURCES)
    there = package(tmp_path / "there", dict(reversed(SOURCES.items())))
    package(there, {"notes.md": "Nothing that runs.", "__pycache__/scene.pyc": "?"})

    assert sources_digest(there) == sources_digest(here)


@pytest.mark.parametrize(
    "changes",
    [
        {"scene.py": "SIZE = 5\n"},
        {"tasks/faucet.py": "SIZE = 4"},
        {"tasks/tap.py": ""},
        {"scene.py": "SIZE = 4\n", "tasks/faucet.py": "SIZE = 3\n"},
    ],
)
def test_every_change_of_a_source_changes_the_digest(tmp_path, changes):
    before = sources_digest(package(tmp_path, SOURCES))
    assert sources_digest(package(tmp_path, changes)) != before


def test_a_renamed_source_changes_the_digest(tmp_path):
    before = sources_digest(package(tmp_path, SOURCES))
    (tmp_path / "scene.py").rename(tmp_path / "place.py")
    assert sources_digest(tmp_path) != before


def test_the_processor_has_an_architecture_and_a_name(tmp_path, monkeypatch):
    info = tmp_path / "cpuinfo"
    monkeypatch.setattr("platform.machine", lambda: "x86_64")
    monkeypatch.setattr("lqd_search.evaluation.installation._CPU_INFO", info)
    assert processor() == "x86_64"

    info.write_text("processor\t: 0\nmodel name\t: One 9000\nmodel name\t: One 9000\n")
    assert processor() == "x86_64 One 9000"
