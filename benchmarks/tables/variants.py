"""The variants of `ours` that the ablations compare with it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

from lqd_envs import SolutionSpace
from lqd_search.evaluation.motion_evaluator import passive_fields
from lqd_search.methods.by_name import Setting
from lqd_search.methods.exploration_budget import ExplorationBudget
from lqd_search.methods.fitness_exploration import LanguageDrivenQD
from lqd_search.methods.map_elites_success import MapElitesSuccess
from lqd_search.methods.method import Method

CELLS_PER_GRID = 10_000
"""About as many cells each grid of `ours` has."""

ChooseDescriptors = Callable[[Sequence[str]], tuple[str, ...]]
"""Returns which of a mesh's descriptors `"h.g"`, in the order of the reply, have a grid."""

BuildMethod = Callable[[Setting, Mapping[str, int], int], Method]
"""Makes the search of a setting, descriptors with their numbers of measures, and cells per grid."""


@dataclass(frozen=True)
class Variant:
    """A variant of `ours`.

    Attributes:
        name: What it is called.
        summary: What it is, in half a sentence.
        choose: Which descriptors have a grid.
        build: Makes the search.
    """

    name: str
    summary: str
    choose: ChooseDescriptors
    build: BuildMethod

    def method(self, setting: Setting) -> Method:
        """Make the search.

        Its grids have as many cells in all, about, as those of `ours`.

        Args:
            setting: What it is set up with; the judge's descriptors are those of the whole mesh.
        """
        mesh = setting.judge.descriptors
        chosen = self.choose(tuple(mesh))
        cells = CELLS_PER_GRID * len(mesh) // len(chosen)
        return self.build(setting, {name: mesh[name] for name in chosen}, cells)


def every(mesh: Sequence[str]) -> tuple[str, ...]:
    """Choose all descriptors."""
    return tuple(mesh)


def first_timestamp(mesh: Sequence[str]) -> tuple[str, ...]:
    """Choose the descriptors of the first timestamp h of the reply, with each quantity g."""
    first = mesh[0].partition(".")[0]
    return tuple(name for name in mesh if name.partition(".")[0] == first)


def first_quantity(mesh: Sequence[str]) -> tuple[str, ...]:
    """Choose the descriptors of the first quantity g of the reply, at each timestamp h."""
    first = mesh[0].partition(".")[2]
    return tuple(name for name in mesh if name.partition(".")[2] == first)


def first(mesh: Sequence[str]) -> tuple[str, ...]:
    """Choose the descriptor of the first timestamp h and the first quantity g of the reply."""
    return (mesh[0],)


def _explored(setting: Setting, descriptors: Mapping[str, int], cells: int) -> LanguageDrivenQD:
    return LanguageDrivenQD(
        SolutionSpace(),
        descriptors=descriptors,
        fitness_names=setting.judge.fitness_names,
        evaluations=setting.evaluations,
        batch_size=setting.batch_size,
        rng=setting.rng,
        competition=setting.new_competition(),
        passive_fields=passive_fields(setting.task),
        cells=cells,
    )


def _first_fitness(
    setting: Setting, descriptors: Mapping[str, int], cells: int
) -> MapElitesSuccess:
    names = setting.judge.fitness_names
    budget = ExplorationBudget(setting.evaluations, setting.batch_size, len(names))
    return MapElitesSuccess(
        SolutionSpace(),
        descriptors=descriptors,
        fitness=names[0],
        evaluations=setting.evaluations,
        batch_size=setting.batch_size,
        rng=setting.rng,
        # Where they are learned again with the exploration on, so that nothing else differs.
        relearn_at=budget.exploration,
        competition=setting.new_competition(),
        passive_fields=passive_fields(setting.task),
        cells=cells,
    )


def _with_coin(setting: Setting, descriptors: Mapping[str, int], cells: int) -> LanguageDrivenQD:
    return _explored(replace(setting, failure_competition="coin"), descriptors, cells)


OURS = "ours"
"""The name of the variant that changes nothing."""

VARIANTS: Mapping[str, Variant] = MappingProxyType(
    {
        variant.name: variant
        for variant in (
            Variant(OURS, "all 16 grids", every, _explored),
            Variant("one_timestamp", "the first h with 4 g, 4 grids", first_timestamp, _explored),
            Variant("one_quantity", "4 h with the first g, 4 grids", first_quantity, _explored),
            Variant("one_grid", "the first h with the first g, 1 grid", first, _explored),
            Variant("first_fitness", "no exploration: the first fitness", every, _first_fitness),
            Variant("coin", "two failures toss a coin for a cell", every, _with_coin),
        )
    }
)
"""The variants by name, that which changes nothing first."""
