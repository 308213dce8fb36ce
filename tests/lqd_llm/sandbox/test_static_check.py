import io
import json
import tokenize
import warnings
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lqd_llm.sandbox import RejectedCodeError, check_source
from lqd_llm.sandbox.allowlist import (
    DEEPEST_BRACKETS,
    DEEPEST_TREE,
    LONGEST_NAME,
    LONGEST_SOURCE,
    MOST_NODES,
)

CORPORA = Path(__file__).parent / "corpora"

STOPPED_LATER = {"annotation_evaluated", "math_prod_bomb", "pow_builtin_tower"}
"""Attacks that may be refused but pass, since what they do is lost or stopped when they run."""

REFUSED_ALREADY = {
    *("bidi_comment_trojan", "coding_cookie", "clock_by_item_of_durations", "value_duration"),
}
"""Attacks that may run but are refused."""


def lines_of(pattern):
    texts = [file.read_text("utf-8") for file in sorted(CORPORA.glob(pattern))]
    return [json.loads(line) for text in texts for line in text.splitlines()]


ATTACKS = lines_of("attacks*.jsonl")
BENIGN = lines_of("benign*.jsonl")


def named(cases):
    return [pytest.param(case, id=case["name"]) for case in cases]


def refusal(code, *, entry="fitness"):
    with pytest.raises(RejectedCodeError) as caught:
        check_source(code, entry=entry)
    return caught.value


def function(body):
    return f"def fitness(info):\n    {body}\n"


def test_corpora_have_distinct_names_and_known_outcomes():
    outcomes = {"ok", "rejected", "timeout", "memory", "bad_value", "contained"}
    names = [case["name"] for case in ATTACKS + BENIGN]

    assert len(set(names)) == len(names)
    for case in ATTACKS + BENIGN:
        assert {case["expected"], *case.get("also_ok", [])} <= outcomes


@pytest.mark.parametrize("case", named(BENIGN))
def test_benign_code_passes(case):
    checked = check_source(case["code"], entry=case["entry"])

    assert checked.entry == case["entry"]
    assert checked.source.count("\n") == case["code"].rstrip("\n").count("\n") + 1


@pytest.mark.parametrize(
    "code",
    [
        function("try:\n        return info['a']\n    except:\n        return 0.0"),
        "def g(x, **more):\n    return x\ndef fitness(info):\n    return g(**info)\n",
        function("return len(dict(**info))"),
        function("return np.add.reduce(info) + np.maximum.accumulate(info, 0)[0]"),
        function("return np.add.reduce(info, axis=0, dtype=float)"),
        "def fitness(info):\n    def g():\n        yield 1\n    try:\n        return next(g())\n"
        "    except:\n        return 0\n",
        "def fitness(info):\n    def g():\n        try:\n            yield 1\n"
        "        except (KeyError, ValueError):\n            pass\n"
        "        except np.linalg.LinAlgError:\n            pass\n    return sum(g())\n",
        function("return np.divide(info, 2, out=np.zeros(3), where=info != 0)"),
        function("out = info.astype(float)\n    return np.log(info, out=out, where=info > 0)"),
        function("return np.mean(info, where=info > 0) + info.sum(where=True)"),
        function("return np.maximum.reduce(info, initial=0, where=info > 0)"),
        "def g(x, where):\n    return x[where]\n\ndef fitness(info):\n"
        "    return g(info, where='a')\n",
        function("return np.sum(info, 0, float) + info.mean(0, None) + info.trace(0, 0, 1, int)"),
    ],
)
def test_what_honest_code_does_passes(code):
    assert check_source(code, entry="fitness").source == code


@pytest.mark.parametrize("case", named(ATTACKS))
def test_attack_is_refused_when_it_should_be(case):
    good = {case["expected"], *case["also_ok"]}
    refused = case["expected"] == "rejected" or case["name"] in REFUSED_ALREADY
    if refused and case["name"] not in STOPPED_LATER:
        assert "rejected" in good
        assert refusal(case["code"], entry=case["entry"]).reason
    else:
        assert good - {"rejected"}
        assert check_source(case["code"], entry=case["entry"]).entry == case["entry"]


