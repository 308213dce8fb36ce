"""Which descriptors say the same about a run's motions, and which say nothing."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import maximum_bipartite_matching

_TOLERANCE = 1e-9


@dataclass(frozen=True)
class DescriptorReport:
    """What the measures of some motions show of their descriptors, each in the descriptors' order.

    Attributes:
        same: Groups of two or more descriptors that say the same: they are defined in the same
            motions, and their measures differ at most in order, scale, sign and offset.
        degenerate: Descriptors that are defined somewhere, and of which each measure takes a single
            value wherever they are.
        undefined: Descriptors that are defined in no motion.
    """

    same: tuple[tuple[str, ...], ...]
    degenerate: tuple[str, ...]
    undefined: tuple[str, ...]

    def sentences(self) -> tuple[str, ...]:
        """Return a sentence for each group, one for the degenerate and one for the undefined."""
        sentences = [
            f"The same on the first batch, up to order, scale and offset: {', '.join(group)}."
            for group in self.same
        ]
        if self.degenerate:
            sentences.append(
                "With a single value on the first batch, so that they tell no motions apart: "
                f"{', '.join(self.degenerate)}."
            )
        if self.undefined:
            sentences.append(
                f"Defined for no motion of the first batch: {', '.join(self.undefined)}."
            )
        return tuple(sentences)


def report_descriptors(measures: Mapping[str, NDArray[np.float64]]) -> DescriptorReport:
    """Compare descriptors by what they measured.

    Args:
        measures: For each descriptor (N, d) measures of the same N motions; a row of only NaN
            where it is undefined.
    """
    undefined, degenerate = [], []
    patterns: dict[str, _Pattern] = {}
    for name, block in measures.items():
        pattern = _Pattern.of(block)
        if not pattern.defined.any():
            undefined.append(name)
        elif (pattern.columns == 0.0).all():
            degenerate.append(name)
        else:
            patterns[name] = pattern
    groups: list[list[str]] = []
    for name, pattern in patterns.items():
        home = next((group for group in groups if patterns[group[0]].says_the_same(pattern)), None)
        if home is None:
            groups.append([name])
        else:
            home.append(name)
    return DescriptorReport(
        same=tuple(tuple(group) for group in groups if len(group) > 1),
        degenerate=tuple(degenerate),
        undefined=tuple(undefined),
    )


@dataclass(frozen=True, eq=False)
class _Pattern:
    """What is left of a descriptor's measures without scale and offset.

    Attributes:
        defined: (N,) bool.
        columns: (d, k) the defined values of each measure, moved to [0, 1]; 0 where there is only
            one.
    """

    defined: NDArray[np.bool_]
    columns: NDArray[np.float64]

    @classmethod
    def of(cls, block: NDArray[np.float64]) -> "_Pattern":
        defined = ~np.asarray(np.isnan(block).any(axis=1))
        # Halved, so that no difference of two values is too large for a float64.
        values = block[defined].T / 2.0
        low = values.min(axis=1, initial=np.inf, keepdims=True)
        span = values.max(axis=1, initial=-np.inf, keepdims=True) - low
        varies = span > 0.0
        columns = np.zeros_like(values)
        np.divide(values - low, span, out=columns, where=varies)
        return cls(defined=defined, columns=columns)

    def says_the_same(self, other: "_Pattern") -> bool:
        if self.columns.shape != other.columns.shape:
            return False
        if not np.array_equal(self.defined, other.defined):
            return False
        alike = [[_alike(one, two) for two in other.columns] for one in self.columns]
        partners = maximum_bipartite_matching(csr_array(np.array(alike)), perm_type="column")
        return bool((partners >= 0).all())


def _alike(one: NDArray[np.float64], two: NDArray[np.float64]) -> bool:
    return any(np.allclose(one, column, rtol=0.0, atol=_TOLERANCE) for column in (two, 1.0 - two))
