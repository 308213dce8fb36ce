"""The form that a JSON file must have, given as type hints, and the check of data against it."""

import reprlib
import sys
from collections.abc import Mapping
from types import NoneType, UnionType
from typing import Any, get_args, get_origin, get_type_hints

from lqd_envs.errors import LQDError

_PLAIN = {str: "a string", int: "an integer", float: "a number", NoneType: "null"}


class FormError(LQDError):
    """JSON data have another form than was expected."""


def check_form(data: Any, hint: Any, *, at: str = "") -> None:
    """Check that data as JSON gives them have the form of a type hint.

    Args:
        data: Objects, lists, strings, numbers, booleans and None.
        hint: `str`, `int`, `float` (finite, an integer will do), `None`, a union of these,
            `list[...]` or `tuple[..., ...]` (a list of any length), `dict[str, ...]`, or a class
            whose annotations are the keys, such as a typed dictionary or a dataclass.
        at: Where in the file the data stand, for the message.

    Raises:
        FormError: They have not; the message names the first place.
    """
    if isinstance(hint, UnionType):
        if not any(_is_plain(data, option) for option in get_args(hint)):
            raise _misfit(data, " or ".join(_PLAIN[option] for option in get_args(hint)), at=at)
    elif hint in _PLAIN:
        if not _is_plain(data, hint):
            raise _misfit(data, _PLAIN[hint], at=at)
    elif get_origin(hint) in (list, tuple):
        _check_list(data, get_args(hint)[0], at=at)
    elif get_origin(hint) is dict:
        keys = data if isinstance(data, dict) else ()
        _check_object(data, dict.fromkeys(keys, get_args(hint)[1]), at=at)
    else:
        _check_object(data, get_type_hints(hint), at=at)


def known_keys(data: Mapping[str, Any], kind: type) -> dict[str, Any]:
    """Return what of an object a class knows: another version may have written more.

    Args:
        data: An object in the form of the class.
        kind: A class whose annotations are the keys.
    """
    return {key: data[key] for key in get_type_hints(kind)}


def _check_list(data: Any, hint: Any, *, at: str) -> None:
    if not isinstance(data, list):
        raise _misfit(data, "a list", at=at)
    for i, element in enumerate(data):
        check_form(element, hint, at=f"{at}[{i}]")


def _check_object(data: Any, hints: dict[str, Any], *, at: str) -> None:
    if not isinstance(data, dict):
        raise _misfit(data, "an object", at=at)
    for key, hint in hints.items():
        place = f"{at}.{key}" if at else key
        if key not in data:
            raise FormError(f"Expected the key {place!r}, but it is not there.")
        check_form(data[key], hint, at=place)


def _is_plain(data: Any, hint: type) -> bool:
    # Python takes True for an integer, JSON does not.
    if isinstance(data, bool):
        return False
    if hint is float:
        return isinstance(data, int | float) and abs(data) <= sys.float_info.max
    return isinstance(data, hint)


def _misfit(data: Any, wanted: str, *, at: str) -> FormError:
    return FormError(f"Expected {wanted} at {at!r}, but got {_shown(data)}.")


def _shown(data: Any) -> str:
    if isinstance(data, dict | list):
        return "an object" if isinstance(data, dict) else "a list"
    return reprlib.repr(data)
