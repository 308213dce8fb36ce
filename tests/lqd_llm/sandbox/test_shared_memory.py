"""Memory that the system does not give."""

import pytest

from lqd_llm.sandbox import Sandbox, SandboxError, shared_memory


@pytest.mark.parametrize("failing", ["lqd-columns", "lqd-results"])
def test_a_system_that_shares_no_memory_is_told_and_nothing_leaks(
    failing, several, layout, open_files, monkeypatch
):
    make = shared_memory._open

    def refuse(name):
        if name == failing:
            raise OSError(24, "Too many open files")
        return make(name)

    before = open_files()
    monkeypatch.setattr(shared_memory, "_open", refuse)
    with pytest.raises(SandboxError, match=r"KiB of memory .*\(\[Errno 24\] Too many open files\)"):
        Sandbox(layout, functions=several).__enter__()
    assert open_files() == before
    monkeypatch.undo()
    with Sandbox(layout, functions=several) as sandbox:
        assert sandbox.worker_pid is not None
