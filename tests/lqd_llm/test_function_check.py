from dataclasses import replace

import numpy as np
import pytest

from lqd_envs import get_task, rollout
from lqd_envs.tasks.examples import example_solutions
from lqd_llm import (
    COUNTS,
    KINDS,
    Candidate,
    CheckFailure,
    FunctionCheck,
    FunctionSource,
    InferenceError,
    ReplayProvider,
    function_check,
    infer,
    load_recording,
    perception_layout,
)
from lqd_llm.sandbox import Limits, Sandbox, SandboxError, supervisor

KIND_OF = {
    "success": "success",
    "fitness": "fitness",
    "timestamp": "timestamps",
    "quantity": "quantities",
    "descriptor": "direct",
}


def candidate(entry, *body, name="it", before=""):
    argument = "info" if entry in ("fitness", "quantity") else "infos"
    code = before + "\n    ".join([f"def {entry}({argument}):", *body]) + "\n"
    return Candidate(FunctionSource(name=name, description="", code=code), KIND_OF[entry], entry)


@pytest.fixture(scope="module")
def check(motions):
    limits = Limits(cpu_seconds=0.2, memory_bytes=200 << 20)
    return FunctionCheck(perception_layout(motions.schema), motions.arrays(), limits=limits).check


GOOD = {
    "success": "return infos[-1]['joint_positions']['hot_tap'] > 0.3",
    "fitness": "return info['joint_positions']['hot_tap']",
    "timestamp": "return next((i for i in infos if i['gripper_contacts']['hot_tap']), None)",
    "quantity": "return info['gripper_position']",
    "descriptor": "return infos[-1]['gripper_position'][:2] if any(infos[-1]['gripper_contacts']"
    ".values()) else None",
}


def test_functions_that_pass(check, motions):
    outcomes = check([candidate(entry, body) for entry, body in GOOD.items()])
    success, fitness, timestamp, quantity, descriptor = (outcome.values for outcome in outcomes)

    assert [outcome.failure for outcome in outcomes] == [None] * 5
    assert [outcome.length for outcome in outcomes] == [None, None, None, 3, 2]
    assert success[:, 0].tolist() == [0.0, 0.0, 1.0, 1.0]
    assert fitness.shape == (4, 1)
    assert timestamp[:, 0].tolist() == [-1, -1, 20, 30]
    assert np.array_equal(quantity[:, :, :3], motions.gripper_position[:, [0, 38, 75]])
    assert np.isnan(quantity[:, :, 3:]).all()
    assert np.array_equal(descriptor[2:, :2], motions.gripper_position[2:, -1, :2])
    assert np.isnan(descriptor[:2]).all()


FAILURES = [
    ("fitness", "import os\n    return 1.0", "RejectedCodeError in line 2: import"),
    ("fitness", "return info['nothing']", "KeyError in line 2: raised on 4 of 4 example motions"),
    (
        "fitness",
        "return 1.0 / (info['joint_positions']['hot_tap'] < 0.9)",
        "ZeroDivisionError in line 2: raised on 2 of 4 example motions",
    ),
    ("fitness", "return None", "TypeError: returned None, not a number, on 4 of 4 example motions"),
    (
        "fitness",
        "return math.nan if info['gripper_contacts']['hot_tap'] else 1.0",
        "ValueError: returned NaN, on 2 of 4 example motions",
    ),
    ("success", "return 1", "TypeError: returned a value of type int, not a bool, on 4 of 4"),
    (
        "timestamp",
        "return dict(infos[0])",
        "ValueError: returned something else than an element of infos or None, on 4 of 4",
    ),
    (
        "quantity",
        "return (1.0,)",
        "ValueError: returned 1 numbers, not between 2 and 5, on 4 of 4 example motions",
    ),
    (
        "quantity",
        "return (0.0,) * (3 if info['gripper_contacts']['hot_tap'] else 2)",
        "ValueError: returned 2 and 3 numbers, not always as many",
    ),
    (
        "quantity",
        "return (1.0, 2.0) if abs(info['gripper_position'][1] - 0.085) > 1e-3 else (1.0,)",
        "ValueError: returned 1 numbers, not between 2 and 5, on 1 of 4 example motions",
    ),
    ("descriptor", "return None", "ValueError: returned None on all 4 example motions"),
    (
        "descriptor",
        "return (1.0,) * (2 + infos[-1]['gripper_contacts']['hot_tap'])",
        "ValueError: returned 2 and 3 numbers, not always as many",
    ),
    (
        "fitness",
        "while True:\n        pass",
        "TimeoutError: was stopped: it used more than 0.2 s of CPU time on one example motion",
    ),
    (
        "success",
        "return len([0.0] * 10 ** 9) > 0",
        "MemoryError: was stopped: it took more than 200 MiB of memory on one example motion",
    ),
]


def test_functions_that_fail_and_those_beside_them(check):
    bad = [candidate(entry, body) for entry, body, _ in FAILURES]
    good = [candidate(entry, body) for entry, body in GOOD.items()]
    outcomes = check([*bad, *good])

    for (_, body, told), outcome in zip(FAILURES, outcomes, strict=False):
        assert str(outcome.failure).startswith(told), body
        assert outcome.length is None
    assert [outcome.failure for outcome in outcomes[len(bad) :]] == [None] * 5


