"""The optimiser: descriptors, the multi-BD archive and its search, and Algorithm 1.

Its modules are imported when one of their names is first used: pyribs takes seconds to import, and
the `lqd` command must be able to say that it is missing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from lqd_search.archive_fields import ArchiveError, ArchiveFields
    from lqd_search.competition import (
        Candidates,
        Competition,
        Incumbents,
        compete_by_coin,
        compete_by_fitness,
    )
    from lqd_search.descriptor_ranges import DescriptorRanges, ObservationError, ObservationLog
    from lqd_search.elites import Elites
    from lqd_search.exploration_budget import BudgetError, ExplorationBudget
    from lqd_search.fitness_exploration import LanguageDrivenQD
    from lqd_search.functionals import FunctionalError, FunctionalEvaluator, Functionals
    from lqd_search.grid_spec import GridSpec, GridSpecError, learn_grid_spec
    from lqd_search.mes_emitter import MESEmitter
    from lqd_search.method import Method, MethodError, SolutionSpace
    from lqd_search.motion_evaluator import MotionEvaluator, passive_fields
    from lqd_search.multi_bd_archive import MultiBDArchive
    from lqd_search.multi_bd_scheduler import MultiBDScheduler, SchedulerError
    from lqd_search.run_folder import RunFolder, RunFolderError
    from lqd_search.selection import SelectionError, select_parents
    from lqd_search.stored_archive import StoredArchive, StoredArchiveError, StoredGrid
    from lqd_search.values import Refusal, Values, ValuesError

__all__ = [
    "ArchiveError",
    "ArchiveFields",
    "BudgetError",
    "Candidates",
    "Competition",
    "DescriptorRanges",
    "Elites",
    "ExplorationBudget",
    "FunctionalError",
    "FunctionalEvaluator",
    "Functionals",
    "GridSpec",
    "GridSpecError",
    "Incumbents",
    "LanguageDrivenQD",
    "MESEmitter",
    "Method",
    "MethodError",
    "MotionEvaluator",
    "MultiBDArchive",
    "MultiBDScheduler",
    "ObservationError",
    "ObservationLog",
    "Refusal",
    "RunFolder",
    "RunFolderError",
    "SchedulerError",
    "SelectionError",
    "SolutionSpace",
    "StoredArchive",
    "StoredArchiveError",
    "StoredGrid",
    "Values",
    "ValuesError",
    "compete_by_coin",
    "compete_by_fitness",
    "learn_grid_spec",
    "passive_fields",
    "select_parents",
]

_HOMES = {
    "archive_fields": ("ArchiveError", "ArchiveFields"),
    "competition": (
        "Candidates",
        "Competition",
        "Incumbents",
        "compete_by_coin",
        "compete_by_fitness",
    ),
    "descriptor_ranges": ("DescriptorRanges", "ObservationError", "ObservationLog"),
    "elites": ("Elites",),
    "exploration_budget": ("BudgetError", "ExplorationBudget"),
    "fitness_exploration": ("LanguageDrivenQD",),
    "functionals": ("FunctionalError", "FunctionalEvaluator", "Functionals"),
    "grid_spec": ("GridSpec", "GridSpecError", "learn_grid_spec"),
    "mes_emitter": ("MESEmitter",),
    "method": ("Method", "MethodError", "SolutionSpace"),
    "motion_evaluator": ("MotionEvaluator", "passive_fields"),
    "multi_bd_archive": ("MultiBDArchive",),
    "multi_bd_scheduler": ("MultiBDScheduler", "SchedulerError"),
    "run_folder": ("RunFolder", "RunFolderError"),
    "selection": ("SelectionError", "select_parents"),
    "stored_archive": ("StoredArchive", "StoredArchiveError", "StoredGrid"),
    "values": ("Refusal", "Values", "ValuesError"),
}
_HOME = {name: module for module, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
