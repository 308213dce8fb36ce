"""Parts that an instance is made of, checked to be what they should be."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict

from lqd_envs.instances.instance_error import InstanceError
from lqd_envs.instances.obstacle import Obstacle
from lqd_envs.instances.predicate import Predicate


def require_part(value: object, part: type, *, name: str) -> None:
    """Raise `InstanceError` where a value is neither a part nor None.

    Args:
        value: What should be one.
        part: Its class, or the protocol that it follows.
        name: What the attribute is called in the error.
    """
    # A class has all that its instances have, so that it would pass for a protocol's.
    if value is None or (isinstance(value, part) and not isinstance(value, type)):
        return
    raise InstanceError(
        f"Expected `{name}` to be of type {part.__name__} or None, but got {value!r}; "
        f"{_remedy(value)}."
    )


def require_written(predicate: Predicate) -> None:
    """Raise `InstanceError` where a predicate cannot be written, so that it has no name.

    Args:
        predicate: One of ours, or one of a user's own.
    """
    try:
        json.dumps(asdict(predicate), allow_nan=False)  # type: ignore[call-overload]
    except (TypeError, ValueError) as error:
        raise InstanceError(
            f"Expected `predicate` to be a dataclass of plain values, but got {predicate!r} "
            f"({error}); decorate its class with @dataclass(frozen=True), and make its attributes "
            "numbers, strings or tuples of them."
        ) from error


def checked_obstacles(values: object) -> tuple[Obstacle, ...]:
    """Return obstacles as a tuple.

    Raises:
        InstanceError: They are not several of them, or one is none.
    """
    if not isinstance(values, Iterable) or isinstance(values, Mapping | str):
        raise InstanceError(
            f"Expected `obstacles` to be a tuple of Obstacle, but got {values!r}; put it into "
            "brackets, and read an instance made of dictionaries with Instance.from_dict."
        )
    obstacles = tuple(values)
    for number, obstacle in enumerate(obstacles):
        if not isinstance(obstacle, Obstacle):
            raise InstanceError(
                f"Expected obstacles[{number}] to be of type Obstacle, but got {obstacle!r}; "
                f"{_remedy(obstacle)}."
            )
    return obstacles


def _remedy(value: object) -> str:
    if isinstance(value, Mapping):
        return "read an instance made of dictionaries with Instance.from_dict"
    return "take one from lqd_envs.instances"
