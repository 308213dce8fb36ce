"""Evaluators that judge in the sandbox: made, closed, spread over workers, killed, and going on."""

import contextlib
import dataclasses
import gc
import os
import pickle
import select
import signal
import sys
import threading
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from benchmarks.plain_functions import plain_functionals
from benchmarks.recorded_recipe import recorded_recipe
from lqd_envs import SolutionSpace, get_task, rollout
from lqd_search import FunctionalEvaluator
from lqd_search.cli.evaluator_recipe import EvaluatorRecipe
from lqd_search.cli.opened_sandbox import open_sandbox
from lqd_search.cli.sandbox_judge import SandboxMeshJudge
from lqd_search.evaluation.cluster import open_cluster
from lqd_search.evaluation.cluster_evaluator import ClusterEvaluator
from lqd_search.evaluation.functionals import FunctionalError
from lqd_search.evaluation.mesh_judge import MeshJudge
from lqd_search.evaluation.stopped_functions import WithoutStopped
from lqd_search.loop import search
from lqd_search.methods.by_name import METHODS, Setting
from lqd_search.runs.function_text import FunctionText
from lqd_search.runs.state_pickle import pickle_state, unpickle_state
from lqd_search.runs.stored_archive import StoredArchive

FAUCET = get_task("LQD/Faucet-v0")
# Turns the hot tap by 1.57 rad.
TURNING = (0.07, 0.68, -0.05, 0.47, -0.83, 2.41, -0.47, -0.51, 0.06)
TAP = "['joint_positions']['hot_tap']"
BODIES = {
    ("success", "success"): f"return infos[-1]{TAP} > 0.314",
    ("fitness", "height"): "return info['gripper_position'][2]",
    ("fitness", "opening"): f"return info{TAP}",
    ("timestamp", "end"): "return infos[-1]",
    ("timestamp", "touch"): (
        "return next((i for i in infos if any(i['gripper_contacts'].values())), None)"
    ),
    ("quantity", "place"): "return info['gripper_position']",
    ("quantity", "taps"): "return tuple(info['joint_positions'].values())",
    ("direct.success", "success"): f"return infos[-1]{TAP} > 0.314",
    ("direct.fitness", "fitness"): f"return info{TAP}",
    ("direct.descriptor", "descriptor"): "return infos[-1]['gripper_position']",
}
LENGTHS = {"taps": 2, "place": 3, "direct.descriptor": 3}


def recipe_of(steering="mesh", **changes):
    """The recipe of an evaluator at the faucet, with other bodies of functions of some names."""
    bodies = BODIES | {key: changes[key[1]] for key in BODIES if key[1] in changes}
    texts = []
    for (kind, name), body in bodies.items():
        entry = kind.rpartition(".")[2]
        argument = "info" if entry in ("fitness", "quantity") else "infos"
        code = f"def {entry}({argument}):\n    {body}\n"
        texts.append(FunctionText(kind, name, "It measures.", code))
    return EvaluatorRecipe.of(
        FAUCET.id, steering=steering, functions=texts, lengths=LENGTHS, threads=1
    )


@cache
def solutions():
    """(48, 9): at 20 and at 40 one that turns on the hot water, the others random."""
    drawn = SolutionSpace().sample(48, rng=np.random.default_rng(0))
    drawn[[20, 40]] = TURNING
    return drawn


def bits(values):
    columns = []
    for field in dataclasses.fields(values):
        column = getattr(values, field.name)
        if field.name not in ("refusals", "stopped"):
            for name, array in (column if isinstance(column, dict) else {"": column}).items():
                columns.append((field.name, name, array.dtype, array.shape, array.tobytes()))
    return columns, values.refusals, values.stopped


def sandboxes(host=None):
    """The processes of the sandboxes that a process holds."""
    found = set()
    for children in Path(f"/proc/{host or os.getpid()}/task").glob("*/children"):
        for pid in children.read_text().split():
            with contextlib.suppress(OSError):
                if b"lqd_llm.sandbox" in Path(f"/proc/{pid}/cmdline").read_bytes():
                    found.add(int(pid))
    return found


