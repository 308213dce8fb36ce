import math

import numpy as np
import pytest

from lqd_envs import PAPER_TASKS, get_task
from lqd_search.evaluation.expert_judge import ExpertJudge

by_task = pytest.mark.parametrize("task", PAPER_TASKS, ids=lambda task: task.name)


@by_task
def test_it_has_one_fitness_and_one_descriptor_with_its_grid(task):
    judge = ExpertJudge(task)
    truth = task.ground_truth
    assert judge.fitness_names == ("expert",)
    assert judge.descriptors == {"ground_truth": len(truth.dims)}
    assert judge.dropped == ()
    (spec,) = judge.grids.values()
    assert list(judge.grids) == list(judge.descriptors)
    assert (spec.dims, spec.ranges) == (truth.dims, truth.ranges)


@by_task
def test_its_word_is_the_tasks_own(task, motions_of):
    motions = motions_of(task.id)
    values = ExpertJudge(task)(motions)
    assert motions.valid.any()
    assert not motions.valid.all()
    assert values.valid.tolist() == motions.valid.tolist()
    assert values.success.tolist() == motions.success().tolist()
    assert values.measures["ground_truth"].tobytes() == motions.ground_truth().tobytes()
    assert (values.passive, values.perceived, values.refusals) == ({}, {}, ())


def test_a_motion_that_turns_on_the_water_is_a_success(faucet_motions):
    assert ExpertJudge(faucet_motions.task)(faucet_motions).success[0]


@by_task
def test_its_fitness_is_the_mean_nearness_over_all_moments(task, motions_of):
    motions = motions_of(task.id)
    fitness = ExpertJudge(task)(motions).fitness["expert"]
    assert np.isnan(fitness).tolist() == (~motions.valid).tolist()
    for i in np.flatnonzero(motions.valid):
        alone = motions.columns.rows(np.array([i]))
        nearness = [float(task.nearness(alone.until(t))[0]) for t in range(76)]
        assert fitness[i] == pytest.approx(math.fsum(nearness) / 76, abs=1e-12)
        assert 0.0 <= fitness[i] <= 1.0


def test_a_motion_has_the_same_values_in_whatever_batch_it_comes(faucet_motions):
    judge = ExpertJudge(faucet_motions.task)
    together = judge(faucet_motions).fitness["expert"]
    for row in range(5):
        alone = judge(faucet_motions.rows(np.array([row]))).fitness["expert"]
        assert alone.tobytes() == together[row : row + 1].tobytes()


def test_there_may_be_no_motion(faucet_motions):
    values = ExpertJudge(get_task("LQD/Faucet-v0"))(faucet_motions.rows(np.empty(0, int)))
    assert len(values) == 0
    assert values.measures["ground_truth"].shape == (0, 1)
