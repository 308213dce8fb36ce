"""Workers that do not start, stand still, or hang."""

import os
import signal
import sys

import numpy as np
import pytest

from lqd_llm.sandbox import Limits, Role, Sandbox, SandboxError, process, supervisor


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells the CPU time of a process")
def test_a_worker_that_is_paused_is_replaced_and_nobody_blamed(several, mugs, layout):
    with Sandbox(layout, functions=several) as sandbox:
        undisturbed = sandbox.run(mugs.arrays())
    with Sandbox(layout, functions=several, limits=Limits(idle_seconds=2.0)) as sandbox:
        pid = sandbox.worker_pid
        os.kill(pid, signal.SIGSTOP)
        paused = sandbox.run(mugs.arrays())
        assert sandbox.worker_pid != pid
    for name, numbers in undisturbed.fitness.items():
        assert np.array_equal(paused.fitness[name], numbers)
    for pair, numbers in undisturbed.quantities.items():
        assert np.array_equal(paused.quantities[pair], numbers, equal_nan=True)
    assert paused.dropped == ()


def test_a_function_whose_process_stands_still_three_times_is_dropped(
    function, several, mugs, layout, monkeypatch
):
    looked = []

    def stands_still(watch, call):
        if watch._limits is process._START:
            return None
        looked.append(call)
        return process.Ending.STILL

    monkeypatch.setattr(process._Watch, "look", stands_still)
    stuck = function(Role.SUCCESS, "while True:", "    pass", name="stuck")
    with Sandbox(layout, functions=[*several, stuck], limits=Limits(idle_seconds=7)) as sandbox:
        dropped = sandbox.run(mugs.rows(np.arange(1)).arrays()).dropped
    assert [(d.name, d.cause, d.motion) for d in dropped] == [("stuck", "crash", 0)]
    assert dropped[0].reason == (
        "was stopped: its process stood still for 7 s 3 times in a row while it ran"
    )
    assert len(looked) == 3


def test_a_worker_that_hangs_while_it_starts_is_given_up_after_three(several, layout, monkeypatch):
    started = []

    def sleeps(*told):
        started.append(told)
        return ["/bin/sleep", "600"]

    monkeypatch.setattr(process, "start_command", sleeps)
    monkeypatch.setattr(process, "_START", Limits(cpu_seconds=60.0, idle_seconds=0.2))
    with pytest.raises(SandboxError) as caught:
        Sandbox(layout, functions=several).__enter__()
    assert str(caught.value) == (
        "Expected the sandbox's worker to start, but 3 in a row did not: it did not get ready, and "
        "stood still for 0.2 s; see whether Python and NumPy start outside the sandbox."
    )
    assert len(started) == 3


@pytest.mark.parametrize(
    "error",
    [
        BlockingIOError(11, "Resource temporarily unavailable"),
        RuntimeError("can't start new thread"),
    ],
)
def test_a_system_that_starts_no_process_is_told(error, several, layout, open_files, monkeypatch):
    def refuse(*_, **__):
        raise error

    before = open_files()
    monkeypatch.setattr(supervisor, "WorkerProcess", refuse)
    with pytest.raises(SandboxError) as caught:
        Sandbox(layout, functions=several).__enter__()
    assert str(caught.value) == (
        f"Expected the system to start a process for the sandbox, but it does not ({error}); end "
        "other programs, or raise the limits on processes (ulimit -u), open files (ulimit -n) and "
        "memory."
    )
    del caught
    assert open_files() == before