def test_a_recipe_keeps_the_functions_that_steer_its_method():
    mesh, direct, expert = (recipe_of(steering) for steering in ("mesh", "direct", "expert"))
    assert [text.kind for text in mesh.functions] == [k for k, _ in BODIES if "." not in k]
    assert mesh.lengths == (("place", 3), ("taps", 2))
    assert [text.kind for text in direct.functions] == [k for k, _ in BODIES if "." in k]
    assert direct.lengths == (("direct.descriptor", 3),)
    assert (expert.functions, expert.lengths) == ((), ())


def test_a_recipe_can_be_pickled_and_compared():
    recipe = recipe_of()
    assert pickle.loads(pickle.dumps(recipe)) == recipe == recipe_of()
    assert hash(recipe) == hash(recipe_of())
    assert recipe != recipe_of(height="return 0.0")
    assert recipe != replace(recipe, allow_weak=True)


@pytest.mark.parametrize("steering", ["mesh", "direct"])
def test_the_sandbox_ends_with_its_evaluator(steering):
    before = sandboxes()
    with recipe_of(steering).opened() as evaluate:
        assert len(sandboxes() - before) == 1
        assert evaluate(solutions()[18:22]).success.tolist() == [False, False, True, False]
    assert sandboxes() == before
    evaluate = recipe_of(steering)()
    assert len(sandboxes() - before) == 1
    del evaluate
    gc.collect()
    assert sandboxes() == before


def test_the_sandbox_does_not_outlive_an_error():
    before, recipe = sandboxes(), replace(recipe_of(), lengths=())
    with pytest.raises(FunctionalError, match="how many numbers 'place' measures"):
        recipe()
    assert sandboxes() == before
    with pytest.raises(KeyboardInterrupt), recipe_of().opened():
        raise KeyboardInterrupt
    assert sandboxes() == before


def test_the_expert_needs_no_sandbox(monkeypatch):
    monkeypatch.setitem(sys.modules, "lqd_llm", None)
    monkeypatch.setitem(sys.modules, "lqd_search.cli.opened_sandbox", None)
    with recipe_of("expert").opened() as evaluate:
        assert list(evaluate(solutions()[:2]).fitness) == ["expert"]


HOARD = f"[1, 2] * 10 ** (10 if %s{TAP} > 0.3 else 1)"
STALLING = {
    "opening": f"while info{TAP} > 0.3:\n        pass\n    return 1.0",
    "touch": f"return infos[len({HOARD % 'infos[-1]'}) // 20]",
    "taps": f"return ({HOARD % 'info'})[:2]",
}
"""On the motions that turn the tap a fitness never ends, and two functions take too much memory."""


def lasting(recipe, *, chunk=512, stopped=()):
    def make(stopped):
        return replace(recipe.without(stopped)(), chunk=chunk)

    return WithoutStopped(make(stopped), make=make, stopped=stopped)


def generations(evaluate):
    return [bits(evaluate(batch)) for batch in np.split(solutions(), [30])]


@cache
def expected():
    """The values of two generations, in the first of which functions are stopped."""
    return generations(lasting(recipe_of(**STALLING)))


def test_functions_that_take_too_much_are_refused_in_their_whole_generation_and_from_then_on():
    first, second = expected()
    gone = [("fitness", "opening"), ("timestamp", "touch"), ("quantity", "taps")]
    assert [(s.kind, s.functional) for s in first[2]] == gone
    assert [s.reason for s in first[2]] == [
        "was stopped: it used more than 1 s of CPU time",
        *["was stopped: it took more than 1024 MiB of memory"] * 2,
    ]
    assert second[2] == ()
    with recipe_of().opened() as evaluate:
        plain = generations(evaluate)
    for (columns, refusals, _), (others, *_) in zip((first, second), plain, strict=True):
        valid = np.frombuffer(columns[0][-1], bool).sum()
        assert sorted((r.kind, r.functional, r.count) for r in refusals) == sorted(
            (*function, valid) for function in gone
        )
        for column, other in zip(columns, others, strict=True):
            if {"opening", "touch", "taps"} & set(column[1].split(".")):
                assert np.isnan(np.frombuffer(column[-1])).all()
            else:
                assert column == other


def test_the_values_do_not_depend_on_the_chunks():
    assert generations(lasting(recipe_of(**STALLING), chunk=7)) == expected()


