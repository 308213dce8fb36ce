"""An instance as it is named on the command line: a file, or a drawn one by its number."""

import re
from pathlib import Path

from lqd_envs import LQDError, Task
from lqd_envs.instances import KINDS, Instance, InstanceError, describe, generate_instances

SYNTAX = "FILE|KIND[:N[:SEED]]"
"""How to name one."""

_DRAWN = re.compile(r"(?P<kind>[a-z]+)(?::(?P<number>\d{1,18}))?(?::(?P<seed>\d{1,18}))?")
# All before it are drawn too.
_MOST = 10_000


def named_instance(text: str, task: Task) -> Instance:
    """Return the instance that a text names.

    Args:
        text: `KIND[:N[:SEED]]`, the N-th drawn one of a kind, from 0 (0 by default) with a seed (0
            by default); or else the path of a file that `Instance.to_json` wrote.
        task: The task that it must be an instance of.

    Raises:
        LQDError: It names none, or one of another task.
    """
    match = _DRAWN.fullmatch(text)
    if match and match["kind"] in KINDS:
        return _drawn(task, match["kind"], int(match["number"] or 0), int(match["seed"] or 0))
    instance = _read(text)
    # An instance of another task, or one that does not fit its object, is an error here already.
    instance.apply(task)
    return instance


def listed_instances(task: Task, *, count: int) -> str:
    """Return lines that name the first drawn instances of each kind and say what they ask.

    Of a kind that cannot be drawn for the task they say why.

    Args:
        task: The task.
        count: How many of each kind.
    """
    return "\n".join(line for kind in KINDS for line in _listed(task, kind, count=count))


def in_words(instance: Instance) -> list[str]:
    """Return what an instance asks, as indented lines."""
    return [f"  {sentence}" for sentence in describe(instance)]


def _listed(task: Task, kind: str, *, count: int) -> list[str]:
    try:
        instances = generate_instances(task, kind, count=count, seed=0)
    except InstanceError as error:
        return [f"{kind}  none", f"  {error}"]
    lines = []
    for i, instance in enumerate(instances):
        lines += [f"{kind}:{i}  {instance.name}", *in_words(instance)]
    return lines


def _drawn(task: Task, kind: str, number: int, seed: int) -> Instance:
    if number >= _MOST:
        raise LQDError(
            f"Expected the number of a drawn instance below {_MOST:,}, but got {number}; choose a "
            "lower one, or another seed."
        )
    return generate_instances(task, kind, count=number + 1, seed=seed)[number]


def _read(text: str) -> Instance:
    path = Path(text)
    try:
        return Instance.from_json(path.read_text())
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is no text"
        raise LQDError(
            f"Expected an instance as {SYNTAX}, where KIND is one of {', '.join(KINDS)}, but got "
            f"{text!r}, which as a file cannot be read ({reason}); --list shows some."
        ) from error
    except InstanceError as error:
        raise InstanceError(f"{path}: {error}") from error
