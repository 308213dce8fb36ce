import gc
import os
import random
import signal
import subprocess
import sys
import threading
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from lqd_llm.sandbox import SandboxError, check_source, supervisor
from lqd_llm.sandbox.functions import SandboxedFunction
from lqd_llm.sandbox.limits import Limits
from lqd_llm.sandbox.results import NO_MOMENT, REFUSED
from lqd_llm.sandbox.roles import Role
from lqd_llm.sandbox.sandbox import Sandbox
from lqd_llm.sandbox.wire import Lock

QUICK = Limits(cpu_seconds=0.3, memory_bytes=256 << 20)
HEIGHT = "return info['object_position'][2]"
# Motion 4 of the `marked` columns, and only that one, begins higher than any mug can be.
MARKED = "infos[0]['object_position'][2] > 50"
ARRAYS = ("success", "fitness", "moments", "quantities", "lengths", "descriptors")


@pytest.fixture
def marked(mugs):
    columns = {key: array.copy() for key, array in mugs.arrays().items()}
    columns["object_position"][4, :, 2] = 99.0
    return columns


def same(first, second):
    pairs = [(getattr(first, name), getattr(second, name)) for name in ARRAYS]
    return all(
        ours.keys() == theirs.keys()
        and all(np.array_equal(ours[key], theirs[key], equal_nan=True) for key in ours)
        for ours, theirs in pairs
    )


def many(columns, *, times):
    return {key: np.concatenate([array] * times) for key, array in columns.items()}


def test_results_have_the_documented_form(several, mugs, layout):
    with Sandbox(layout, functions=several) as sandbox:
        results = sandbox.run(mugs.arrays())
    ends = mugs.gripper_position[:, -1]
    assert results.success["lifted"].dtype == bool
    assert results.fitness["height"].shape == (10,)
    assert (results.moments["end"] == 75).all()
    assert (results.moments["never"] == NO_MOMENT).all()
    assert np.array_equal(results.quantities["end", "xy"][:, :2], ends[:, :2])
    assert np.isnan(results.quantities["end", "xy"][:, 2:]).all()
    assert (results.lengths["end", "xy"] == 2).all()
    assert (results.lengths["never", "xy"] == 0).all()
    assert np.isnan(results.quantities["never", "xy"]).all()
    starts = mugs.gripper_position[:, 0]
    assert np.array_equal(results.descriptors["start"][:, :3], starts)
    assert (results.descriptor_lengths["start"] == 3).all()
    assert results.refusals == ()


def test_batches_larger_than_a_chunk_and_of_other_lengths(several, mugs, layout):
    columns = mugs.arrays()
    with Sandbox(layout, functions=several) as sandbox:
        whole = sandbox.run(many(columns, times=120))
        once = sandbox.run(columns)
        short = sandbox.run({key: np.ascontiguousarray(a[:, :1]) for key, a in columns.items()})
        empty = sandbox.run({key: array[:0] for key, array in columns.items()})
    assert np.array_equal(whole.fitness["height"], np.tile(once.fitness["height"], 120))
    assert (short.moments["end"] == 0).all()
    assert np.array_equal(short.fitness["height"], mugs.object_position[:, 0, 2])
    assert empty.fitness["height"].shape == (0,)


def test_another_length_than_expected_is_refused(function, mugs, layout):
    functions = [
        function(Role.TIMESTAMP, "return infos[-1]", name="end"),
        function(Role.QUANTITY, "return (1, 2)", name="two"),
    ]
    with Sandbox(layout, functions=functions) as sandbox:
        results = sandbox.run(mugs.arrays(), lengths={(Role.QUANTITY, "two"): 3})
    assert np.isnan(results.quantities["end", "two"]).all()
    assert (results.lengths["end", "two"] == 0).all()
    assert results.refusals[0].reason == "returned 2 numbers, not 3 as on an example"
    assert results.refusals[0].motions.tolist() == list(range(10))


