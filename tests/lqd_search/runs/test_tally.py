import numpy as np

from lqd_envs import Verdict
from lqd_search.evaluation.motion_evaluator import EXPERT, VERDICT
from lqd_search.evaluation.values import Refusal, Values
from lqd_search.runs.tally import Tally


def batch(refusals=()) -> Values:
    verdicts = [Verdict.VALID] * 4 + [Verdict.UNREACHABLE, Verdict.OVERLAPPING, Verdict.TOO_FAST]
    return Values(
        valid=np.array(verdicts) == Verdict.VALID,
        success=np.array([True, True, False, False, False, False, False]),
        fitness={},
        measures={},
        refusals=refusals,
        passive={
            VERDICT: np.array(verdicts, dtype=np.uint8),
            EXPERT: np.array([True, False, True, False, False, False, False]),
        },
    )


def test_every_evaluation_is_counted_by_what_became_of_it():
    tally = Tally()

    tally.add(batch())
    tally.add(batch())

    assert tally.evaluations == 14
    assert tally.valid == 8
    assert tally.rejected == {"unreachable": 2, "overlapping": 2}
    assert tally.discarded == {"diverged": 0, "penetrating": 0, "too_fast": 2}
    assert tally.evaluations == tally.valid + 4 + 2


def test_the_confusion_table_counts_valid_motions_only():
    tally = Tally()

    tally.add(batch())

    assert tally.confusion == [[1, 1], [1, 1]]
    assert tally.inferred_successes == 2
    assert tally.expert_successes == 2


def test_a_refusal_is_reported_once_for_each_reason_and_always_counted():
    tally = Tally()
    nan = Refusal("near", "fitness", 2, "returned NaN", 0)
    none = Refusal("near", "fitness", 1, "returned None", 3)

    assert tally.add(batch((nan,))) == [nan]
    assert tally.add(batch((nan, none))) == [none]
    assert tally.refused == 5
