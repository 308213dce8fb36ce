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
    from lqd_search.emitters.contact_variation import ContactVariation
    from lqd_search.emitters.emitter import Emitter, EmitterError, Evaluated
    from lqd_search.emitters.evolution_emitter import EvolutionEmitter
    from lqd_search.emitters.mes_emitter import MESEmitter
    from lqd_search.emitters.mixed_emitter import MixedEmitter, Part
    from lqd_search.emitters.random_emitter import RandomEmitter
    from lqd_search.emitters.screen import NeighbourScreen, Screen, Worth, carried_out
    from lqd_search.emitters.selection import SelectionError, select_parents
    from lqd_search.emitters.shares import CreditedShares, EvenShares, ManyCellShares, Shares
    from lqd_search.emitters.variation import Mutation, SuccessLine, Variation
    from lqd_search.evaluation.cluster import ClusterError, open_cluster
    from lqd_search.evaluation.cluster_evaluator import ClusterEvaluator, EvaluatorRecipe
    from lqd_search.evaluation.contact import first_contacts, touched
    from lqd_search.evaluation.descriptor_report import DescriptorReport, report_descriptors
    from lqd_search.evaluation.direct_judge import DirectFunctionals, DirectJudge
    from lqd_search.evaluation.expert_judge import ExpertJudge
    from lqd_search.evaluation.functionals import FunctionalError, FunctionalEvaluator, Functionals
    from lqd_search.evaluation.judge import Judge
    from lqd_search.evaluation.mesh_judge import MeshJudge
    from lqd_search.evaluation.motion_evaluator import MotionEvaluator, passive_fields
    from lqd_search.evaluation.values import Refusal, StoppedFunction, Values, ValuesError
    from lqd_search.loop import Evaluate, Generation, Observe, search
    from lqd_search.methods.by_name import METHODS, NamedMethod, Setting
    from lqd_search.methods.exploration_budget import BudgetError, ExplorationBudget
    from lqd_search.methods.fitness_exploration import LanguageDrivenQD
    from lqd_search.methods.genetic_algorithm import GeneticAlgorithm
    from lqd_search.methods.map_elites_success import MapElitesSuccess
    from lqd_search.methods.method import Method, MethodError
    from lqd_search.methods.plus_switches import Switch, emitter_with
    from lqd_search.methods.random_search import RandomSearch
    from lqd_search.runs.checkpoint import (
        CheckpointError,
        NoCheckpointError,
        load_checkpoint,
        save_checkpoint,
    )
    from lqd_search.runs.functionals_folder import FunctionalsFolderError
    from lqd_search.runs.metrics import Metrics
    from lqd_search.runs.outcome_archive import OutcomeArchive, OutcomeFigures
    from lqd_search.runs.run_config import RunConfig
    from lqd_search.runs.run_folder import RunFolder
    from lqd_search.runs.run_folder_error import RunFolderError
    from lqd_search.runs.stored_archive import StoredArchive, StoredArchiveError, StoredGrid
    from lqd_search.runs.stored_outcomes import OutcomeError
    from lqd_search.runs.summary import Summary
    from lqd_search.schedulers.multi_bd_scheduler import MultiBDScheduler, SchedulerError
    from lqd_search.solution_space import (
        BoxSpace,
        DirectedSpace,
        RepairingSpace,
        SolutionSpace,
        SpaceError,
    )

