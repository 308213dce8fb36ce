"""In the sandbox every function gives what it gives in this process, bit for bit."""

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks.plain_functions import plain_function
from lqd_llm import available_samples, load_recording
from lqd_llm.sandbox import check_source
from lqd_llm.sandbox.functions import SandboxedFunction
from lqd_llm.sandbox.roles import Role
from lqd_llm.sandbox.sandbox import Sandbox
from lqd_search.evaluation.functional_calls import (
    RefusedValueError,
    call_descriptor,
    call_fitness,
    call_quantity,
    call_success,
    call_timestamp,
)
from lqd_search.evaluation.functionals import FunctionalEvaluator, Functionals

CORPORA = Path(__file__).parent / "corpora"
TASKS = {"grasp": "Grasp", "faucet": "Faucet", "drawer": "Drawer", "push": "Push"}
ROLES = {
    "success": Role.SUCCESS,
    "fitness": Role.FITNESS,
    "timestamps": Role.TIMESTAMP,
    "quantities": Role.QUANTITY,
}
DIRECT = (Role.SUCCESS, Role.FITNESS, Role.DESCRIPTOR)
REFUSED = "refused"


def listed(refusals):
    return [(r.name, str(r.role), len(r.motions), r.reason, int(r.motions[0])) for r in refusals]


def expected_of(refusals):
    return [(r.functional, r.kind, r.count, r.reason, r.first_motion) for r in refusals]


@pytest.fixture(params=TASKS)
def recorded(request, motions_of, layout_of):
    motions = motions_of(f"LQD/{TASKS[request.param]}-v0")
    return request.param, motions, layout_of(motions.columns)


def test_the_mesh_of_every_recording(recorded):
    name, motions, layout = recorded
    columns = motions.columns
    for sample in available_samples(name):
        told = load_recording(name, sample=sample)
        plain = {
            kind: {
                source.name: plain_function(source.code, entry=str(role))
                for source in told.exchanges[kind].reply.functions
            }
            for kind, role in ROLES.items()
        }
        ((success, call),) = plain.pop("success").items()
        evaluator = FunctionalEvaluator(
            Functionals(success=call, **plain), examples=motions.infos(0)
        )
        infos = ((i, motions.infos(i)) for i in range(len(motions)))
        values = evaluator(infos, valid=motions.valid)
        functions = [
            SandboxedFunction(source.name, role, check_source(source.code, entry=str(role)))
            for kind, role in ROLES.items()
            for source in told.exchanges[kind].reply.functions
        ]
        with Sandbox(layout, functions=functions) as sandbox:
            results = sandbox.run(columns.arrays())
        assert np.array_equal(results.success[success], values.success)
        assert list(results.fitness) == list(values.fitness)
        for fitness, column in values.fitness.items():
            assert np.array_equal(results.fitness[fitness], column, equal_nan=True)
        for descriptor, block in values.measures.items():
            numbers = results.quantities[tuple(descriptor.split("."))]
            assert np.array_equal(numbers[:, : block.shape[1]], block, equal_nan=True)
            assert np.isnan(numbers[:, block.shape[1] :]).all()
        assert listed(results.refusals) == expected_of(values.refusals)
        assert not results.dropped


def test_the_direct_functions_of_every_recording(recorded):
    name, motions, layout = recorded
    calls, functions = {}, []
    for sample in available_samples(name):
        direct = load_recording(name, sample=sample).exchanges["direct"].reply.functions
        assert {source.name for source in direct} == set(DIRECT)
        for source in direct:
            role = Role(source.name)
            calls[role, str(sample)] = plain_function(source.code, entry=source.name)
            checked = check_source(source.code, entry=source.name)
            functions.append(SandboxedFunction(str(sample), role, checked))
    with Sandbox(layout, functions=functions) as sandbox:
        results = sandbox.run(motions.columns.arrays())
    for motion in range(len(motions)):
        for (role, sample), call in calls.items():
            wanted = in_process(call, role, motions.infos(motion))
            assert in_sandbox(results, role, motion, name=sample) == wanted


