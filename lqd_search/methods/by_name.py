"""The methods by name, as `lqd run --method` and the benchmarks know them."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from lqd_envs import SolutionSpace, Task
from lqd_search.archives.competition import Competition, compete_by_coin, compete_by_fitness
from lqd_search.emitters.emitter import Emitter
from lqd_search.evaluation.contact import CONTACT
from lqd_search.evaluation.expert_judge import ExpertJudge
from lqd_search.evaluation.judge import Judge
from lqd_search.evaluation.motion_evaluator import passive_fields
from lqd_search.methods.exploration_budget import ExplorationBudget
from lqd_search.methods.fitness_exploration import LanguageDrivenQD
from lqd_search.methods.map_elites_success import MapElitesSuccess
from lqd_search.methods.method import Method, MethodError
from lqd_search.methods.plus_switches import Switch, emitter_with, known_switches
from lqd_search.methods.random_search import RandomSearch

KEPT_SWITCHES: frozenset[Switch] = frozenset({Switch.SCREEN})
"""The switches that are on in `ours_plus`, since they paid on at least three tasks."""

FAILURE_COMPETITIONS = ("fitness", "coin")
"""How two failures compete for a cell: by fitness, or by Huber's coin."""

# Tells the coin's generator from all others that begin with the same seed.
_COIN = 0xC0


@dataclass(frozen=True)
class Setting:
    """What a search is set up with, the same for every method.

    Attributes:
        task: The task.
        judge: What it is steered by.
        evaluations: Evaluations to spend.
        batch_size: Solutions in a generation.
        rng: Draws everything.
        explored: Number of fitness functions that `ours` tries, whose exploration ends where the
            ranges of `direct` are learned again.
        failure_competition: One of `FAILURE_COMPETITIONS`.
        switches: Those that are on in `ours_plus`.

    Raises:
        MethodError: A rule of competition or a switch has a name that is not known.
    """

    task: Task
    judge: Judge
    evaluations: int
    batch_size: int
    rng: np.random.Generator
    explored: int = 3
    failure_competition: str = "fitness"
    switches: Collection[Switch] = KEPT_SWITCHES

    def __post_init__(self) -> None:
        if self.failure_competition not in FAILURE_COMPETITIONS:
            raise MethodError(
                f"Expected one of {', '.join(FAILURE_COMPETITIONS)} as failure_competition, but "
                f"got {self.failure_competition!r}; choose one of them."
            )
        known_switches(self.switches)

    def new_competition(self) -> Competition:
        """Return the rule by which a cell is won; a coin is tossed by a generator of its own.

        It leaves `rng` as it is, so that with the same seed a search begins with the same batch by
        either rule.
        """
        if self.failure_competition == "coin":
            seed = self.rng.bit_generator.seed_seq
            return compete_by_coin(np.random.default_rng([*seed.generate_state(4), _COIN]))
        return compete_by_fitness


@dataclass(frozen=True)
class NamedMethod:
    """A method as it can be asked for.

    Attributes:
        build: Makes it.
        summary: What it is, in half a sentence.
        switches: Which are on.
        smallest_batch: Fewest solutions in a generation that it can do with.
        explores: Whether an `ExplorationBudget` shares out its evaluations, or says at least when
            its ranges are learned again.
    """

    build: Callable[[Setting], Method]
    summary: str
    switches: frozenset[Switch] = frozenset()
    smallest_batch: int = 1
    explores: bool = False

    def check_size(self, *, evaluations: int, batch_size: int) -> None:
        """Check what can be known of a run's size before it is known what steers the run.

        Args:
            evaluations: Evaluations to spend.
            batch_size: Solutions in a generation.

        Raises:
            MethodError: There is no evaluation, or a generation has too few solutions.
            BudgetError: The evaluations do not suffice for trying even one fitness.
        """
        if evaluations < 1 or batch_size < self.smallest_batch:
            raise MethodError(
                f"Expected at least 1 evaluation and a batch size of at least "
                f"{self.smallest_batch}, but got {evaluations} and {batch_size}; raise what is too "
                "low."
            )
        if self.explores:
            ExplorationBudget(evaluations, batch_size, runs=1)


