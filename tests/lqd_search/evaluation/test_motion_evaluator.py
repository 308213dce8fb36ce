import numpy as np
import pytest

from lqd_envs import Verdict, get_task, rollout
from lqd_search import MotionEvaluator, passive_fields
from lqd_search.evaluation.contact import first_contacts, touched
from lqd_search.evaluation.expert_judge import ExpertJudge

TASK = get_task("LQD/Faucet-v0")


class Silent:
    """A judge that notes what it is given, and has no columns of its own."""

    fitness_names = ("expert",)
    dropped = ()

    def __init__(self):
        self.expert = ExpertJudge(TASK)
        self.descriptors = self.expert.descriptors
        self.given = []

    def __call__(self, trajectories):
        self.given.append(trajectories)
        return self.expert(trajectories)


@pytest.fixture(scope="module")
def few(solutions):
    return solutions[:12]


def test_the_judges_values_get_four_passive_columns_and_the_contacts(few):
    judge = Silent()
    values = MotionEvaluator(TASK, judge)(few)
    (motions,) = judge.given
    expected = judge.expert(motions)
    np.testing.assert_equal(values.fitness, expected.fitness)
    np.testing.assert_equal(values.measures, expected.measures)
    assert values.success.tolist() == expected.success.tolist()
    assert list(values.passive) == ["expert", "ground_truth", "digest", "verdict"]
    assert values.passive["expert"].tolist() == motions.success().tolist()
    np.testing.assert_equal(values.passive["ground_truth"], motions.ground_truth())
    assert values.passive["digest"].tolist() == motions.digests().tolist()
    assert values.passive["verdict"].tolist() == motions.verdicts.tolist()
    np.testing.assert_equal(values.perceived, {"contact": first_contacts(motions)})
    assert touched(values)[0]
    assert motions.verdicts[0] == Verdict.VALID


def test_the_values_do_not_depend_on_the_threads(few):
    one, two = (MotionEvaluator(TASK, ExpertJudge(TASK), threads)(few) for threads in (1, 2))
    np.testing.assert_equal(vars(one), vars(two))


def test_the_passive_fields_are_those_of_the_columns(few):
    values = MotionEvaluator(TASK, ExpertJudge(TASK))(few)
    for name, (shape, dtype) in passive_fields(TASK).items():
        assert values.passive[name].shape == (len(few), *shape)
        assert values.passive[name].dtype == dtype


def test_it_judges_the_motions_of_a_rollout(few):
    values = MotionEvaluator(TASK, ExpertJudge(TASK))(few)
    assert values.passive["digest"].tolist() == rollout(TASK, few).digests().tolist()


@pytest.mark.parametrize("chunk", [1, 5, 12, 100])
def test_the_values_do_not_depend_on_the_chunks(few, chunk):
    judge = Silent()
    chunked = MotionEvaluator(TASK, judge, chunk=chunk)(few)
    whole = MotionEvaluator(TASK, ExpertJudge(TASK))(few)
    np.testing.assert_equal(vars(chunked), vars(whole))
    assert [len(motions) for motions in judge.given] == [
        min(chunk, len(few) - start) for start in range(0, len(few), chunk)
    ]


def test_no_solutions_have_no_values(few):
    values = MotionEvaluator(TASK, ExpertJudge(TASK))(few[:0])
    assert len(values) == 0
    assert list(values.measures) == ["ground_truth"]


def test_an_error_of_the_judge_is_raised(few):
    def refuse(trajectories):
        raise RuntimeError(f"{len(trajectories)} motions")

    with pytest.raises(RuntimeError, match="5 motions"):
        MotionEvaluator(TASK, refuse, chunk=5)(few)