def test_a_run_that_goes_on_does_not_call_what_was_stopped():
    first, second = expected()
    # As a checkpoint keeps it.
    stopped = unpickle_state(pickle_state(first[2]))
    recipe, made = recipe_of(**STALLING).without(stopped), []
    going_on = WithoutStopped(recipe(), make=made.append, stopped=stopped)
    assert bits(going_on(solutions()[30:])) == second
    assert going_on.stopped == stopped
    assert made == []


@pytest.mark.slow
def test_the_values_of_two_workers_are_those_of_one():
    recipe = recipe_of(**STALLING)
    with open_cluster("local:2") as client:

        def make(stopped):
            return ClusterEvaluator(client, recipe.without(stopped), chunk=10)

        assert generations(WithoutStopped(make(()), make=make)) == expected()


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells a process of its parent")
def test_a_worker_that_is_killed_leaves_no_sandbox():
    with open_cluster("local:1") as client:
        ClusterEvaluator(client, recipe_of())(solutions()[:4])
        (worker,) = client.run(os.getpid).values()
        (sandbox,) = sandboxes(worker)
        file = os.pidfd_open(sandbox)
        poller = select.poll()
        poller.register(file, select.POLLIN)
        assert poller.poll(0) == []
        os.kill(worker, signal.SIGKILL)
        # It becomes readable when the process has ended.
        assert poller.poll(60_000) != []
        os.close(file)


def setting(evaluate, *, seed=4):
    return Setting(
        task=evaluate.task,
        judge=evaluate.judge,
        evaluations=480,
        batch_size=24,
        rng=np.random.default_rng(seed),
    )


def found(evaluate, judge):
    """What a search comes to: the values of its generations, and its archive."""
    method = METHODS["ours"].build(setting(replace(evaluate, judge=judge)))
    seen = []
    search(
        method,
        replace(evaluate, judge=judge, chunk=16),
        observe=lambda generation: seen.append(bits(generation.values)),
    )
    return seen, StoredArchive.of(method).to_bytes()


class Killing:
    """A judge whose worker is killed while it judges, now and then, some random time later."""

    def __init__(self, judge, sandbox, *, rng):
        self.fitness_names, self.descriptors = judge.fitness_names, judge.descriptors
        self.kills = 0
        self._judge, self._sandbox, self._rng = judge, sandbox, rng

    def __call__(self, trajectories):
        timer = threading.Timer(self._rng.uniform(0.0, 0.01), self._kill)
        often = self._rng.random() < 0.3
        if often:
            timer.start()
        values = self._judge(trajectories)
        if often:
            timer.join()
        return values

    def _kill(self):
        pid = self._sandbox.worker_pid
        if pid is not None:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
                self.kills += 1


@pytest.mark.slow
def test_killing_the_sandbox_at_random_moments_of_a_search_changes_nothing():
    recipe = recorded_recipe(FAUCET, method="ours", sample=0, threads=1)
    texts = recipe.functions
    evaluate = recipe_of("expert")()
    motions = rollout(FAUCET, solutions()[[20]])
    here = MeshJudge(FunctionalEvaluator(plain_functionals(texts), examples=motions.infos(0)))
    with contextlib.closing(open_sandbox(FAUCET.schema, texts)) as sandbox:
        judge = SandboxMeshJudge(sandbox, functions=texts, lengths=dict(recipe.lengths))
        killing = Killing(judge, sandbox, rng=np.random.default_rng(0))
        assert found(evaluate, killing) == found(evaluate, here)
        assert killing.kills >= 5
        assert sandbox.dropped == ()


@pytest.mark.slow
def test_a_search_goes_on_without_a_fitness_that_was_stopped():
    recipe, seen = recipe_of(height="while True:\n        pass"), []
    evaluate = lasting(recipe)
    method = METHODS["ours"].build(setting(recipe()))
    search(method, evaluate, observe=lambda generation: seen.append(generation.values))
    assert [stopped.functional for stopped in evaluate.stopped] == ["height"]
    assert seen[0].stopped == evaluate.stopped
    assert all(np.isnan(values.fitness["height"]).all() for values in seen)
    assert len(method.output()["solution"]) > 0
