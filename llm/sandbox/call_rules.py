"""The rules for the arguments of calls: what they may say of element types, and of memory."""

import ast

from lqd_llm.sandbox.allowlist import DTYPE_TEXTS, DTYPES, NUMPY_TYPES, SELECTING, TYPE_PLACES
from lqd_llm.sandbox.errors import RejectedCodeError
from lqd_llm.sandbox.names import Names

EXPECTED_DTYPE = "the elements of an array can only be float, int, bool or complex"
_EXPECTED_FOLD = "{} takes an array and an axis here, and is called where it is named"
TYPED = {
    "astype": EXPECTED_DTYPE,
    **{name: _EXPECTED_FOLD.format(name) for name in ("accumulate", "reduce")},
}
"""Attributes that are called where they are named: what else they are given may be the type of the
elements, as text that could be anything. For each, what is said of one that is not."""


def check_call(node: ast.Call, names: Names) -> None:
    """Check what the arguments of a call say of types, and of memory.

    Raises:
        RejectedCodeError: They say what they may not.
    """
    own = isinstance(node.func, ast.Name) and node.func.id in names.unpacking
    # What is unpacked there cannot be seen here, and may say of what type an array is.
    if not own and not all(keyword.arg for keyword in node.keywords):
        raise RejectedCodeError(
            "** can only be used in calls of dict and of functions that are defined here",
            line=node.lineno,
        )
    if not own:
        _check_filled(node, names)
    if isinstance(node.func, ast.Attribute) and node.func.attr in TYPE_PLACES:
        _check_type_by_place(node, node.func, names)


def _check_filled(call: ast.Call, names: Names) -> None:
    """Check that an array holds nothing that was in memory before, of this call or another."""
    named = {keyword.arg: keyword.value for keyword in call.keywords}
    attribute = call.func.attr if isinstance(call.func, ast.Attribute) else None
    if "where" in named and attribute not in SELECTING:
        out = named.get("out")
        if out is None or not names.is_array(out):
            raise RejectedCodeError(
                "where= leaves the other elements undefined: say what they shall be with out= in "
                "the same call, such as out=np.zeros(3) or out=np.zeros_like(x), or use np.where",
                line=named["where"].lineno,
            )
    if attribute == "pad":
        for argument in (*call.args, *named.values()):
            if isinstance(argument, ast.Constant) and argument.value == "empty":
                raise RejectedCodeError(
                    "the mode 'empty' leaves the new elements undefined; use 'constant'",
                    line=argument.lineno,
                )


def _check_type_by_place(call: ast.Call, function: ast.Attribute, names: Names) -> None:
    place = TYPE_PLACES[function.attr] + (names.facade_of(function.value) is not None)
    if any(isinstance(argument, ast.Starred) for argument in call.args):
        raise RejectedCodeError(
            f"the arguments of {function.attr} must be written out, since * may hide the type of "
            "the elements",
            line=call.lineno,
        )
    if len(call.args) > place and not is_dtype(call.args[place], names):
        raise RejectedCodeError(EXPECTED_DTYPE, line=call.args[place].lineno)


def is_plain_call(call: ast.Call, names: Names) -> bool:
    """Return whether a call is one of `TYPED`, and says nothing of a type but what it may."""
    return _converts(call, names) or _folds(call)


def is_dtype(node: ast.expr, names: Names) -> bool:
    """Return whether an expression is a type of numbers that is written out, or None."""
    match node:
        case ast.Constant(value=None):
            return True
        case ast.Constant(value=str(text)):
            return text in DTYPE_TEXTS
        case ast.Name(id=name):
            return name in DTYPES and name not in names.bound
        case ast.Attribute(value=value, attr=name):
            return names.facade_of(value) == "np" and name in NUMPY_TYPES
        case _:
            return False


def _converts(call: ast.Call, names: Names) -> bool:
    """Return whether a call is one of `astype`, and to a type of numbers."""
    match call:
        case ast.Call(func=ast.Attribute(attr="astype"), args=[dtype], keywords=[]):
            return is_dtype(dtype, names)
        case ast.Call(
            func=ast.Attribute(attr="astype"), args=[], keywords=[ast.keyword("dtype", dtype)]
        ):
            return is_dtype(dtype, names)
        case _:
            return False


def _folds(call: ast.Call) -> bool:
    """Return whether a call is one of `reduce` or `accumulate`, and says nothing of a type."""
    match call:
        case ast.Call(func=ast.Attribute(attr="reduce" | "accumulate"), args=[_] | [_, _] as args):
            return not any(isinstance(argument, ast.Starred) for argument in args)
        case _:
            return False