def test_nothing_that_a_function_is_given_can_be_changed(function, mugs, layout):
    attempts = {
        "key": "infos[0]['object_position'] = (9.0, 9.0, 9.0)",
        "inner": "infos[0]['gripper_contacts']['mug'] = True",
        "update": "dict.update(infos[0], {'object_position': 1})",
        "clear": "infos[0].clear()",
        "order": "infos.reverse()",
    }
    functions = [
        function(Role.SUCCESS, attempt, "return True", name=name)
        for name, attempt in attempts.items()
    ]
    height = function(Role.FITNESS, HEIGHT, name="height")
    first = function(Role.DESCRIPTOR, "return infos[0]['gripper_position']", name="first")
    with Sandbox(layout, functions=[*functions, height, first]) as sandbox:
        results = sandbox.run(mugs.arrays())
    assert {refused.name for refused in results.refusals} == set(attempts) - {"order"}
    assert np.array_equal(results.descriptors["first"][:, :3], mugs.gripper_position[:, 0])


@pytest.mark.parametrize(
    ("cause", "body", "reason"),
    [
        ("timeout", "0.5 in range(10 ** 12)", "used more than 0.3 s of CPU time"),
        ("memory", "len([0.0] * 10 ** 9)", "took more than 256 MiB of memory"),
    ],
)
def test_a_function_that_uses_too_much_is_dropped(
    cause, body, reason, function, several, marked, layout
):
    stopped = function(Role.SUCCESS, f"return {MARKED} and bool({body})", name="greedy")
    with Sandbox(layout, functions=[*several, stopped], limits=QUICK) as sandbox:
        first = sandbox.run(marked)
        again = sandbox.run(marked)
    with Sandbox(layout, functions=several) as sandbox:
        without = sandbox.run(marked)
    assert [(d.name, d.cause, d.motion) for d in first.dropped] == [("greedy", cause, 4)]
    assert reason in str(first.dropped[0])
    assert again.dropped == ()
    refused = {r.name: r.motions.tolist() for r in first.refusals}
    assert refused == {"greedy": [4, 5, 6, 7, 8, 9]}
    assert reason in first.refusals[0].reason
    assert again.refusals[0].motions.tolist() == list(range(10))
    assert np.array_equal(first.fitness["height"], without.fitness["height"])
    assert all(
        np.array_equal(first.quantities[key], without.quantities[key], equal_nan=True)
        for key in without.quantities
    )


def test_nobody_answers_for_the_memory_that_another_left_behind(function, mugs, layout):
    leaves_all = (
        *("kept = []", "try:", "    while True:", "        kept.append([0.0] * 10 ** 5)"),
        *("except Exception:", "    kept.append(kept)", "return False"),
    )
    functions = [
        function(Role.SUCCESS, *leaves_all, name="leaves all"),
        function(Role.FITNESS, "return float(len([0.0] * 300_000))", name="needs some"),
    ]
    # How long it takes to fill the memory is not what matters here.
    limits = replace(QUICK, cpu_seconds=10.0)
    with Sandbox(layout, functions=functions, limits=limits) as sandbox:
        results = sandbox.run(mugs.rows(np.arange(3)).arrays())
        assert sandbox.dropped == ()
    assert results.success["leaves all"].tolist() == [False] * 3
    assert results.fitness["needs some"].tolist() == [3e5] * 3


def test_what_a_drop_does_does_not_depend_on_the_batches(function, several, marked, layout):
    stalls = function(Role.TIMESTAMP, f"while {MARKED}:", "    pass", "return infos[0]", name="h")
    with Sandbox(layout, functions=[*several, stalls], limits=QUICK) as sandbox:
        whole = sandbox.run(marked)
    with Sandbox(layout, functions=[*several, stalls], limits=QUICK) as sandbox:
        halves = [
            sandbox.run({key: array[rows] for key, array in marked.items()})
            for rows in (slice(0, 3), slice(3, 10))
        ]
    parts = np.concatenate([half.moments["h"] for half in halves])
    assert whole.moments["h"].tolist() == [0] * 4 + [REFUSED] * 6
    assert parts.tolist() == whole.moments["h"].tolist()


