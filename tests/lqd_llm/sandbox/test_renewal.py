"""Functions that hold something at their top level: no call finds what another left there."""

import math

import numpy as np
import pytest

from lqd_llm.sandbox import Role, Sandbox, SandboxedFunction, check_source
from lqd_llm.sandbox.facades import new_namespace
from lqd_llm.sandbox.renewal import ChangedConstantError, RenewedFunction, can_be_changed

CHANGED = "changed a value at its top level, so that one call would remember another"


def defined(code):
    return {**new_namespace(), **run(code)}


def run(code):
    namespace = new_namespace()
    exec(code, namespace)
    return namespace


def renewed(code):
    return RenewedFunction(lambda: run(code), entry="f")


@pytest.mark.parametrize(
    "code",
    [
        "",
        "A = 1; B = 2.5; C = 'text'; D = None; E = True; F = 1j",
        "A = (1, (2.0, 'b')); B = frozenset({1}); C = range(3); D = slice(1, 2)",
        "A = np.pi; B = np.float64(3.0); C = np.add; D = np.mean; E = np.linalg.norm; F = np.array",
        "A = math.sin; B = len; C = float; numpy = np; la = np.linalg; m = math",
        "def f(x, y=(1, 2), *, z=None): return x\ng = lambda x=1: x",
        "A = [lambda: n for n in (1, 2)][0]",
    ],
)
def test_what_cannot_be_changed(code):
    assert not can_be_changed(defined(code))


@pytest.mark.parametrize(
    "code",
    [
        "A = []",
        "A = {}",
        "A = {1}",
        "A = (1, [2])",
        "A = np.zeros(2)",
        "A = [].append",
        "A = slice([], 1)",
        "A = {}.items()",
        "A = iter([1])",
        "KEPT = []\ndef f(x, kept=KEPT): return x\nKEPT = None",
        "KEPT = []\ndef f(x, *, kept=KEPT): return x\nKEPT = None",
        "A = [lambda: kept for kept in [[]]][0]",
    ],
)
def test_what_might_be_changed(code):
    assert can_be_changed(defined(code))


@pytest.mark.parametrize(
    ("constant", "change"),
    [
        ("[1.0]", "kept.append(x)"),
        ("[1.0]", "kept[0] = -kept[0]"),
        ("[0.0]", "kept[0] = -0.0"),
        ("[1]", "kept[0] = True"),
        ("[3, 1, 2]", "kept.sort()"),
        ("{'a': 1}", "kept['a'] += 1"),
        ("{'a': 1, 'b': 2}", "kept['a'] = kept.pop('a')"),
        ("{1, 2}", "kept.discard(2)"),
        ("([],)", "kept[0].append(x)"),
        ("{'a': [[]]}", "kept['a'][0].append(x)"),
        ("np.zeros(3)", "kept[1] = x"),
        ("np.zeros((2, 2))", "kept[:, 0].fill(x)"),
        ("[]", "kept.append(kept)"),
    ],
)
def test_a_change_is_seen(constant, change):
    code = f"KEPT = {constant}\ndef f(x):\n    kept = KEPT\n    {change}\n    return x\n"

    with pytest.raises(ChangedConstantError):
        renewed(code)(1.0)


@pytest.mark.parametrize(
    "constant",
    [
        "[1.0, float('nan')]",
        "{'near': lambda x: x, 'far': math.sqrt}",
        "np.array([1.0, np.nan])",
        "[10 ** 5000, {10 ** 5000}, {math.sin, np.add}, {lambda: 0}]",
        "[np.float64(1.5), np, [].append, {1, 'a', None}]",
        "[lambda: kept for kept in [[1]]]",
        "(complex(1, -0.0), range(3), slice(0, 1))",
    ],
)
def test_what_is_only_read_stays(constant):
    function = renewed(f"KEPT = {constant}\ndef f(x):\n    return (len(KEPT), x)\n")
    length = len(run(f"KEPT = {constant}")["KEPT"])

    assert [function(k) for k in range(3)] == [(length, k) for k in range(3)]


def test_a_call_finds_nothing_of_another_where_no_change_is_seen():
    code = (
        "(PUSH, ALL) = [(kept.append, kept.copy) for kept in [[]]][0]\n"
        "def f(x):\n    PUSH(x)\n    return ALL()\n"
    )
    function = renewed(code)

    assert [function(k) for k in range(3)] == [[0], [1], [2]]


def test_what_python_notes_of_its_warnings_is_no_change():
    code = "KEPT = [1.0]\ndef f(x):\n    return len(KEPT) + (np.nanmean([np.nan]) != 0)\n"
    function = renewed(code)

    # It notes them in the globals of the code that runs.
    with pytest.warns(RuntimeWarning, match="Mean of empty slice"):
        assert [function(k) for k in range(3)] == [2, 2, 2]


def test_a_constant_that_python_warned_of_is_as_fixed_as_any():
    with pytest.warns(RuntimeWarning, match="Mean of empty slice"):
        namespace = defined("EMPTY = np.nanmean([np.nan])")

    assert "__warningregistry__" in namespace
    assert not can_be_changed(namespace)


def test_in_the_sandbox(mugs, layout):
    bodies = {
        "counts": "kept = KEPT\n    kept.append(1)\n    return float(len(kept))",
        "tells late": "kept = KEPT\n    kept += [1]\n    return 0.0 if len(kept) < 500 else 1.0",
        "reads": "return KEPT[0] + info['gripper_position'][2]",
        "fails": "return KEPT[0] + info['nothing']",
        "warns": "return KEPT[0] + float(np.nan_to_num(np.array([]).mean()))",
    }
    functions = [
        SandboxedFunction(
            name,
            Role.FITNESS,
            check_source(f"KEPT = [1.0]\ndef fitness(info):\n    {body}\n", entry="fitness"),
        )
        for name, body in bodies.items()
    ]
    with Sandbox(layout, functions=functions) as sandbox:
        results = sandbox.run(mugs.arrays())

    motions = len(mugs.object_position)
    reasons = {refused.name: refused.reason for refused in results.refusals}
    heights = mugs.gripper_position[:, :, 2].tolist()
    assert reasons == {
        "counts": CHANGED,
        "tells late": CHANGED,
        "fails": "raised KeyError in line 3",
    }
    assert all(len(refused.motions) == motions for refused in results.refusals)
    assert results.fitness["reads"].tolist() == [
        math.fsum([1.0 + z for z in row]) / len(row) for row in heights
    ]
    assert results.fitness["warns"].tolist() == [1.0] * motions
    assert np.isnan(results.fitness["tells late"]).all()