class ForgetfulSandbox(Sandbox):
    """A sandbox in which three functions get away with remembering how often they were called."""

    runs = 0

    def run(self, columns, *, lengths=None):
        results = super().run(columns, lengths=lengths)
        if not self.runs:
            self.runs = 1
            return results
        fitness = results.fitness["0"].copy()
        fitness[0] += 1.0
        moments = results.moments["1"][::-1]
        numbers = {(h, g): column + (g == "2") for (h, g), column in results.quantities.items()}
        return replace(
            results,
            fitness={**results.fitness, "0": fitness},
            moments={**results.moments, "1": moments},
            quantities=numbers,
        )


def test_function_that_gives_another_value_the_second_time_fails(check, monkeypatch):
    # The sandbox knows no way to do so; this is for one that it overlooks.
    monkeypatch.setattr(function_check, "Sandbox", ForgetfulSandbox)
    of = {entry: candidate(entry, GOOD[entry]) for entry in ("fitness", "timestamp", "quantity")}
    *changed, honest = check([*of.values(), candidate("quantity", "return (1.0, 2.0)")])

    told = "ValueError: gave another value when it was called a second time on {} of 4 example"
    for outcome, motions in zip(changed, (1, 4, 4), strict=True):
        assert str(outcome.failure).startswith(told.format(motions))
    assert honest.failure is None


def test_quantity_fails_where_a_timestamp_of_the_same_call_looks(check):
    gap = "p = info['joint_positions']['hot_tap']\n    return (1.0, 1.0 / (not 0.6 < p < 0.63))"
    quantity = candidate("quantity", gap)
    timestamp = candidate(
        "timestamp",
        "return next((i for i in infos if i['joint_positions']['hot_tap'] > 0.6), None)",
    )

    assert check([quantity])[0].failure is None
    beside = check([timestamp, quantity])
    assert beside[0].failure is None
    assert beside[1].failure.error == "ZeroDivisionError"


def test_two_functions_of_one_name_are_told_apart(check):
    inside = Candidate(candidate("success", "return 1").source, "direct", "success")
    alone, direct = check([candidate("success", GOOD["success"]), inside])

    assert alone.failure is None
    assert direct.failure.error == "TypeError"


def test_definition_that_raises(check):
    outcome, other = check(
        [candidate("fitness", "return 1.0", before="A = [][1]\n"), candidate("fitness", "return 0")]
    )

    assert outcome.failure == CheckFailure("IndexError", "raised while it was defined", 1)
    assert other.failure is None


def test_nothing_runs_where_nothing_may(check, monkeypatch):
    monkeypatch.setattr(supervisor.Supervisor, "start", pytest.fail)

    assert check([]) == []
    assert check([candidate("fitness", "exec('')")])[0].failure.error == "RejectedCodeError"


def test_no_example_motion(motions):
    none = motions.rows(np.arange(0))

    with pytest.raises(InferenceError, match=r"^Expected at least one example motion"):
        FunctionCheck(perception_layout(none.schema), none.arrays())


def missing_lock(self, _told):
    if not self._allow_weak:
        raise SandboxError("Expected all layers of the sandbox, but this system lacks landlock.")


def test_only_recorded_code_runs_where_a_lock_is_missing(motions, monkeypatch):
    monkeypatch.setattr(supervisor.Supervisor, "_check_locks", missing_lock)
    layout, columns = perception_layout(motions.schema), motions.arrays()
    other = candidate("fitness", "return 0")
    code = load_recording("faucet", sample=0).exchanges["fitness"].reply.functions[0].code
    recorded = Candidate(FunctionSource(name="a", description="", code=code), "fitness", "fitness")
    strict = FunctionCheck(layout, columns)

    assert strict.check([recorded])[0].failure is None
    for refused in ([other], [recorded, other]):
        with pytest.raises(SandboxError, match="lacks landlock"):
            strict.check(refused)
    with pytest.raises(SandboxError, match="lacks landlock"):
        strict.require_sandbox()
    weak = FunctionCheck(layout, columns, allow_weak=True)
    weak.require_sandbox()
    assert weak.check([recorded, other])[1].failure is None


@pytest.mark.parametrize("name", ["Grasp", "Faucet", "Drawer", "Push"])
def test_every_recorded_function_passes(name):
    task = get_task(f"LQD/{name}-v0")
    trajectories = rollout(task, example_solutions(task))
    examples = trajectories.rows(np.flatnonzero(trajectories.valid)).columns
    check = FunctionCheck(perception_layout(examples.schema), examples.arrays())

    for sample in range(5):
        functionals = infer(
            instruction=task.instruction,
            schema=task.schema,
            provider=ReplayProvider(),
            check=check.check,
            sample=sample,
        )
        assert (functionals.dropped, functionals.repaired) == ((), ())
        assert len(functionals.lengths) == COUNTS["quantities"] + 1
        assert len(functionals.fitness) + len(functionals.timestamps) == 7
        assert set(functionals.prompt_hashes) == set(KINDS)
        assert functionals.remarks == ()
