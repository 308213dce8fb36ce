"""Annotations and imports: what is left out, and that all else stays where it was."""

import ast

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lqd_llm.sandbox import RejectedCodeError
from lqd_llm.sandbox.plain_source import plain_source

ANNOTATIONS = (
    *("int", "(int)", "((int))", "'x: y = 3'", "Dict[str, int]", "Dict[\n  str,\n  int\n ]"),
    *("(\n Info  # c: = ->\n)", "lambda x, y=3: (x)", "f(a=1, b={2: 3})", "a if b else c"),
    *("x[1:2]", "'''a\nb: = '''", "not a", "-1 ** 2", "(yield_ := 4)", "f'{x!r:>3}'", "'θ→'"),
    *("Callable[[int], 'a->b']", "a |\\\n b"),
)
FORMS = (
    "def f(x: A, /, y: B = 1, *rest: A, k: B = (2), **more: A) -> B:\n    return x\nz = f",
    "def f(x: A) -> (B): return x  # c\nz = 1",
    "def f(\n    x: A,  # c: d\n    y: B = 'é: ='\n) -> A:\n    return x == y",
    "x: A = 1",
    "x: A = (1)\ny = 2",
    "(x): B = lambda y: y",
    "if 1:\n    x: A\n    y: B; z: A = 3\nelse:\n    x: A",
    "x['é']: A = 1; x[0]: B = [\n 1]; y = 2",
    "def f():\n    é: A = {1: 2}\n    def g(a, b: B) -> A: pass\n    return g".replace("é", "e"),
)


class Strip(ast.NodeTransformer):
    def visit_FunctionDef(self, node):
        node.returns = None
        return self.generic_visit(node)

    def visit_arg(self, node):
        node.annotation = None
        return node

    def visit_AnnAssign(self, node):
        self.generic_visit(node)
        new = ast.Assign([node.target], node.value) if node.value else ast.Pass()
        return ast.copy_location(new, node)


def shape(tree):
    lines = [
        (type(node).__name__, node.lineno) for node in ast.walk(tree) if hasattr(node, "lineno")
    ]
    return ast.dump(tree), lines


@given(
    form=st.sampled_from(FORMS),
    first=st.sampled_from(ANNOTATIONS),
    second=st.sampled_from(ANNOTATIONS),
    ending=st.sampled_from(["\n", "\r\n", "\r"]),
)
def test_all_but_annotations_stays_where_it_was(form, first, second, ending):
    code = form.replace(": A", f": {first}").replace("-> A", f"-> {first}")
    code = code.replace(": B", f": {second}").replace("-> B", f"-> {second}")
    code = code.replace("-> (B)", f"-> ({second})")
    expected = Strip().visit(ast.parse(code))

    plain = plain_source(code.replace("\n", ending))

    assert shape(ast.parse(plain)) == shape(expected)


@pytest.mark.parametrize(
    ("code", "plain"),
    [
        ("import math\n", "pass\n"),
        ("import math as m\n", "m = math\n"),
        ("import numpy as np, math\n", "pass\n"),
        ("import numpy\n", "numpy = np\n"),
        ("import numpy.linalg\n", "numpy = np\n"),
        ("import numpy.linalg as la, math as m\n", "la = np.linalg; m = math\n"),
        ("from math import cos, pi as p\n", "cos = math.cos; p = math.pi\n"),
        ("from numpy import linalg\n", "linalg = np.linalg\n"),
        ("from numpy.linalg import norm; x = 1\n", "norm = np.linalg.norm; x = 1\n"),
        ("from math import (\n  cos,\n)\n", "cos = math.cos \\\n \\\n\n"),
        ("from typing import List\nx = 1", "pass\nx = 1\n"),
        ("from __future__ import annotations\n", "pass\n"),
        ("import typing as t, math as m\n", "m = math\n"),
        ("from typing import List\nA = List[int]\nB: t = A\nC = 1\n", "pass\npass\npass\nC = 1\n"),
    ],
)
def test_known_imports_become_assignments(code, plain):
    assert plain_source(code) == plain


@pytest.mark.parametrize(
    "module", ["os", "numpy.random", "numpy.lib", "math.x", "typing.io", "collections", "np"]
)
def test_other_imports_are_refused(module):
    for code in (f"import {module}\n", f"from {module} import x\n", f"import {module} as math\n"):
        with pytest.raises(RejectedCodeError, match=f"importing '{module}' is not allowed"):
            plain_source(code)


@pytest.mark.parametrize(
    "character", "\0\x07\x0b\x0c\x1b\x7f\x85\u00ad\u200b\u202e\u2028\ufeff\ud800"
)
def test_invisible_characters_are_refused(character):
    with pytest.raises(RejectedCodeError, match=rf"line 2.*U\+{ord(character):04X}"):
        plain_source(f"x = 1\ny = 2  # {character}\n")


@pytest.mark.parametrize("text", ["θ² ≤ 1 → ü", "\t", "日本", "😀"])
def test_visible_characters_may_stand_in_comments_and_texts(text):
    code = f"x = '{text}'  # {text}\n"

    assert plain_source(code) == code


@pytest.mark.parametrize("name", ["θ", "\uff45val", "\u017fum", "x²", "\U0001d41a"])
def test_names_are_ascii(name):
    with pytest.raises(RejectedCodeError, match="line 1"):
        plain_source(f"{name} = 1\n")