BODIES = {
    Role.SUCCESS: (
        "return True",
        "return np.bool_(1)",
        "return 1",
        "return None",
        "return infos",
        "infos.clear()\n    return infos == []",
        "return infos[200]['x']",
        "return isinstance(infos[0], dict) and isinstance(infos[0]['gripper_contacts'], dict)",
        "return isinstance(infos[0], (list, tuple))",
        "return infos[0] == dict(infos[0]) and infos[0] != infos[-1] and {**infos[0]} == infos[0]",
        "return sorted(infos[0]) == sorted(infos[0].keys())",
    ),
    Role.FITNESS: (
        "return 1",
        "return True",
        "return np.float32(0.1)",
        "return np.int64(3)",
        "return 1e308",
        "return float('nan')",
        "return -math.inf",
        "return 10 ** 400",
        "return 'a'",
        "return 1 + 2j",
        "return np.array([1.0])",
        "return (x for x in [1])",
        "return math.sqrt(info['object_position'][2] - 1)",
        "return 1 / (info['gripper_position'][2] > 0.1)",
        "return np.linalg.inv(np.zeros((2, 2)))",
        "return np.add('a', 1)",
        "return info['nothing']",
        "raise StopIteration",
        "return entry(info)",
        "return [info][1]",
        "return lambda: 1",
        "return len",
        "return info",
    ),
    Role.TIMESTAMP: (
        "return infos[3]",
        "return None",
        "return 3",
        "return dict(infos[0])",
        "infos.sort(key=lambda i: -i['gripper_position'][2])\n    return infos[0]",
        "return next(i for i in infos if i['object_position'][2] > 9)",
    ),
    Role.QUANTITY: (
        "return (1, 2.5)",
        "return [1, True, np.float64(2)]",
        "return (1,)",
        "return tuple(range(7))",
        "return np.zeros(2)",
        "return {'a': 1}",
        "return (1.0, None)",
        "return (1.0, math.nan)",
        "return set()",
        "return tuple(info['gripper_position'])",
    ),
    Role.DESCRIPTOR: (
        "return None",
        "return infos[-1]['gripper_position']",
        "return 1.0",
        "return ()",
        "return infos[99]",
    ),
}
CALLS = {
    Role.SUCCESS: call_success,
    Role.FITNESS: call_fitness,
    Role.TIMESTAMP: call_timestamp,
    Role.QUANTITY: call_quantity,
    Role.DESCRIPTOR: call_descriptor,
}


def in_process(call, role, infos):
    """What in-process evaluation says of a function, and the words of a refusal."""
    argument = infos[-1] if role is Role.QUANTITY else infos
    try:
        with np.errstate(all="ignore"):
            value = CALLS[role](call, argument)
    except RefusedValueError as error:
        return REFUSED, str(error)
    if role is Role.TIMESTAMP and value is not None:
        return next(k for k, info in enumerate(infos) if info is value), ""
    return value, ""


def in_sandbox(results, role, motion, *, name="it"):
    for refused in results.refusals:
        if (refused.name, refused.role) == (name, role) and motion in refused.motions:
            return REFUSED, refused.reason
    if role is Role.SUCCESS:
        return bool(results.success[name][motion]), ""
    if role is Role.FITNESS:
        return float(results.fitness[name][motion]), ""
    if role is Role.TIMESTAMP:
        moment = int(results.moments[name][motion])
        return (None if moment < 0 else moment), ""
    if role is Role.QUANTITY:
        numbers, lengths = results.quantities["last", name], results.lengths["last", name]
    else:
        numbers, lengths = results.descriptors[name], results.descriptor_lengths[name]
    length = int(lengths[motion])
    return (tuple(numbers[motion, :length].tolist()) if length else None), ""


@pytest.mark.parametrize("role", Role)
def test_every_kind_of_value_and_refusal(role, function, mugs, layout):
    functions = {body: function(role, *body.split("\n    "), name=body) for body in BODIES[role]}
    last = function(Role.TIMESTAMP, "return infos[-1]", name="last")
    with Sandbox(layout, functions=[*functions.values(), last]) as sandbox:
        results = sandbox.run(mugs.arrays())
    assert not results.dropped
    calls = {
        name: plain_function(it.source.source, entry=it.source.entry)
        for name, it in functions.items()
    }
    for name in functions:
        for motion in range(3):
            wanted = in_process(calls[name], role, mugs.infos(motion))
            assert in_sandbox(results, role, motion, name=name) == wanted, name


@pytest.mark.parametrize("file", sorted(CORPORA.glob("benign*.jsonl")), ids=lambda file: file.stem)
def test_the_harmless_functions(file, mugs, layout):
    lines = [json.loads(text) for text in file.read_text().splitlines()]
    last = check_source("def last(infos):\n    return infos[-1]\n", entry="last")
    sources = {line["name"]: check_source(line["code"], entry=line["entry"]) for line in lines}
    functions = [
        SandboxedFunction(line["name"], Role(line["kind"]), sources[line["name"]]) for line in lines
    ]
    ending = SandboxedFunction("last", Role.TIMESTAMP, last)
    with Sandbox(layout, functions=[*functions, ending]) as sandbox:
        results = sandbox.run(mugs.arrays())
    assert not results.refusals
    for line in lines:
        role, name = Role(line["kind"]), line["name"]
        plain = plain_function(line["code"], entry=line["entry"])
        for motion in range(len(mugs.object_position)):
            value, _ = in_process(plain, role, mugs.infos(motion))
            if role is Role.SUCCESS:
                assert results.success[name][motion] == value
            elif role is Role.FITNESS:
                assert results.fitness[name][motion] == value
            elif role is Role.TIMESTAMP:
                assert results.moments[name][motion] == (-1 if value is None else value)
            else:
                length = results.lengths["last", name][motion]
                assert tuple(results.quantities["last", name][motion, :length]) == value
