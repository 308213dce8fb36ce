"""What is declared beforehand: which figures are taken, and of which subsets of an archive."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from lqd_search.runs.stored_archive import StoredArchive

INFERRED, EXPERT = "inferred", "expert"

INSTANCE_SEED = 1000
"""Seed of the instances. The first ones of seed 0 were looked at when their ranges were chosen
(docs/instances.md), and docs, tests and `lqd adapt` show them; at those of this seed nobody has
looked before the archives were judged by them."""

RULES = 1
"""Number of the rules that motions are judged by. It is raised where what an instance asks, or its
scene, changes (`lqd_envs.instances`): what was judged by others is judged again."""

TRIES = (1, 5, 20)
"""The k of success@k."""
SIZES = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000, 20_000, 50_000)
"""Sizes of the random subsets of an archive."""
SUBSETS = 20
"""How many random subsets of each size a selector chooses from."""

Filter = Callable[[StoredArchive], NDArray[np.bool_]]
"""Says which elites of an archive there are, for a user of it."""

FILTERS: Mapping[str, Filter] = MappingProxyType(
    {
        INFERRED: lambda archive: archive.fields["success"],
        EXPERT: lambda archive: archive.fields["expert"],
    }
)
"""By which condition archives are filtered. A robot has no expert: `inferred` is what counts."""