@pytest.mark.parametrize(
    ("code", "line", "reason"),
    [
        (function("return eval('1')"), 2, "the name 'eval' is neither defined nor among"),
        (
            function("return info.keyz()"),
            2,
            "the attribute 'keyz' is not allowed; allowed are keys",
        ),
        (
            function("return np.trapz([1.0])"),
            2,
            "np has no 'trapz' here; allowed are trapezoid and others",
        ),
        (function("return np.linalg.nrom([1.0])"), 2, "np.linalg has no 'nrom' here"),
        (function("return np.lib.npyio.save('x')"), 2, "np has no 'lib' here"),
        (function("\n\n    del info"), 4, "del is not allowed"),
        ("import math\nimport os\n", 2, "importing 'os' is not allowed; math and np are there"),
        ("from ..a import b\n", 1, "importing '..a' is not allowed"),
        ("from . import b\n", 1, "importing '.' is not allowed"),
        (function("return (\n"), 2, "it is not valid Python: '(' was never closed"),
        (function("x = f'{1:>{2}}'"), 2, "a format in an f-string may only be a plain one"),
        ("X = [1]\nX += [2]\n", 2, "only functions and constants can stand at the top level"),
        ("def fitnes(info): return 0\n", None, "there must be a function 'fitness' at the top"),
        ("def fitness(a, b): return 0\n", 1, "fitness(a, b) does not take one positional"),
        (function("break"), 2, "it is not valid Python: 'break' outside loop"),
        (function("return np.zeros(1).astype(info)"), 2, "the elements of an array can only be"),
        (function("return np.add.reduce(info, 0, 'O')"), 2, "reduce takes an array and an axis"),
        (function("return max(map(np.add.reduce, info))"), 2, "reduce takes an array and an axis"),
        (function("return np.sum(**info)"), 2, "** can only be used in calls of dict and of"),
        (function("f = np.sum\n    return f(**info)"), 3, "** can only be used in calls of dict"),
        (function("return fitness(**{})") + "fitness = 1\n", 2, "** can only be used in calls"),
        (function("dict = np.sum\n    return dict(**info)"), 3, "** can only be used in calls"),
        (function("return np.add(1, 2, sig='l')"), 2, "the argument 'sig' is not allowed"),
        (
            "def fitness(info):\n    def g():\n        try:\n            yield 1\n"
            "        except:\n            pass\n",
            5,
            "an except in a generator must name its exceptions",
        ),
        (
            "def fitness(info):\n    def g():\n        try:\n            yield 1\n"
            "        except KeyError:\n            pass\n        except (ValueError, fitness(1)):\n"
            "            pass\n",
            7,
            "an except in a generator must name its exceptions",
        ),
        (
            function("return np.add(info, 1,\n        where=info > 0)"),
            3,
            "where= leaves the other elements undefined: say what they shall be with out=",
        ),
        (
            function("return np.pad(info, 1,\n        mode='empty')"),
            3,
            "the mode 'empty' leaves the new elements undefined; use 'constant'",
        ),
        (function("return np.sum(info, 0, info)"), 2, "the elements of an array can only be"),
        (function("return info.sum(0, 'O')"), 2, "the elements of an array can only be"),
        (function("return np.trace(info, 0, 0, 1, 'O')"), 2, "the elements of an array can only"),
        (function("return np.sum(*info)"), 2, "the arguments of sum must be written out"),
    ],
)
def test_refusal_says_line_and_reason(code, line, reason):
    refused = refusal(code)

    assert refused.line == line
    assert refused.reason.startswith(reason)
    place = f"line {line}" if line else "the code"
    assert str(refused) == (
        f"Expected code that the sandbox allows, but {place} is refused: {refused.reason}."
    )


@pytest.mark.parametrize(
    ("largest", "over", "reason"),
    [
        (
            function("return 0.0") + "#" * (LONGEST_SOURCE - len(function("return 0.0"))),
            lambda code: code + "#",
            f"the code has {LONGEST_SOURCE + 1} characters, more than the {LONGEST_SOURCE}",
        ),
        (
            # The module, the function and the return are levels too.
            function("return " + "+".join("1" * (DEEPEST_TREE - 3))),
            lambda code: code.replace("+1\n", "+1+1\n"),
            f"the code is nested more than {DEEPEST_TREE} levels deep",
        ),
        (
            function("return (" + "(" * (DEEPEST_BRACKETS - 1) + "0" + ")" * DEEPEST_BRACKETS),
            lambda code: code.replace("0", "(0)"),
            f"more than {DEEPEST_BRACKETS} brackets are open at once",
        ),
        (
            function(f"{'a' * LONGEST_NAME} = 1"),
            lambda code: code.replace("aa", "aaa", 1),
            f"a name has more than {LONGEST_NAME} characters",
        ),
        (function(f"return {2**64 - 1}"), lambda code: code.replace("15\n", "16\n"), "an integer"),
    ],
    ids=["characters", "levels", "brackets", "name", "integer"],
)
def test_limits_are_where_they_are_said_to_be(largest, over, reason):
    assert check_source(largest, entry="fitness").entry == "fitness"
    assert refusal(over(largest)).reason.startswith(reason)


