"""Drawing instances of a task."""

from types import MappingProxyType
from typing import Protocol
from zlib import crc32

import numpy as np

from lqd_envs.instances.drawn_approach import draw_approach
from lqd_envs.instances.drawn_change import draw_change
from lqd_envs.instances.drawn_obstacles import draw_obstacles
from lqd_envs.instances.drawn_predicate import draw_predicate
from lqd_envs.instances.instance import Instance
from lqd_envs.instances.instance_error import InstanceError
from lqd_envs.tasks.registry import get_task
from lqd_envs.tasks.task import Task


class DrawInstance(Protocol):
    """Draws one instance of a task."""

    def __call__(self, task: Task, *, rng: np.random.Generator) -> Instance:
        """Return the instance."""


KINDS = MappingProxyType[str, DrawInstance](
    {
        "predicate": draw_predicate,
        "obstacles": draw_obstacles,
        "approach": draw_approach,
        "change": draw_change,
    }
)
"""What draws the instances of each kind."""


def generate_instances(
    task: Task | str, kind: str, *, count: int, seed: int
) -> tuple[Instance, ...]:
    """Draw instances of one kind.

    They depend on the task, the kind and the seed alone: on no search and no functional. The first
    of a longer draw are those of a shorter one.

    Args:
        task: A task or its id.
        kind: One of `"predicate"`, `"obstacles"`, `"approach"` and `"change"`; docs/instances.md
            says what each draws, and from which ranges.
        count: How many.
        seed: Seed of the random generator, 0 or more.

    Raises:
        InstanceError: There is no such kind, or none for this task, or count or seed is no whole
            number of at least 0.
        UnknownTaskError: There is no task of that id.
    """
    found = get_task(task) if isinstance(task, str) else task
    if not isinstance(kind, str) or kind not in KINDS:
        raise InstanceError(
            f"Expected a kind of instance, but got {kind!r}; choose one of {', '.join(KINDS)}."
        )
    if not (_is_count(count) and _is_count(seed)):
        raise InstanceError(
            f"Expected a count and a seed that are whole numbers of at least 0, but got {count!r} "
            f"and {seed!r}; choose others."
        )
    # A stream of its own for each task and kind, so that they have nothing in common.
    rng = np.random.default_rng([seed, crc32(found.id.encode()), crc32(kind.encode())])
    return tuple(KINDS[kind](found, rng=rng) for _ in range(count))


def _is_count(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        return False
    return bool(value >= 0)