def test_a_function_that_crashes_its_process_three_times_is_dropped(
    function, several, marked, layout
):
    # Python does not count the depth of nested iterators, and overflows its stack.
    body = (
        "g = iter([1])",
        f"for _ in range(10 ** 6 if {MARKED} else 1):",
        "    g = map(abs, g)",
        "return next(g) == 1",
    )
    crashes = function(Role.SUCCESS, *body, name="deep")
    with Sandbox(layout, functions=[*several, crashes]) as sandbox:
        results = sandbox.run(marked)
    assert [(d.name, d.cause, d.motion) for d in results.dropped] == [("deep", "crash", 4)]
    assert results.success["deep"].tolist() == [True] * 4 + [False] * 6
    assert not np.isnan(results.fitness["height"]).any()


def test_code_that_cannot_be_defined_is_dropped(several, mugs, layout):
    code = "LIMIT = 1\nRATIO = 1 // (LIMIT - 1)\ndef success(infos):\n    return True\n"
    broken = SandboxedFunction("broken", Role.SUCCESS, check_source(code, entry="success"))
    with Sandbox(layout, functions=[*several, broken]) as sandbox:
        dropped = sandbox.dropped
        results = sandbox.run(mugs.arrays())
    assert [(d.name, d.cause, d.motion) for d in dropped] == [("broken", "definition", -1)]
    assert results.refusals[0].reason == "raised ZeroDivisionError in line 2 while it was defined"
    assert not results.success["broken"].any()


def test_when_every_function_is_dropped_their_values_are_refused(function, marked, layout):
    body = f"while {MARKED}:", "    pass", "return True"
    with Sandbox(layout, functions=[function(Role.SUCCESS, *body)], limits=QUICK) as sandbox:
        results = sandbox.run(marked)
        assert sandbox.worker_pid is None
    assert results.success["it"].tolist() == [True] * 4 + [False] * 6


def test_killing_the_worker_at_random_moments_changes_nothing(several, mugs, layout):
    columns = many(mugs.arrays(), times=100)
    with Sandbox(layout, functions=several) as sandbox:
        undisturbed = sandbox.run(columns)
        kills = _Killer(sandbox, rng=random.Random(0))
        kills.start()
        disturbed = sandbox.run(columns)
        while kills.done < 3:
            disturbed = sandbox.run(columns)
            assert same(disturbed, undisturbed)
        kills.stop()
    assert same(disturbed, undisturbed)
    assert disturbed.dropped == ()


class _Killer(threading.Thread):
    """Kills each worker some random time after it was first seen."""

    def __init__(self, sandbox, *, rng):
        super().__init__(daemon=True)
        self.done = 0
        self._sandbox = sandbox
        self._rng = rng
        self._ending = threading.Event()

    def run(self):
        while not self._ending.wait(1.0 + self._rng.random()):
            pid = self._sandbox.worker_pid
            if pid is not None:
                os.kill(pid, signal.SIGKILL)
                self.done += 1

    def stop(self):
        self._ending.set()
        self.join()


def test_a_worker_killed_between_batches_is_replaced(several, mugs, layout):
    with Sandbox(layout, functions=several) as sandbox:
        first, pid = sandbox.run(mugs.arrays()), sandbox.worker_pid
        os.kill(pid, signal.SIGKILL)
        second = sandbox.run(mugs.arrays())
        assert sandbox.worker_pid != pid
    assert same(first, second)


def files_of(pid):
    return {int(file.name): str(file.readlink()) for file in Path(f"/proc/{pid}/fd").iterdir()}


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells the files of a process")
def test_a_worker_has_no_file_open_but_four(several, layout):
    with Sandbox(layout, functions=several) as sandbox:
        files = files_of(sandbox.worker_pid)
    assert sorted(files) == [0, 1, 2, 3]
    assert files.pop(1) == os.devnull
    assert all(file.startswith("pipe:") for file in files.values())


def test_a_worker_started_by_a_thread_that_ended_lives_on(several, mugs, layout):
    with Sandbox(layout, functions=several) as sandbox:
        os.kill(sandbox.worker_pid, signal.SIGKILL)
        thread = threading.Thread(target=sandbox.run, args=(mugs.arrays(),))
        thread.start()
        thread.join()
        pid = sandbox.worker_pid
        sandbox.run(mugs.arrays())
        assert sandbox.worker_pid == pid