def language_driven_qd(
    setting: Setting, *, emitter: Emitter | None = None, stores_contacts: bool = False
) -> LanguageDrivenQD:
    """Make Algorithm 1 with an emitter.

    Args:
        setting: What it is set up with.
        emitter: By default that of the paper.
        stores_contacts: Whether the elites keep where they first touched the object, for an emitter
            that reads it.
    """
    contacts = {CONTACT: ((6,), np.float64)} if stores_contacts else {}
    return LanguageDrivenQD(
        SolutionSpace(),
        descriptors=setting.judge.descriptors,
        fitness_names=setting.judge.fitness_names,
        evaluations=setting.evaluations,
        batch_size=setting.batch_size,
        rng=setting.rng,
        competition=setting.new_competition(),
        emitter=emitter,
        passive_fields={**passive_fields(setting.task), **contacts},
    )


def ours_with(setting: Setting, *, switches: Collection[Switch]) -> LanguageDrivenQD:
    """Make `ours` with some of the switches of `ours_plus` on."""
    return language_driven_qd(
        setting,
        emitter=emitter_with(switches, space=SolutionSpace()),
        stores_contacts=Switch.CONTACT in switches,
    )


def _direct(setting: Setting) -> MapElitesSuccess:
    budget = ExplorationBudget(setting.evaluations, setting.batch_size, setting.explored)
    return MapElitesSuccess(
        SolutionSpace(),
        descriptors=setting.judge.descriptors,
        fitness=setting.judge.fitness_names[0],
        evaluations=setting.evaluations,
        batch_size=setting.batch_size,
        rng=setting.rng,
        relearn_at=budget.exploration,
        competition=setting.new_competition(),
        passive_fields=passive_fields(setting.task),
    )


def _handcrafted(setting: Setting) -> MapElitesSuccess:
    judge = ExpertJudge(setting.task)
    return MapElitesSuccess(
        SolutionSpace(),
        descriptors=judge.descriptors,
        fitness=judge.fitness_names[0],
        evaluations=setting.evaluations,
        batch_size=setting.batch_size,
        rng=setting.rng,
        grids=judge.grids,
        competition=setting.new_competition(),
        passive_fields=passive_fields(setting.task),
    )


def repair_motions(solutions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Bring (n, 9) solutions back into the space; a checkpoint names this function."""
    return SolutionSpace().repair(solutions)


def _ga(setting: Setting) -> Method:
    # Only this method needs pymoo.
    from lqd_search.methods.genetic_algorithm import GeneticAlgorithm

    space = SolutionSpace()
    return GeneticAlgorithm(
        space,
        fitness=setting.judge.fitness_names[0],
        lower=space.lower,
        upper=space.upper,
        repair=repair_motions,
        evaluations=setting.evaluations,
        batch_size=setting.batch_size,
        rng=setting.rng,
        passive_fields=passive_fields(setting.task),
    )


def _random(setting: Setting) -> RandomSearch:
    return RandomSearch(
        SolutionSpace(),
        fitness=setting.judge.fitness_names[0],
        evaluations=setting.evaluations,
        batch_size=setting.batch_size,
        rng=setting.rng,
        passive_fields=passive_fields(setting.task),
    )


METHODS: Mapping[str, NamedMethod] = MappingProxyType(
    {
        "ours": NamedMethod(
            language_driven_qd,
            "Algorithm 1: fitness exploration, then multi-BD MES",
            explores=True,
        ),
        "direct": NamedMethod(
            _direct, "MES on one grid with what the model wrote all at once", explores=True
        ),
        "handcrafted": NamedMethod(
            _handcrafted, "MES with the expert's success, fitness and ground truth"
        ),
        "ga": NamedMethod(_ga, "a genetic algorithm on the fitness of direct", smallest_batch=2),
        "random": NamedMethod(_random, "uniform random solutions, the floor"),
        "ours_plus": NamedMethod(
            lambda setting: ours_with(setting, switches=setting.switches),
            "ours with what pays beside it",
            KEPT_SWITCHES,
            explores=True,
        ),
    }
)
"""The methods by name."""
