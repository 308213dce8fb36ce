"""Start poses learned from where the motions in the archive touched the object."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from ribs.typing import BatchData

from lqd_envs import SolutionSpace
from lqd_envs.solution_space import MOTION_UNIT, POSITION_UNIT
from lqd_search.emitters.emitter import EmitterError
from lqd_search.emitters.variation import Variation
from lqd_search.evaluation.contact import CONTACT

_MOTION = slice(6, 9)


@dataclass(frozen=True)
class ContactVariation:
    """Lets some children reach the contact of their parent from another side.

    Such a child gets a new random motion, and its start is moved back from the pose at which the
    parent first touched the object, along that motion, by up to `farthest` of its length; start and
    motion are then mutated as ever. All other children are made by `otherwise`. The archive must
    store the field `contact`.

    Attributes:
        space: Draws motions and mutates.
        otherwise: Makes the other children.
        share: Part of the children whose parent touched the object that are made so, in [0, 1].
        farthest: Greatest distance of the start from the contact, in lengths of the motion.

    Raises:
        EmitterError: The part is not in its interval, or the distance is negative or not finite.
    """

    space: SolutionSpace
    otherwise: Variation
    share: float = 0.25
    farthest: float = 0.5

    def __post_init__(self) -> None:
        if not (0.0 <= self.share <= 1.0 and 0.0 <= self.farthest < np.inf):
            raise EmitterError(
                "Expected a share from 0 to 1 and a finite distance of at least 0, but got "
                f"{self.share} and {self.farthest}; choose others."
            )

    def __call__(
        self, elites: BatchData, parents: NDArray[np.intp], *, rng: np.random.Generator
    ) -> NDArray[np.float64]:
        """Vary the parents.

        Raises:
            EmitterError: The elites have no field `contact`.
        """
        if CONTACT not in elites:
            raise EmitterError(
                f"Expected the field {CONTACT!r} among those of the elites, but there are only "
                f"{', '.join(elites)}; store it: add {{{CONTACT!r}: ((6,), np.float64)}} to the "
                "passive_fields of the method or the extra_fields of the archive."
            )
        children = self.otherwise(elites, parents, rng=rng)
        contact = elites[CONTACT][parents]
        chosen = ~np.isnan(contact[:, 0]) & (rng.random(len(parents)) < self.share)
        count = int(chosen.sum())
        motion = self.space.sample(count, rng=rng)[:, _MOTION]
        back = rng.uniform(0.0, self.farthest, (count, 1))
        start = contact[chosen]
        start[:, :3] -= back * motion * (MOTION_UNIT / POSITION_UNIT)
        children[chosen] = self.space.mutate(np.concatenate([start, motion], axis=1), rng=rng)
        return children
