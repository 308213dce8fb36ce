"""The optimiser: descriptors, the multi-BD archive and its search, and Algorithm 1."""

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
from lqd_search.multi_bd_archive import MultiBDArchive
from lqd_search.multi_bd_scheduler import MultiBDScheduler, SchedulerError
from lqd_search.selection import SelectionError, select_parents
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
    "MultiBDArchive",
    "MultiBDScheduler",
    "ObservationError",
    "ObservationLog",
    "Refusal",
    "SchedulerError",
    "SelectionError",
    "SolutionSpace",
    "Values",
    "ValuesError",
    "compete_by_coin",
    "compete_by_fitness",
    "learn_grid_spec",
    "select_parents",
]
