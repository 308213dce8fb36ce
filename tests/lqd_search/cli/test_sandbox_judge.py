"""Judging in the sandbox gives what judging in this process gives, bit for bit."""

import dataclasses
from contextlib import closing
from functools import cache

import numpy as np
import pytest

from benchmarks.plain_functions import plain_direct_functionals, plain_function
from lqd_envs import PAPER_TASKS, SolutionSpace, get_task, rollout
from lqd_envs.tasks.examples import example_solutions
from lqd_llm import available_samples, load_recording, perception_layout
from lqd_llm.sandbox import InfoLayout, RejectedCodeError, Sandbox, SandboxError
from lqd_search import FunctionalEvaluator, Functionals
from lqd_search.cli.opened_sandbox import open_sandbox, sandboxed
from lqd_search.cli.sandbox_judge import SandboxDirectJudge, SandboxMeshJudge
from lqd_search.evaluation.direct_judge import DirectJudge
from lqd_search.evaluation.functionals import FunctionalError
from lqd_search.evaluation.mesh_judge import MeshJudge
from lqd_search.evaluation.values import StoppedFunction
from lqd_search.runs.function_text import FunctionText

FAUCET = get_task("LQD/Faucet-v0")
# Turns the hot tap by 1.57 rad.
TURNING = (0.07, 0.68, -0.05, 0.47, -0.83, 2.41, -0.47, -0.51, 0.06)
TAP = "['joint_positions']['hot_tap']"
MESH = {
    ("success", "success"): f"return infos[-1]{TAP} > 0.314",
    ("fitness", "height"): "return info['gripper_position'][2]",
    ("fitness", "opening"): f"return info{TAP}",
    ("timestamp", "end"): "return infos[-1]",
    ("timestamp", "touch"): (
        "return next((i for i in infos if any(i['gripper_contacts'].values())), None)"
    ),
    ("quantity", "place"): "return info['gripper_position']",
    ("quantity", "taps"): "return tuple(info['joint_positions'].values())",
}
DIRECT = {
    ("direct.success", "success"): MESH["success", "success"],
    ("direct.fitness", "fitness"): f"return info{TAP}",
    ("direct.descriptor", "descriptor"): "return infos[-1]['gripper_position']",
}


@cache
def motions_of(task_id):
    """Motions of a task: 20 random ones, one that turns the tap, 40 more, and its examples."""
    random = SolutionSpace().sample(60, rng=np.random.default_rng(0))
    chosen = example_solutions(get_task(task_id))[64:]
    return rollout(task_id, np.concatenate([random[:20], [TURNING], random[20:], chosen]))


def text(kind, name, body):
    entry = kind.rpartition(".")[2]
    argument = "info" if entry in ("fitness", "quantity") else "infos"
    return FunctionText(kind, name, "It measures.", f"def {entry}({argument}):\n    {body}\n")


def texts(functions, **changes):
    changed = functions | {key: changes.pop(key[1], body) for key, body in functions.items()}
    assert not changes
    return [text(kind, name, body) for (kind, name), body in changed.items()]


def mesh_here(written, example, raising=()):
    """The judge of this process; some of its functions raise once it is made."""
    made = []

    def calls(kind):
        return {one.name: call_of(one) for one in written if one.kind == kind}

    def call_of(one):
        def judge_or_raise(argument):
            if made:
                raise RuntimeError(one.name)
            return plain(argument)

        plain = plain_function(one.code, entry=one.entry)
        return judge_or_raise if one.name in raising else plain

    functionals = Functionals(
        success=calls("success")["success"],
        fitness=calls("fitness"),
        timestamps=calls("timestamp"),
        quantities=calls("quantity"),
    )
    judge = MeshJudge(FunctionalEvaluator(functionals, examples=[example]))
    made.append(judge)
    return judge


def assert_same(values, expected):
    for field in dataclasses.fields(expected):
        ours, theirs = getattr(values, field.name), getattr(expected, field.name)
        if isinstance(theirs, dict):
            assert list(ours) == list(theirs)
            for name, column in theirs.items():
                assert ours[name].dtype == column.dtype
                assert ours[name].shape == column.shape
                assert ours[name].tobytes() == column.tobytes(), name
        else:
            np.testing.assert_equal(ours, theirs)


