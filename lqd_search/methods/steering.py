"""What steers each method: whose success condition, fitness and descriptors it is told."""

from collections.abc import Mapping
from types import MappingProxyType

MESH = "mesh"
"""The inferred functionals and the BD mesh of their timestamps and quantities."""
DIRECT = "direct"
"""The three functions that the model wrote when it was asked for everything at once."""
EXPERT = "expert"
"""What the task's author wrote."""

STEERING: Mapping[str, str] = MappingProxyType(
    {
        "ours": MESH,
        "direct": DIRECT,
        "handcrafted": EXPERT,
        "ga": DIRECT,
        "random": MESH,
        "ours_plus": MESH,
    }
)
"""What steers each method, by its name.

It is apart from `lqd_search.METHODS`, which makes them, so that a worker that only evaluates need
not import pyribs.
"""
