import math

import numpy as np
import pytest

from lqd_search import FunctionalError
from lqd_search.evaluation.direct_judge import DirectFunctionals, DirectJudge


def hot_tap(info):
    return info["joint_positions"]["hot_tap"]


def opened(infos):
    return hot_tap(infos[-1]) > 0.314


def end(infos):
    return infos[-1]["gripper_position"]


def functionals(**changes):
    return DirectFunctionals(
        **({"success": opened, "fitness": hot_tap, "descriptor": end} | changes)
    )


@pytest.fixture
def judge(faucet_motions):
    examples = [faucet_motions.infos(0)]
    return lambda **changes: DirectJudge(functionals(**changes), examples=examples)


def except_at_the_start(function):
    """Behave on the example, which turns the tap, and fail on motions that do not."""
    return lambda infos: end(infos) if hot_tap(infos[-1]) > 0.1 else function(infos)


def exploding(_):
    return 1 / 0


def test_three_functions_make_values(judge, faucet_motions):
    direct, valid = judge(), faucet_motions.valid
    assert (direct.fitness_names, direct.descriptors) == (("direct",), {"direct": 3})
    assert direct.dropped == ()
    values = direct(faucet_motions)
    columns = faucet_motions.columns
    assert values.valid.tolist() == valid.tolist()
    assert values.success.tolist() == faucet_motions.success().tolist()
    place = np.where(valid[:, None], columns.gripper_position[:, -1], np.nan)
    assert values.measures["direct"].tobytes() == place.tobytes()
    mean = columns.joint_positions[valid, :, 0].mean(axis=1)
    assert values.fitness["direct"][valid] == pytest.approx(mean, abs=1e-12)
    assert np.isnan(values.fitness["direct"][~valid]).all()
    assert (values.passive, values.perceived, values.refusals) == ({}, {}, ())


@pytest.mark.parametrize(
    ("success", "reason"),
    [
        (exploding, "raised ZeroDivisionError in line"),
        (lambda _: None, "returned None, not a bool"),
        (lambda _: 1, "returned a value of type int, not a bool"),
    ],
)
def test_a_refused_success_is_a_failure(judge, faucet_motions, success, reason):
    values = judge(success=success)(faucet_motions)
    assert not values.success.any()
    assert not np.isnan(values.fitness["direct"][values.valid]).any()
    assert not np.isnan(values.measures["direct"][values.valid]).any()
    (refusal,) = values.refusals
    assert (refusal.kind, refusal.functional) == ("success", "direct")
    assert refusal.count == values.valid.sum()
    assert refusal.first_motion == np.argmax(values.valid)
    assert refusal.reason.startswith(reason)


def test_a_refused_fitness_is_undefined(judge, faucet_motions):
    values = judge(fitness=lambda info: math.sqrt(info["gripper_position"][2] - 0.1))(
        faucet_motions
    )
    too_low = (faucet_motions.columns.gripper_position[:, :, 2] < 0.1).any(axis=1)
    assert too_low[values.valid].any()
    assert np.isnan(values.fitness["direct"]).tolist() == (too_low | ~values.valid).tolist()
    assert values.success.tolist() == faucet_motions.success().tolist()
    (refusal,) = values.refusals
    assert (refusal.kind, refusal.functional) == ("fitness", "direct")
    assert refusal.reason.startswith("raised ValueError in line")
    assert refusal.count == (too_low & values.valid).sum()


@pytest.mark.parametrize(
    ("descriptor", "reason"),
    [
        (exploding, "raised ZeroDivisionError in line"),
        (lambda _: (1.0, 2.0), "returned 2 numbers, not 3 as on an example"),
        (lambda _: (1.0,), "returned 1 numbers, not between 2 and 5"),
        (lambda _: (1.0,) * 6, "returned 6 numbers, not between 2 and 5"),
        (lambda _: (1.0, 2.0, math.inf), "returned infinity"),
        (lambda _: (1.0, 2.0, math.nan), "returned NaN"),
        (lambda _: 1.0, "returned a value of type float, not a tuple of numbers"),
        (lambda _: np.zeros(3), "returned a value of type ndarray, not a tuple of numbers"),
        (lambda infos: infos[0], "returned a value of type dict, not a tuple of numbers"),
    ],
)
def test_a_refused_descriptor_is_undefined(judge, faucet_motions, descriptor, reason):
    values = judge(descriptor=except_at_the_start(descriptor))(faucet_motions)
    turned = values.valid & (faucet_motions.columns.joint_positions[:, -1, 0] > 0.1)
    assert turned[0]
    assert np.isnan(values.measures["direct"][:, 0]).tolist() == (~turned).tolist()
    (refusal,) = values.refusals
    assert (refusal.kind, refusal.functional) == ("descriptor", "direct")
    assert refusal.count == (values.valid & ~turned).sum()
    assert refusal.reason.startswith(reason)


def test_none_is_undefined_and_nothing_to_refuse(judge, faucet_motions):
    values = judge(descriptor=except_at_the_start(lambda _: None))(faucet_motions)
    assert np.isnan(values.measures["direct"]).any()
    assert not np.isnan(values.measures["direct"][0]).any()
    assert values.refusals == ()


def test_a_function_that_changes_its_list_does_not_change_what_the_next_one_sees(
    judge, faucet_motions
):
    def emptying(infos):
        while len(infos) > 1:
            infos.pop(0)
        return opened(infos)

    plain, changed = (judge(success=s)(faucet_motions) for s in (opened, emptying))
    np.testing.assert_equal(vars(changed), vars(plain))


def test_numpys_warnings_are_not_shown(judge, faucet_motions):
    values = judge(fitness=lambda _: float(np.float64(1.0) / np.float64(2.0)))(faucet_motions)
    assert (values.fitness["direct"][values.valid] == 0.5).all()
    values = judge(descriptor=except_at_the_start(lambda _: (np.float64(0.0) / 0.0,) * 3))(
        faucet_motions
    )
    assert values.refusals[0].reason == "returned NaN"


def lacking(infos):
    """Not defined on the motion that turns the tap."""
    return None if hot_tap(infos[-1]) > 0.1 else (1.0, 2.0)


def test_the_length_is_that_of_the_first_example_it_can_measure(faucet_motions):
    valid = np.flatnonzero(faucet_motions.valid)
    untouched = valid[faucet_motions.columns.joint_positions[valid, -1, 0] < 0.01]
    examples = [faucet_motions.infos(0), faucet_motions.infos(int(untouched[0]))]
    judge = DirectJudge(functionals(descriptor=lacking), examples=examples)
    assert judge.descriptors == {"direct": 2}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"descriptor": exploding}, "of 1 there is none: on the last one it raised ZeroDivision"),
        ({"descriptor": lacking}, "there is none: it is not defined on the last one; correct it"),
        ({"descriptor": lambda _: (1.0,)}, "on the last one it returned 1 numbers, not between"),
        ({"fitness": exploding}, "a direct fitness .* on the last of 1 it raised ZeroDivision"),
        ({"fitness": lambda _: math.nan}, "on the last of 1 it returned NaN; correct it"),
    ],
)
def test_functions_that_fail_on_every_example_cannot_be_used(judge, changes, message):
    with pytest.raises(FunctionalError, match=message):
        judge(**changes)


def test_without_examples_nothing_can_be_tried():
    with pytest.raises(FunctionalError, match="of 0 there is none: it is given none; correct"):
        DirectJudge(functionals(), examples=[])