MESH_PROMPTS = {
    "success": "success",
    "fitness": "fitness",
    "timestamps": "timestamp",
    "quantities": "quantity",
}


def recorded(task, *, sample):
    """The functions of a recording, those of the mesh and those that are direct."""
    exchanges = load_recording(task.name, sample=sample).exchanges
    kinds = {
        kind: [(kind, one) for one in exchanges[prompt].reply.functions]
        for prompt, kind in MESH_PROMPTS.items()
    }
    direct = [(f"direct.{one.name}", one) for one in exchanges["direct"].reply.functions]
    return (
        [
            FunctionText(kind, kind if kind == "success" else one.name, one.description, one.code)
            for functions in kinds.values()
            for kind, one in functions
        ],
        [FunctionText(kind, one.name, one.description, one.code) for kind, one in direct],
    )


def direct_here(written, examples):
    return DirectJudge(plain_direct_functionals(written), examples=examples)


def check_recording(task, *, sample, direct):
    written, motions = recorded(task, sample=sample)[direct], motions_of(task.id)
    examples = [motions.infos(int(i)) for i in np.flatnonzero(motions.valid)]
    here = direct_here(written, examples) if direct else mesh_here(written, examples[0][0])
    assert here.dropped == ()
    lengths = {
        "direct.descriptor" if direct else name.partition(".")[2]: length
        for name, length in here.descriptors.items()
    }
    with closing(open_sandbox(task.schema, written)) as sandbox:
        judge = (
            SandboxDirectJudge(sandbox, lengths=lengths)
            if direct
            else SandboxMeshJudge(sandbox, functions=written, lengths=lengths)
        )
        assert judge.fitness_names == here.fitness_names
        assert list(judge.descriptors.items()) == list(here.descriptors.items())
        assert judge.dropped == ()
        values = judge(motions)
        assert_same(values, here(motions))
        assert values.stopped == ()


@pytest.mark.parametrize("direct", [False, True])
@pytest.mark.parametrize("task", PAPER_TASKS, ids=lambda task: task.name)
def test_the_first_recording_of_each_task(task, direct):
    check_recording(task, sample=0, direct=direct)


@pytest.mark.slow
@pytest.mark.parametrize("direct", [False, True])
@pytest.mark.parametrize("task", PAPER_TASKS, ids=lambda task: task.name)
def test_every_other_recording(task, direct):
    samples = available_samples(task.name)
    assert len(samples) == 5
    for sample in samples[1:]:
        check_recording(task, sample=sample, direct=direct)


LATE = f"if info{TAP} > 0.3 else"


STRANGE = {
    ("fitness", "raising"): f"return 1 / 0 {LATE} 1.0",
    ("fitness", "text"): f"return 'high' {LATE} 1.0",
    ("fitness", "infinite"): f"return math.inf {LATE} info{TAP}",
    ("fitness", "large"): f"return 1.7e308 {LATE} 1.0",
    ("fitness", "nowhere"): "return 0 / 0 if info['robot_table_contact'] else 1",
    ("timestamp", "absent"): f"return None if infos[-1]{TAP} > 0.3 else infos[-1]",
    ("timestamp", "copied"): f"return dict(infos[0]) if infos[-1]{TAP} > 0.3 else infos[5]",
    ("timestamp", "same"): "return infos[-1]",
    ("timestamp", "lost"): "raise KeyError('lost')",
    ("quantity", "single"): f"return 1 {LATE} (1, 2)",
    ("quantity", "nan"): f"return (1.0, math.nan) {LATE} (1.0, -0.0)",
    ("quantity", "longer"): f"return (1, 2, 3) {LATE} [True, np.float32(0.1)]",
    ("quantity", "shorter"): f"return info['tap'] {LATE} (1, 2, 3, 4, 5)",
}


