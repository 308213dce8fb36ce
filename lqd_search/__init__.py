"""The optimiser: descriptors, the multi-BD archive and its search, and Algorithm 1.

Its modules are imported when one of their names is first used: pyribs takes seconds to import, and
the `lqd` command must be able to say that it is missing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from lqd_search.archives.archive_fields import ArchiveError, ArchiveFields
    from lqd_search.archives.competition import (
        Candidates,
        Competition,
        Incumbents,
        compete_by_coin,
        compete_by_fitness,
    )
    from lqd_search.archives.descriptor_ranges import (
        DescriptorRanges,
        ObservationError,
        ObservationLog,
    )
    from lqd_search.archives.elites import Elites
    from lqd_search.archives.grid_spec import GridSpec, GridSpecError, learn_grid_spec
    from lqd_search.archives.multi_bd_archive import MultiBDArchive
    from lqd_search.emitters.mes_emitter import MESEmitter
    from lqd_search.emitters.selection import SelectionError, select_parents
    from lqd_search.evaluation.functionals import FunctionalError, FunctionalEvaluator, Functionals
    from lqd_search.evaluation.motion_evaluator import MotionEvaluator, passive_fields
    from lqd_search.evaluation.values import Refusal, Values, ValuesError
    from lqd_search.methods.exploration_budget import BudgetError, ExplorationBudget
    from lqd_search.methods.fitness_exploration import LanguageDrivenQD
    from lqd_search.methods.method import Method, MethodError, SolutionSpace
    from lqd_search.runs.run_folder import RunFolder, RunFolderError
    from lqd_search.runs.stored_archive import StoredArchive, StoredArchiveError, StoredGrid
    from lqd_search.schedulers.multi_bd_scheduler import MultiBDScheduler, SchedulerError

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
    "archives.archive_fields": ("ArchiveError", "ArchiveFields"),
    "archives.competition": (
        "Candidates",
        "Competition",
        "Incumbents",
        "compete_by_coin",
        "compete_by_fitness",
    ),
    "archives.descriptor_ranges": ("DescriptorRanges", "ObservationError", "ObservationLog"),
    "archives.elites": ("Elites",),
    "methods.exploration_budget": ("BudgetError", "ExplorationBudget"),
    "methods.fitness_exploration": ("LanguageDrivenQD",),
    "evaluation.functionals": ("FunctionalError", "FunctionalEvaluator", "Functionals"),
    "archives.grid_spec": ("GridSpec", "GridSpecError", "learn_grid_spec"),
    "emitters.mes_emitter": ("MESEmitter",),
    "methods.method": ("Method", "MethodError", "SolutionSpace"),
    "evaluation.motion_evaluator": ("MotionEvaluator", "passive_fields"),
    "archives.multi_bd_archive": ("MultiBDArchive",),
    "schedulers.multi_bd_scheduler": ("MultiBDScheduler", "SchedulerError"),
    "runs.run_folder": ("RunFolder", "RunFolderError"),
    "emitters.selection": ("SelectionError", "select_parents"),
    "runs.stored_archive": ("StoredArchive", "StoredArchiveError", "StoredGrid"),
    "evaluation.values": ("Refusal", "Values", "ValuesError"),
}
_HOME = {name: module for module, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