def test_many_batches_leak_neither_files_nor_memory(several, mugs, layout):
    def open_files():
        return len(list(Path("/proc/self/fd").iterdir()))

    def pages(pid):
        return int(Path(f"/proc/{pid}/statm").read_text().split()[1])

    gc.collect()
    before = open_files()
    with Sandbox(layout, functions=several) as sandbox:
        columns = mugs.arrays()
        for _ in range(20):
            sandbox.run(columns)
        files, worker = open_files(), pages(sandbox.worker_pid)
        for _ in range(200):
            sandbox.run(columns)
        assert open_files() == files
        assert pages(sandbox.worker_pid) < worker + 500
    gc.collect()
    assert open_files() == before


def test_leaving_the_with_statement_ends_everything(several, mugs, layout):
    threads = threading.active_count()
    with Sandbox(layout, functions=several) as sandbox:
        pid = sandbox.worker_pid
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)
    assert threading.active_count() == threads
    with pytest.raises(SandboxError, match="Expected a sandbox that is open, but it is closed"):
        sandbox.run(mugs.arrays())
    with sandbox:
        assert sandbox.worker_pid != pid
    sandbox.close()


def test_the_order_of_a_set_is_the_same_in_every_worker(function, mugs, layout):
    body = "return float([len(word) for word in {'a', 'bb', 'ccc', 'dddd', 'eeeee'}][0])"
    seen = set()
    for _ in range(4):
        with Sandbox(layout, functions=[function(Role.FITNESS, body)]) as sandbox:
            seen.add(float(sandbox.run(mugs.arrays()).fitness["it"][0]))
    assert len(seen) == 1


def test_a_missing_lock_is_named(several, layout, monkeypatch):
    monkeypatch.setattr(supervisor, "Lock", _LocksThere(Lock, Lock.SECCOMP))
    with pytest.raises(SandboxError, match=r"lacks seccomp.*--allow-weak-sandbox"):
        Sandbox(layout, functions=several).__enter__()
    with Sandbox(layout, functions=several, allow_weak=True) as sandbox:
        assert sandbox.worker_pid is not None


class _LocksThere:
    """The locks, of which one is not there whatever the worker says."""

    def __init__(self, locks, missing):
        self._locks = locks
        self._missing = missing

    def __call__(self, value):
        return self._locks(value) & ~self._missing

    def __iter__(self):
        return iter(self._locks)


@pytest.mark.parametrize("place", range(8))
def test_garbage_in_the_header_is_an_error(place, several, mugs, layout, monkeypatch):
    with Sandbox(layout, functions=several) as sandbox:
        sandbox.run(mugs.arrays())
        results = sandbox._open.results.memory
        ask = sandbox._open.supervisor._ask

        def ask_and_scribble(*args, **kwargs):
            ended = ask(*args, **kwargs)
            results[8 * place : 8 * place + 8] = b"\xff" * 8
            return ended

        monkeypatch.setattr(sandbox._open.supervisor, "_ask", ask_and_scribble)
        if place in (0, 1, 5, 6):
            with pytest.raises(SandboxError, match="Expected the sandbox's worker to write"):
                sandbox.run(mugs.arrays())
            monkeypatch.undo()
        # The other words are not read after a run; and the next worker writes a new header.
        assert sandbox.run(mugs.arrays()).success["lifted"].shape == (10,)


def test_garbage_in_the_records_is_an_error(several, mugs, layout, monkeypatch):
    with Sandbox(layout, functions=several) as sandbox:
        keeper, memory = sandbox._open.supervisor, sandbox._open.results.memory
        run = keeper.run

        def run_and_scribble(**kwargs):
            run(**kwargs)
            memory[1000:2000] = b"\xff" * 1000

        monkeypatch.setattr(keeper, "run", run_and_scribble)
        with pytest.raises(SandboxError, match="its results are not used"):
            sandbox.run(mugs.arrays())


