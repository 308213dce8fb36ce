"""Compiling the functions, each in globals of its own. This file runs in the worker."""

import struct
from collections.abc import Sequence
from typing import Any

from lqd_llm.sandbox.calls import SOURCE_NAME, Function, Record, plain, raised
from lqd_llm.sandbox.facades import new_namespace
from lqd_llm.sandbox.motion_calls import DefinedFunction
from lqd_llm.sandbox.reasons import Reason
from lqd_llm.sandbox.renewal import RenewedFunction, can_be_changed
from lqd_llm.sandbox.roles import Role
from lqd_llm.sandbox.wire import (
    DEFINITIONS_OFFSET,
    NO_FUNCTION,
    RECORD,
    RECORD_FORMAT,
    Word,
    call_number,
)

_RECORD = struct.Struct("<" + RECORD_FORMAT)
_DEFINED = plain(Reason.ACCEPTED)


def define_functions(
    told: Sequence[dict[str, Any]], *, results: Any, words: memoryview
) -> list[DefinedFunction]:
    """Define the functions, and write for each what came of it.

    Args:
        told: For each function its `role`, `source`, `entry`, and whether it was `dropped`.
        results: The shared results.
        words: Their header; it is told of each definition before it begins.

    Returns:
        The functions; those that were dropped or cannot be defined have nothing to call.
    """
    functions = []
    for number, function in enumerate(told):
        words[Word.CALL] = call_number(0, number)
        call, record = None, plain(Reason.DROPPED)
        if not function["dropped"]:
            call, record = _define(function["source"], entry=function["entry"], number=number)
        _RECORD.pack_into(results, DEFINITIONS_OFFSET + number * RECORD.itemsize, *record)
        functions.append(DefinedFunction(Role(function["role"]), call))
    words[Word.CALL] = call_number(0, NO_FUNCTION)
    return functions


def _define(source: str, *, entry: str, number: int) -> tuple[Function | None, Record]:
    around = new_namespace()
    code = compile(source, f"{SOURCE_NAME} {number}>", "exec", dont_inherit=True)

    def define() -> dict[str, Any]:
        namespace = dict(around)
        exec(code, namespace)  # noqa: S102
        return namespace

    try:
        namespace = define()
        call = namespace.get(entry)
        if not callable(call):
            return None, plain(Reason.NOT_DEFINED)
        if can_be_changed(namespace):
            return RenewedFunction(define, entry=entry), _DEFINED
    except Exception as error:  # noqa: BLE001 (a model wrote this code, and it may raise anything)
        return None, raised(error)
    return call, _DEFINED