@pytest.mark.parametrize(
    "success", ["return infos[-1]['nothing']", "return 1", "return np.float64(1) > 0"]
)
def test_whatever_the_functions_of_a_mesh_do(success):
    written, motions = texts(MESH | STRANGE, success=success), motions_of(FAUCET.id)
    first = int(np.flatnonzero(motions.valid)[0])
    here = mesh_here(written, motions.infos(first)[0])
    assert here.dropped == ()
    lengths = {name.partition(".")[2]: length for name, length in here.descriptors.items()}
    with closing(open_sandbox(FAUCET.schema, written)) as sandbox:
        judge = SandboxMeshJudge(sandbox, functions=written, lengths=lengths)
        values, expected = judge(motions), here(motions)
        refused = {refusal.functional for refusal in expected.refusals}
        assert refused >= {name for _, name in STRANGE} - {"nowhere", "absent", "same"}
        assert_same(values, expected)
        part = motions.rows(np.arange(15, 30))
        assert_same(judge(part), here(part))


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"success": "return None"},
        {"fitness": f"return [][0] {LATE} 1.0"},
        {"descriptor": f"return None if infos[-1]{TAP} > 0.3 else (1, 2)"},
        {"descriptor": f"return (1, 2, 3) if infos[-1]{TAP} > 0.3 else (1, 2)"},
        {"descriptor": f"return (1, math.inf) if infos[-1]{TAP} > 0.3 else (1, 2)"},
    ],
)
def test_whatever_direct_functions_do(changes):
    written, motions = texts(DIRECT, **changes), motions_of(FAUCET.id)
    first = int(np.flatnonzero(motions.valid)[0])
    here = direct_here(written, [motions.infos(first)])
    lengths = {"direct.descriptor": here.descriptors["direct"]}
    with closing(open_sandbox(FAUCET.schema, written)) as sandbox:
        judge = SandboxDirectJudge(sandbox, lengths=lengths)
        assert (judge.fitness_names, judge.descriptors) == (here.fitness_names, here.descriptors)
        assert_same(judge(motions), here(motions))


def test_names_of_single_functions_are_those_of_their_refusals():
    written = [dataclasses.replace(one, name="tap_is_open") for one in texts(MESH, success="1")]
    assert sandboxed(written[0]).name == "success"
    assert [sandboxed(one).name for one in texts(DIRECT)] == ["direct"] * 3


def test_a_batch_without_valid_motions_has_no_values():
    motions = motions_of(FAUCET.id)
    with closing(open_sandbox(FAUCET.schema, texts(MESH))) as sandbox:
        judge = SandboxMeshJudge(sandbox, functions=texts(MESH), lengths={"place": 3, "taps": 2})
        for rows in (np.flatnonzero(~motions.valid), np.arange(0)):
            values = judge(motions.rows(rows))
            assert len(values) == len(rows)
            assert not values.success.any()
            assert all(np.isnan(column).all() for column in values.fitness.values())
            assert all(np.isnan(block).all() for block in values.measures.values())
            assert values.refusals == ()


def stopped_of(functions):
    return tuple(
        StoppedFunction(sandboxed(one).name, one.entry, f"was stopped: {one.name}")
        for one in functions
    )


@pytest.mark.parametrize(
    "names",
    [("success", "place"), ("height", "end"), ("touch", "taps", "opening"), ("end", "touch")],
)
def test_a_function_that_was_stopped_is_refused_wherever_it_would_be_called(names):
    motions, written = motions_of(FAUCET.id), texts(MESH)
    chosen = [one for one in written if one.name in names]
    here = mesh_here(written, motions.infos(int(np.flatnonzero(motions.valid)[0]))[0], names)
    # In process they raise instead.
    expected = here(motions)
    stopped = stopped_of(chosen)
    reasons = {(s.kind, s.functional): s.reason for s in stopped}
    with closing(open_sandbox(FAUCET.schema, written, stopped=stopped)) as sandbox:
        judge = SandboxMeshJudge(
            sandbox, functions=written, lengths={"place": 3, "taps": 2}, stopped=stopped
        )
        values = judge(motions)
    refusals = {dataclasses.replace(r, reason="") for r in expected.refusals}
    assert {dataclasses.replace(r, reason="") for r in values.refusals} == refusals
    assert all(r.reason == reasons[r.kind, r.functional] for r in values.refusals)
    assert len(values.refusals) == len(refusals) == len(names)
    assert_same(dataclasses.replace(values, refusals=expected.refusals), expected)


