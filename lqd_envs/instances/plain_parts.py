"""Parts of an instance from plain dictionaries, as JSON gives them."""

from collections.abc import Mapping
from dataclasses import MISSING, fields
from types import MappingProxyType
from typing import Any, TypeVar

from lqd_envs.instances.held_part import HeldPart
from lqd_envs.instances.instance_error import InstanceError
from lqd_envs.instances.joint_band import JointBand
from lqd_envs.instances.moved_sector import MovedSector
from lqd_envs.instances.predicate import Predicate

_PREDICATES: Mapping[str, type[JointBand | MovedSector | HeldPart]] = MappingProxyType(
    {"joint_band": JointBand, "moved_sector": MovedSector, "held_part": HeldPart}
)

_Part = TypeVar("_Part")


def read_part(part: type[_Part], plain: object, *, name: str) -> _Part:
    """Return the dataclass that a dictionary of its attributes stands for.

    Args:
        part: The dataclass.
        plain: The dictionary.
        name: What it is called in the error, with its article.

    Raises:
        InstanceError: It is no dictionary, a key is missing or unknown, or a value is wrong.
    """
    given = require_keys(part, plain, name=name)
    return part(**given)


def read_predicate(plain: object) -> Predicate:
    """Return the predicate that a dictionary with the key `kind` stands for.

    Raises:
        InstanceError: As `read_part`, or there is no predicate of that kind.
    """
    kind = plain.get("kind") if isinstance(plain, Mapping) else None
    if not isinstance(plain, Mapping) or not isinstance(kind, str) or kind not in _PREDICATES:
        raise InstanceError(
            f"Expected a predicate whose `kind` is one of {', '.join(_PREDICATES)}, but got "
            f"{plain!r}; name its kind."
        )
    attributes = {key: value for key, value in plain.items() if key != "kind"}
    return read_part(_PREDICATES[kind], attributes, name=f"a predicate of kind {kind}")


def require_keys(part: type[Any], plain: object, *, name: str) -> dict[str, Any]:
    """Return a dictionary whose keys are attributes of a dataclass, with none missing.

    Raises:
        InstanceError: It is no dictionary, or a key is missing or unknown.
    """
    known = [field for field in fields(part) if field.init]
    names = ", ".join(field.name for field in known)
    if not isinstance(plain, Mapping):
        raise InstanceError(
            f"Expected {name} as a dictionary, but got {plain!r}; its keys are {names}."
        )
    unknown = sorted(str(key) for key in plain if key not in {field.name for field in known})
    if unknown:
        raise InstanceError(
            f"Expected {name} with the keys {names} at most, but got {', '.join(unknown)}; remove "
            "what is not among them."
        )
    missing = [
        field.name for field in known if field.default is MISSING and field.name not in plain
    ]
    if missing:
        raise InstanceError(
            f"Expected {name} with the keys {', '.join(missing)}, but they are missing; add them."
        )
    return dict(plain)