def test_functions_of_one_name_or_none_are_refused(function, layout):
    twice = [function(Role.SUCCESS, "return True")] * 2
    with pytest.raises(SandboxError, match="two of the role success are called 'it'"):
        Sandbox(layout, functions=twice)
    with pytest.raises(SandboxError, match=r"Expected 1 to .* functions, but got 0"):
        Sandbox(layout, functions=[])


def test_columns_that_do_not_fit_are_refused(several, mugs, layout):
    columns = mugs.arrays()
    with Sandbox(layout, functions=several) as sandbox:
        with pytest.raises(SandboxError, match=r"Expected the columns object_position, .* but got"):
            sandbox.run({"object_position": columns["object_position"]})
        with pytest.raises(SandboxError, match=r"'gripper_position' to be float64 of shape"):
            sandbox.run({**columns, "gripper_position": columns["gripper_position"][:, :5]})
        ragged = [[0.0], [0.0, 1.0]]
        for flat, got in ((np.zeros(3), r"ndarray of shape \(3,\)"), (ragged, "list")):
            with pytest.raises(
                SandboxError, match=f"an array of motions and moments, but got {got}"
            ):
                sandbox.run({**columns, "object_position": flat})
        with pytest.raises(SandboxError, match="at least one moment"):
            sandbox.run({key: array[:, :0] for key, array in columns.items()})


def test_other_threads_run_while_the_worker_works(function, mugs, layout):
    slow = function(Role.FITNESS, "return float(sum(range(20_000)))")
    counted = 0
    with Sandbox(layout, functions=[slow]) as sandbox:
        thread = threading.Thread(target=sandbox.run, args=(many(mugs.arrays(), times=3),))
        thread.start()
        while thread.is_alive():
            counted += 1
            time.sleep(0)
        thread.join()
    assert counted > 100


def test_what_a_library_prints_is_not_taken_for_an_answer(function, several, mugs, layout):
    # LAPACK complains of this matrix on the standard output, three hundred bytes at a time.
    body = "return np.linalg.lstsq(np.array([[math.nan, 1], [1, 1]]), np.ones(2))[0][0]"
    columns = many(mugs.arrays(), times=30)
    with Sandbox(layout, functions=[*several, function(Role.FITNESS, body)]) as sandbox:
        results = sandbox.run(columns)
        assert same(results, sandbox.run(columns))
    assert [refused.reason for refused in results.refusals] == ["raised LinAlgError in line 2"]
    assert results.dropped == ()


HOST = """
import numpy as np
from lqd_llm.sandbox import check_source
from lqd_llm.sandbox.functions import SandboxedFunction
from lqd_llm.sandbox.info_layout import InfoKey, InfoKind, InfoLayout
from lqd_llm.sandbox.limits import Limits
from lqd_llm.sandbox.roles import Role
from lqd_llm.sandbox.sandbox import Sandbox

source = check_source("def f(infos):\\n    while True:\\n        pass\\n", entry="f")
layout = InfoLayout((InfoKey("flag", InfoKind.FLAG),))
functions = [SandboxedFunction("f", Role.SUCCESS, source)]
with Sandbox(layout, functions=functions, limits=Limits(cpu_seconds=600.0)) as sandbox:
    print(sandbox.worker_pid, sandbox._open.columns.file, flush=True)
    sandbox.run({"flag": np.zeros((1, 3), bool)})
"""


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells a process of its parent")
def test_a_busy_worker_dies_with_its_host():
    with subprocess.Popen([sys.executable, "-c", HOST], stdout=subprocess.PIPE, text=True) as host:
        pid, columns = map(int, host.stdout.readline().split())
        files = sorted(files_of(pid))
        stat = Path(f"/proc/{pid}/stat")
        while "R" not in stat.read_text().rpartition(")")[2].split()[:1]:
            os.sched_yield()
        host.kill()
    deadline = time.monotonic() + 60
    while stat.exists() and stat.read_text().rpartition(")")[2].split()[0] != "Z":
        assert time.monotonic() < deadline
        os.sched_yield()
    # The host had so few files open that the columns were where the worker has its answers.
    assert columns == 3
    assert files == [0, 1, 2, 3]