def test_where_all_functions_were_stopped_there_is_no_sandbox():
    motions = motions_of(FAUCET.id)
    for written, lengths in (
        (texts(MESH), {"place": 3, "taps": 2}),
        (texts(DIRECT), {"direct.descriptor": 3}),
    ):
        stopped = stopped_of(written)
        assert open_sandbox(FAUCET.schema, written, stopped=stopped) is None
        judge = (
            SandboxMeshJudge(None, functions=written, lengths=lengths, stopped=stopped)
            if len(lengths) > 1
            else SandboxDirectJudge(None, lengths=lengths, stopped=stopped)
        )
        values = judge(motions)
        assert not values.success.any()
        assert all(np.isnan(column).all() for column in values.fitness.values())
        assert all(np.isnan(block).all() for block in values.measures.values())
        # A quantity is not called where there are no moments.
        called = [s for s in stopped if s.kind != "quantity"]
        assert [r.functional for r in values.refusals] == [s.functional for s in called]
        assert {r.count for r in values.refusals} == {motions.valid.sum()}


def test_a_function_that_takes_too_much_is_stopped_and_named():
    hoard = f"return [0] * 10 ** (10 if infos[-1]{TAP} > 0.3 else 1) == []"
    written, motions = texts(MESH, success=hoard), motions_of(FAUCET.id)
    with closing(open_sandbox(FAUCET.schema, written)) as sandbox:
        judge = SandboxMeshJudge(sandbox, functions=written, lengths={"place": 3, "taps": 2})
        values = judge(motions)
        (stopped,) = values.stopped
        assert (stopped.kind, stopped.functional) == ("success", "success")
        assert stopped.reason == "was stopped: it took more than 1024 MiB of memory"
        assert [(r.functional, r.reason, r.first_motion) for r in values.refusals] == [
            ("success", stopped.reason, 20)
        ]
        assert judge(motions.rows(np.arange(10))).stopped == (stopped,)
    here = mesh_here(texts(MESH), motions.infos(int(np.flatnonzero(motions.valid)[0]))[0])(motions)
    assert_same(dataclasses.replace(values, refusals=(), stopped=(), success=here.success), here)


@pytest.mark.parametrize("task", PAPER_TASKS, ids=lambda task: task.name)
def test_the_layout_is_that_of_the_columns(task):
    columns = rollout(task, np.empty((0, 9))).columns
    joints = tuple(joint.name for joint in columns.schema.joints)
    names = {"gripper_contacts": columns.schema.links, "joint_positions": joints}
    assert perception_layout(task.schema) == InfoLayout.of(columns.arrays(), names=names)


def test_code_that_the_sandbox_refuses_is_not_run():
    with pytest.raises(RejectedCodeError, match="line 2 is refused"):
        open_sandbox(FAUCET.schema, texts(MESH, height="return open('a')"))


def test_a_missing_length_is_named():
    with pytest.raises(FunctionalError, match=r"numbers 'taps' measures, .* only for 'place'; ch"):
        SandboxMeshJudge(None, functions=texts(MESH), lengths={"place": 3})
    with pytest.raises(FunctionalError, match=r"how many numbers 'direct\.descriptor' measures"):
        SandboxDirectJudge(None, lengths={})


def test_a_closed_sandbox_judges_nothing():
    with closing(open_sandbox(FAUCET.schema, texts(MESH))) as sandbox:
        judge = SandboxMeshJudge(sandbox, functions=texts(MESH), lengths={"place": 3, "taps": 2})
    assert isinstance(sandbox, Sandbox)
    with pytest.raises(SandboxError, match="Expected a sandbox that is open"):
        judge(motions_of(FAUCET.id))