def test_number_of_nodes_is_limited():
    code = function("x = [" + "0," * MOST_NODES + "]")

    assert f"more than the {MOST_NODES} allowed" in refusal(code).reason


@pytest.mark.parametrize("name", ["_", "_helper", "max", "sum", "dir", "type", "file"])
def test_names_may_be_bound(name):
    check_source(function(f"{name} = 1.0\n    return {name}"), entry="fitness")


@pytest.mark.parametrize("name", ["np", "math", "__", "a__b", "__builtins__"])
@pytest.mark.parametrize(
    "code",
    [
        "X = 1\n",
        "def X(): return 1\n",
        "def f(X): return 1\n",
        "def f(*, X=1): return 1\n",
        "def f(): return [1 for X in [1]]\n",
        "def f():\n    try: return 1\n    except KeyError as X: return 2\n",
        "def f(): return (X := 1)\n",
        "def f(): return lambda X: 1\n",
        "from math import pi as X\n",
    ],
)
def test_names_may_not_be_bound(name, code):
    assert repr(name) in refusal(code.replace("X", name) + function("return 1")).reason


def test_remarks_of_python_are_neither_shown_nor_errors():
    code = function("'''\\d'''\n    return 0.0 is 1.0")

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        checked = check_source(code, entry="fitness")
    assert checked.source == code


def tokens_of(code):
    return [
        token.string
        for token in tokenize.generate_tokens(io.StringIO(code).readline)
        if token.type not in (tokenize.INDENT, tokenize.DEDENT, tokenize.NL, tokenize.ENDMARKER)
    ]


TOKENS = [tokens_of(case["code"]) for case in BENIGN]
STRANGE = (
    *(".__class__", ".gi_frame", ".format", ".save", "__import__", "import os", "eval", "lambda:"),
    *("class", "async", "await", "yield", "finally:", "*", "**", ":=", "@", "del", "0x1p3", "\0"),
    *(
        "\\",
        "\n",
        "\n    ",
        "(",
        ")",
        "[",
        "'",
        '"""',
        "#",
        "{",
        "f'{",
        ":",
        "->",
        "= 1",
        "\uff41",
        "\ud800",
    ),
)


@given(data=st.data())
def test_damaged_code_is_refused_or_compiles(data):
    case = data.draw(st.sampled_from(BENIGN))
    text = case["code"]
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(text)))
        end = min(start + data.draw(st.integers(0, 12)), len(text))
        new = data.draw(st.sampled_from([*STRANGE, text[start:end] * 2, ""]))
        text = text[:start] + new + text[end:]

    assert_refused_or_compiles(text, entry=case["entry"])


@given(data=st.data())
def test_shuffled_tokens_are_refused_or_compile(data):
    tokens = list(data.draw(st.sampled_from(TOKENS)))
    for _ in range(data.draw(st.integers(1, 5))):
        place = data.draw(st.integers(0, len(tokens) - 1))
        other = data.draw(st.integers(0, len(tokens) - 1))
        tokens[place : place + 1] = data.draw(
            st.sampled_from([[], [tokens[other]], [tokens[place]] * 2, [tokens[place], "."]])
        ) or [" "]

    assert_refused_or_compiles(" ".join(tokens), entry="fitness")


@given(text=st.text(max_size=200), entry=st.text(max_size=10))
def test_any_text_is_refused_or_compiles(text, entry):
    assert_refused_or_compiles(text, entry=entry)


def assert_refused_or_compiles(text, *, entry):
    try:
        source = check_source(text, entry=entry).source
    except RejectedCodeError as refused:
        source = "" if refused.reason and refused.line != 0 else None
    assert source is not None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        compile(source, "<test>", "exec")