__all__ = [
    "METHODS",
    "ArchiveError",
    "ArchiveFields",
    "BoxSpace",
    "BudgetError",
    "Candidates",
    "CheckpointError",
    "ClusterError",
    "ClusterEvaluator",
    "Competition",
    "ContactVariation",
    "CreditedShares",
    "DescriptorRanges",
    "DescriptorReport",
    "DirectFunctionals",
    "DirectJudge",
    "DirectedSpace",
    "Elites",
    "Emitter",
    "EmitterError",
    "Evaluate",
    "Evaluated",
    "EvaluatorRecipe",
    "EvenShares",
    "EvolutionEmitter",
    "ExpertJudge",
    "ExplorationBudget",
    "FunctionalError",
    "FunctionalEvaluator",
    "Functionals",
    "FunctionalsFolderError",
    "Generation",
    "GeneticAlgorithm",
    "GridSpec",
    "GridSpecError",
    "Incumbents",
    "Judge",
    "LanguageDrivenQD",
    "MESEmitter",
    "ManyCellShares",
    "MapElitesSuccess",
    "MeshJudge",
    "Method",
    "MethodError",
    "Metrics",
    "MixedEmitter",
    "MotionEvaluator",
    "MultiBDArchive",
    "MultiBDScheduler",
    "Mutation",
    "NamedMethod",
    "NeighbourScreen",
    "NoCheckpointError",
    "ObservationError",
    "ObservationLog",
    "Observe",
    "OutcomeArchive",
    "OutcomeError",
    "OutcomeFigures",
    "Part",
    "RandomEmitter",
    "RandomSearch",
    "Refusal",
    "RepairingSpace",
    "RunConfig",
    "RunFolder",
    "RunFolderError",
    "SchedulerError",
    "Screen",
    "SelectionError",
    "Setting",
    "Shares",
    "SolutionSpace",
    "SpaceError",
    "StoppedFunction",
    "StoredArchive",
    "StoredArchiveError",
    "StoredGrid",
    "SuccessLine",
    "Summary",
    "Switch",
    "Values",
    "ValuesError",
    "Variation",
    "Worth",
    "carried_out",
    "compete_by_coin",
    "compete_by_fitness",
    "emitter_with",
    "first_contacts",
    "learn_grid_spec",
    "load_checkpoint",
    "open_cluster",
    "passive_fields",
    "report_descriptors",
    "save_checkpoint",
    "search",
    "select_parents",
    "touched",
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
    "archives.grid_spec": ("GridSpec", "GridSpecError", "learn_grid_spec"),
    "archives.multi_bd_archive": ("MultiBDArchive",),
    "emitters.contact_variation": ("ContactVariation",),
    "emitters.emitter": ("Emitter", "EmitterError", "Evaluated"),
    "emitters.evolution_emitter": ("EvolutionEmitter",),
    "emitters.mes_emitter": ("MESEmitter",),
    "emitters.mixed_emitter": ("MixedEmitter", "Part"),
    "emitters.random_emitter": ("RandomEmitter",),
    "emitters.screen": ("NeighbourScreen", "Screen", "Worth", "carried_out"),
    "emitters.selection": ("SelectionError", "select_parents"),
    "emitters.shares": ("CreditedShares", "EvenShares", "ManyCellShares", "Shares"),
    "emitters.variation": ("Mutation", "SuccessLine", "Variation"),
    "evaluation.cluster": ("ClusterError", "open_cluster"),
    "evaluation.cluster_evaluator": ("ClusterEvaluator", "EvaluatorRecipe"),
    "evaluation.contact": ("first_contacts", "touched"),
    "evaluation.descriptor_report": ("DescriptorReport", "report_descriptors"),
    "evaluation.direct_judge": ("DirectFunctionals", "DirectJudge"),
    "evaluation.expert_judge": ("ExpertJudge",),
    "evaluation.functionals": ("FunctionalError", "FunctionalEvaluator", "Functionals"),
    "evaluation.judge": ("Judge",),
    "evaluation.mesh_judge": ("MeshJudge",),
    "evaluation.motion_evaluator": ("MotionEvaluator", "passive_fields"),
    "evaluation.values": ("Refusal", "StoppedFunction", "Values", "ValuesError"),
    "loop": ("Evaluate", "Generation", "Observe", "search"),
    "methods.by_name": ("METHODS", "NamedMethod", "Setting"),
    "methods.exploration_budget": ("BudgetError", "ExplorationBudget"),
    "methods.fitness_exploration": ("LanguageDrivenQD",),
    "methods.genetic_algorithm": ("GeneticAlgorithm",),
    "methods.map_elites_success": ("MapElitesSuccess",),
    "methods.method": ("Method", "MethodError"),
    "methods.plus_switches": ("Switch", "emitter_with"),
    "methods.random_search": ("RandomSearch",),
    "runs.checkpoint": (
        "CheckpointError",
        "NoCheckpointError",
        "load_checkpoint",
        "save_checkpoint",
    ),
    "runs.functionals_folder": ("FunctionalsFolderError",),
    "runs.metrics": ("Metrics",),
    "runs.outcome_archive": ("OutcomeArchive", "OutcomeFigures"),
    "runs.run_config": ("RunConfig",),
    "runs.run_folder": ("RunFolder",),
    "runs.run_folder_error": ("RunFolderError",),
    "runs.stored_archive": ("StoredArchive", "StoredArchiveError", "StoredGrid"),
    "runs.stored_outcomes": ("OutcomeError",),
    "runs.summary": ("Summary",),
    "schedulers.multi_bd_scheduler": ("MultiBDScheduler", "SchedulerError"),
    "solution_space": (
        "BoxSpace",
        "DirectedSpace",
        "RepairingSpace",
        "SolutionSpace",
        "SpaceError",
    ),
}
_HOME = {name: module for module, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
