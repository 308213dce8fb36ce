import pickle

import numpy as np
import pytest

from lqd_envs import PAPER_TASKS, SolutionSpace, get_task
from lqd_envs.errors import LQDError
from lqd_search import METHODS, ExpertJudge, MethodError, Setting, Values, compete_by_fitness
from lqd_search.evaluation.contact import CONTACT
from lqd_search.evaluation.motion_evaluator import DIGEST, EXPERT, GROUND_TRUTH
from lqd_search.methods.by_name import FAILURE_COMPETITIONS, KEPT_SWITCHES, repair_motions
from lqd_search.methods.plus_switches import Switch
from lqd_search.methods.steering import EXPERT as BY_EXPERT
from lqd_search.methods.steering import STEERING

FAUCET = get_task("LQD/Faucet-v0")


class Judge:
    """Two fitness functions and two descriptors, of which none is ever called."""

    fitness_names = ("one", "two")
    descriptors = {"start.a": 2, "end.a": 3}  # noqa: RUF012 -- nobody changes it
    dropped = ()


def setting(name, **changes):
    judge = ExpertJudge(FAUCET) if STEERING[name] == BY_EXPERT else Judge()
    options = {"evaluations": 640, "batch_size": 32, "explored": 2, **changes}
    return Setting(task=FAUCET, judge=judge, rng=np.random.default_rng(0), **options)


def values_of(solutions, judge):
    rng = np.random.default_rng(len(solutions))
    n = len(solutions)
    valid = rng.random(n) < 0.8
    blank = np.where(valid, 0.0, np.nan)
    return Values(
        valid=valid,
        success=valid & (rng.random(n) < 0.3),
        fitness=dict.fromkeys(judge.fitness_names, blank + solutions[:, 0]),
        measures={k: blank[:, None] + solutions[:, :d] for k, d in judge.descriptors.items()},
        passive={
            EXPERT: valid & (rng.random(n) < 0.3),
            GROUND_TRUTH: blank[:, None] + rng.random((n, 1)),
            DIGEST: np.arange(n, dtype=np.uint64),
        },
        perceived={CONTACT: blank[:, None] + rng.random((n, 6))},
    )


def test_each_method_is_steered_by_something():
    assert list(METHODS) == list(STEERING)


@pytest.mark.parametrize("name", METHODS)
def test_each_method_spends_every_evaluation_and_can_be_pickled(name):
    given = setting(name)
    method = METHODS[name].build(given)
    while not method.done:
        solutions = method.ask()
        assert SolutionSpace().feasible(solutions).all()
        method.tell(values_of(solutions, given.judge))
        method = pickle.loads(pickle.dumps(method))
    assert method.evaluations == 640
    assert {EXPERT, GROUND_TRUTH, DIGEST} <= set(method.output())


@pytest.mark.parametrize("name", METHODS)
def test_the_same_seed_gives_the_same_first_generation(name):
    first, again = (METHODS[name].build(setting(name)).ask() for _ in range(2))
    assert first.tobytes() == again.tobytes()


def test_ours_plus_begins_as_ours():
    asked = [METHODS[name].build(setting(name)).ask().tobytes() for name in ("ours", "ours_plus")]
    assert asked[0] == asked[1]


def test_direct_learns_its_ranges_again_where_the_exploration_of_ours_ends():
    ours = METHODS["ours"].build(setting("ours"))
    direct = METHODS["direct"].build(setting("direct"))
    while direct.evaluations < ours.budget.exploration:
        before = direct.archive
        direct.tell(values_of(direct.ask(), Judge()))
    assert direct.archive is not before


@pytest.mark.parametrize("task", PAPER_TASKS, ids=lambda task: task.name)
def test_handcrafted_has_the_ground_truth_grid(task):
    method = METHODS["handcrafted"].build(
        Setting(
            task=task,
            judge=ExpertJudge(task),
            evaluations=64,
            batch_size=32,
            rng=np.random.default_rng(0),
        )
    )
    (spec,) = method.archive.specs.values()
    assert (spec.dims, spec.ranges) == (task.ground_truth.dims, task.ground_truth.ranges)


def test_failures_compete_by_a_coin_of_their_own():
    by_fitness = setting("ours").new_competition()
    coin = setting("ours", failure_competition="coin").new_competition()
    assert by_fitness is compete_by_fitness
    assert coin.rng.random() != np.random.default_rng(0).random()


def test_the_first_batch_does_not_depend_on_how_failures_compete():
    first = [
        METHODS["ours"].build(setting("ours", failure_competition=rule)).ask()
        for rule in FAILURE_COMPETITIONS
    ]
    assert first[0].tobytes() == first[1].tobytes()


def test_switches_are_known():
    assert set(Switch) >= KEPT_SWITCHES


def test_motions_are_repaired_as_by_their_space():
    wild = np.random.default_rng(0).normal(0.0, 3.0, (50, 9))
    assert repair_motions(wild).tobytes() == SolutionSpace().repair(wild).tobytes()


@pytest.mark.parametrize("name", METHODS)
@pytest.mark.parametrize(
    ("evaluations", "batch_size"), [(0, 2), (5, 0), (5, 1), (5, 2), (19, 1), (20, 1), (39, 2)]
)
def test_what_is_refused_before_anything_is_inferred_is_what_cannot_be_made(
    name, evaluations, batch_size
):
    def refusal(attempt):
        try:
            attempt()
        except LQDError as error:
            return type(error)

    size = {"evaluations": evaluations, "batch_size": batch_size}
    early = refusal(lambda: METHODS[name].check_size(**size))
    late = refusal(lambda: METHODS[name].build(setting(name, **size)))
    assert (early is None) == (late is None)


def test_where_nothing_is_explored_the_refusal_does_not_speak_of_it():
    for attempt in (
        lambda: METHODS["direct"].check_size(evaluations=100, batch_size=32),
        lambda: METHODS["direct"].build(setting("direct", evaluations=100)),
    ):
        with pytest.raises(
            LQDError,
            match=r"^Expected a tenth of the evaluations to make at least two generations, but a "
            r"tenth of 100 makes 0 of 32; use a batch size of at most 5\.$",
        ):
            attempt()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"failure_competition": "coins"}, "Expected one of fitness, coin .*, but got 'coins'"),
        ({"switches": {"screens"}}, "Expected switches among line, random, .* got 'screens'; ch"),
        ({"switches": ["line", "lines", 3]}, "but got 'lines', 3; choose from these"),
    ],
)
def test_misspelt_names_are_refused(changes, message):
    with pytest.raises(MethodError, match=message):
        setting("ours_plus", **changes)


def test_a_switch_may_be_given_by_its_name():
    asked = [
        METHODS["ours_plus"].build(setting("ours_plus", switches=switches)).ask().tobytes()
        for switches in ({"screen"}, {Switch.SCREEN})
    ]
    assert asked[0] == asked[1]
