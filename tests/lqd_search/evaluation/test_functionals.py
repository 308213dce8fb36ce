import math
import re

import numpy as np
import pytest

from lqd_search import FunctionalError, FunctionalEvaluator, Functionals, Refusal


def moment(x, *, contact=False):
    return {
        "object_position": (x, 0.0, 0.0),
        "object_orientation": (0.0, 0.0, 0.0),
        "object_table_contact": True,
        "robot_table_contact": False,
        "gripper_position": (x, 0.1, 0.2),
        "gripper_orientation": (0.0, 0.0, 0.0),
        "gripper_contacts": {"mug": contact},
        "joint_positions": {},
    }


def x_of(info):
    return info["object_position"][0]


def first_contact(infos):
    return next((info for info in infos if info["gripper_contacts"]["mug"]), None)


def place(info):
    return info["gripper_position"]


def pair(info):
    return [x_of(info), int(info["gripper_contacts"]["mug"])]


def functionals(**changes):
    return Functionals(
        **{
            "success": lambda infos: x_of(infos[-1]) > 1.0,
            "fitness": {"reach": x_of},
            "timestamps": {"start": lambda infos: infos[0], "contact": first_contact},
            "quantities": {"place": place, "pair": pair},
        }
        | changes
    )


EXAMPLE = moment(-1.0)
MOTION = [moment(0.0), moment(1.0, contact=True), moment(3.5)]
CALM = [moment(0.5), moment(0.5)]


def judge(*motions, **changes):
    evaluate = FunctionalEvaluator(functionals(**changes), examples=[EXAMPLE])
    return evaluate(enumerate(motions), valid=np.ones(len(motions), bool))


def test_the_mesh_has_timestamps_outside_and_quantities_inside():
    evaluate = FunctionalEvaluator(functionals(), examples=[moment(0.0)])
    assert evaluate.descriptors == {
        "start.place": 3,
        "start.pair": 2,
        "contact.place": 3,
        "contact.pair": 2,
    }
    assert functionals().descriptors == tuple(evaluate.descriptors)


def test_four_by_four_functions_make_sixteen_descriptors():
    four = functionals(
        timestamps={f"h{i}": first_contact for i in range(4)},
        quantities={f"g{i}": place for i in range(4)},
    )
    assert four.descriptors[:5] == ("h0.g0", "h0.g1", "h0.g2", "h0.g3", "h1.g0")
    assert len(four.descriptors) == 16


def test_motions_become_values():
    values = judge(MOTION, CALM)
    assert values.valid.tolist() == [True, True]
    assert values.success.tolist() == [True, False]
    assert values.fitness["reach"].tolist() == [1.5, 0.5]
    assert values.measures["start.pair"].tolist() == [[0.0, 0.0], [0.5, 0.0]]
    assert values.measures["contact.place"][0].tolist() == [1.0, 0.1, 0.2]
    assert values.measures["contact.pair"][0].tolist() == [1.0, 1.0]
    assert values.refusals == ()


def test_a_moment_that_never_comes_leaves_its_descriptors_undefined():
    values = judge(MOTION, CALM)
    assert np.isnan(values.measures["contact.place"][1]).all()
    assert np.isnan(values.measures["contact.pair"][1]).all()
    assert values.refusals == ()


def test_motions_that_are_not_valid_are_left_out():
    evaluate = FunctionalEvaluator(functionals(), examples=[moment(0.0)])
    values = evaluate(iter([(1, MOTION)]), valid=np.array([False, True, False]))
    assert values.success.tolist() == [False, True, False]
    assert np.isnan(values.fitness["reach"]).tolist() == [True, False, True]
    assert np.isnan(values.measures["start.place"][[0, 2]]).all()


@pytest.mark.parametrize(
    ("motions", "message"),
    [
        ([(0, MOTION)], "motion 2 is missing"),
        ([(0, MOTION), (1, MOTION), (2, MOTION)], "motion 1 has none, comes twice or is not valid"),
        ([(0, MOTION), (0, MOTION)], "motion 0 has none, comes twice"),
        ([(0, [])], "motion 0 has none"),
    ],
)
def test_motions_and_mask_must_agree(motions, message):
    evaluate = FunctionalEvaluator(functionals(), examples=[moment(0.0)])
    with pytest.raises(FunctionalError, match=message):
        evaluate(motions, valid=np.array([True, False, True]))


def test_numbers_of_numpy_and_bools_are_taken():
    values = judge(
        CALM,
        success=lambda _: np.bool_(True),
        fitness={"reach": lambda _: np.float32(0.5), "touch": lambda _: True},
        quantities={"mixed": lambda _: (np.int64(2), np.float64(0.5), True, np.bool_(False))},
    )
    assert values.success.tolist() == [True]
    assert values.fitness["reach"].tolist() == [0.5]
    assert values.fitness["touch"].tolist() == [1.0]
    assert values.measures["start.mixed"].tolist() == [[2.0, 0.5, 1.0, 0.0]]


def test_a_quantity_is_computed_once_for_a_moment_picked_twice():
    calls = []

    def counting(info):
        calls.append(info)
        return (1.0, 2.0)

    first = {"a": lambda infos: infos[0], "b": lambda infos: infos[0]}
    values = judge(MOTION, timestamps=first, quantities={"count": counting})
    assert len(calls) == 2  # one of them on the example
    assert values.measures["b.count"].tolist() == [[1.0, 2.0]]


def exploding(_):
    return 1 / 0


def recursing(argument):
    return recursing(argument)


def exhausting(_):
    raise MemoryError


@pytest.mark.parametrize(
    ("success", "reason"),
    [
        (lambda _: 1, "returned a value of type int, not a bool"),
        (lambda _: None, "returned None, not a bool"),
        (exploding, "raised ZeroDivisionError in line"),
        (recursing, "raised RecursionError in line"),
        (exhausting, "raised MemoryError in line"),
        (lambda: True, "raised TypeError"),
    ],
)
def test_a_refused_success_is_a_failure_with_its_fitness_and_measures(success, reason):
    values = judge(MOTION, success=success)
    assert values.valid.tolist() == [True]
    assert values.success.tolist() == [False]
    assert values.fitness["reach"].tolist() == [1.5]
    assert values.measures["start.place"].tolist() == [[0.0, 0.1, 0.2]]
    (refusal,) = values.refusals
    assert (refusal.kind, refusal.functional, refusal.count) == ("success", "success", 1)
    assert refusal.reason.startswith(reason)


def except_on_the_example(fitness):
    """Behave on the example, so that the function is used."""
    return lambda info: 0.0 if info is EXAMPLE else fitness(info)


@pytest.mark.parametrize(
    ("fitness", "reason"),
    [
        (exploding, "raised ZeroDivisionError in line"),
        (lambda _: None, "returned None, not a number"),
        (lambda _: "1.0", "returned a value of type str, not a number"),
        (lambda _: np.array(1.0), "returned a value of type ndarray, not a number"),
        (lambda _: 1j, "returned a value of type complex, not a number"),
        (lambda _: math.nan, "returned NaN"),
        (lambda _: np.float64(1.0) / np.float64(0.0), "returned infinity"),
        (lambda _: 10**400, "returned an integer too large for a float"),
        (lambda _: 1.7e308, "returned numbers whose mean is too large for a float"),
        (lambda _: {}["reach"], "raised KeyError in line"),
    ],
)
def test_a_refused_fitness_is_undefined_and_the_others_are_not(fitness, reason):
    values = judge(MOTION, fitness={"bad": except_on_the_example(fitness), "good": x_of})
    assert np.isnan(values.fitness["bad"]).all()
    assert values.fitness["good"].tolist() == [1.5]
    assert values.success.tolist() == [True]
    (refusal,) = values.refusals
    assert (refusal.kind, refusal.functional) == ("fitness", "bad")
    assert refusal.reason.startswith(reason)


def test_a_fitness_refused_at_one_moment_is_refused_altogether():
    log = except_on_the_example(lambda info: math.log(x_of(info)))
    values = judge(MOTION, CALM, fitness={"log": log})
    assert np.isnan(values.fitness["log"]).tolist() == [True, False]
    assert values.fitness["log"][1] == math.log(0.5)


@pytest.mark.parametrize(
    ("timestamp", "reason"),
    [
        (exploding, "raised ZeroDivisionError in line"),
        (lambda infos: dict(infos[0]), "returned something else than an element of infos or None"),
        (lambda _: 0, "returned something else than an element of infos or None"),
        (lambda _: False, "returned something else than an element of infos or None"),
    ],
)
def test_a_refused_timestamp_leaves_its_descriptors_undefined(timestamp, reason):
    values = judge(MOTION, timestamps={"bad": timestamp, "start": lambda infos: infos[0]})
    assert np.isnan(values.measures["bad.place"]).all()
    assert np.isnan(values.measures["bad.pair"]).all()
    assert not np.isnan(values.measures["start.place"]).any()
    (refusal,) = values.refusals
    assert (refusal.kind, refusal.functional) == ("timestamp", "bad")
    assert refusal.reason.startswith(reason)


def after_the_start(result):
    """Behave on the example and at the start, and return `result` at later moments."""
    return lambda info: (0.0, 0.0) if x_of(info) <= 0.0 else result


@pytest.mark.parametrize(
    ("result", "reason"),
    [
        ((1.0, 2.0, 3.0), "returned 3 numbers, not 2 as on an example"),
        ((1.0,), "returned 1 numbers, not between 2 and 5"),
        ((1.0, math.nan), "returned NaN"),
        ((1.0, -math.inf), "returned infinity"),
        ((1.0, None), "returned None, not a number"),
        ((1.0, (2.0,)), "returned a value of type tuple, not a number"),
        (None, "returned None, not a tuple of numbers"),
        (1.0, "returned a value of type float, not a tuple of numbers"),
        (np.zeros(2), "returned a value of type ndarray, not a tuple of numbers"),
    ],
)
def test_a_refused_quantity_leaves_that_descriptor_undefined(result, reason):
    values = judge(MOTION, quantities={"bad": after_the_start(result), "place": place})
    assert values.measures["start.bad"].tolist() == [[0.0, 0.0]]
    assert np.isnan(values.measures["contact.bad"]).all()
    assert not np.isnan(values.measures["contact.place"]).any()
    assert values.refusals == (Refusal("bad", "quantity", 1, reason, 0),)


def test_refusals_count_motions_and_name_the_first():
    moving = [moment(0.0), moment(2.0, contact=True)]
    values = judge(
        CALM,
        moving,
        moving,
        fitness={"root": lambda info: math.sqrt(-x_of(info))},
        timestamps={"a": lambda infos: infos[-1], "b": first_contact},
        quantities={"bad": after_the_start(None)},
    )
    assert [(r.kind, r.functional, r.count, r.first_motion) for r in values.refusals] == [
        ("fitness", "root", 3, 0),
        ("quantity", "bad", 3, 0),
    ]


def test_the_line_is_that_of_the_functions_own_source():
    source = "import statistics\n\ndef fitness(info):\n    return helper(info)\n\n"
    source += "def helper(info):\n    x, _, _ = info['object_position']\n"
    source += "    return statistics.mean([0.0][x > 0 :])\n"
    namespace = {}
    exec(compile(source, "<fitness reach>", "exec"), namespace)
    values = judge(CALM, fitness={"reach": namespace["fitness"]})
    assert values.refusals[0].reason == "raised StatisticsError in line 8"


def test_interrupts_are_not_refusals():
    def interrupted(_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        judge(CALM, fitness={"reach": except_on_the_example(interrupted)})


def sorting(infos):
    infos.sort(key=x_of, reverse=True)
    return x_of(infos[0]) > 1.0


def popping(infos):
    return infos.pop()


def test_a_function_that_changes_its_list_does_not_change_what_the_next_one_sees():
    values = judge(
        MOTION,
        success=sorting,
        timestamps={
            "last": popping,
            "again": popping,
            "none": lambda infos: infos.clear(),
            "start": lambda infos: infos[0],
        },
    )
    assert values.success.tolist() == [True]
    assert values.fitness["reach"].tolist() == [1.5]
    assert values.measures["last.place"].tolist() == [[3.5, 0.1, 0.2]]
    assert values.measures["again.place"].tolist() == [[3.5, 0.1, 0.2]]
    assert values.measures["start.place"].tolist() == [[0.0, 0.1, 0.2]]
    assert values.refusals == ()
    assert [x_of(info) for info in MOTION] == [0.0, 1.0, 3.5]


@pytest.mark.parametrize(
    ("quantity", "reason"),
    [
        (exploding, "raised ZeroDivisionError"),
        (lambda _: (1.0,), "returned 1 numbers, not between 2 and 5"),
        (lambda _: (1.0,) * 6, "returned 6 numbers, not between 2 and 5"),
        (lambda _: (1.0, math.nan), "returned NaN"),
        (lambda _: "ab", "returned a value of type str, not a tuple"),
    ],
)
def test_a_quantity_that_fails_on_the_example_cannot_be_used(quantity, reason):
    evaluate = FunctionalEvaluator(
        functionals(quantities={"bad": quantity, "good": place}), examples=[moment(0.0)] * 2
    )

    assert all(name.endswith(".good") for name in evaluate.descriptors)
    (sentence,) = evaluate.dropped
    assert re.match(
        f"The quantity function 'bad' is not used: .* 2 example .* it {reason}", sentence
    )
    with pytest.raises(FunctionalError, match=r"there is none: .*Correct one, or add others"):
        FunctionalEvaluator(functionals(quantities={"bad": quantity}), examples=[moment(0.0)])


@pytest.mark.parametrize(
    ("fitness", "reason"),
    [
        (exploding, "raised ZeroDivisionError"),
        (lambda _: None, "returned None, not a number"),
        (lambda _: math.nan, "returned NaN"),
        (lambda _: np.float64(1.0) / np.float64(0.0), "returned infinity"),
    ],
)
def test_a_fitness_that_fails_on_every_example_cannot_be_used(fitness, reason):
    evaluate = FunctionalEvaluator(
        functionals(fitness={"bad": fitness, "good": x_of}), examples=[moment(0.0)] * 2
    )

    assert evaluate.fitness_names == ("good",)
    (sentence,) = evaluate.dropped
    assert re.match(
        f"The fitness function 'bad' is not used: .* 2 example .* it {reason}", sentence
    )
    values = evaluate([(0, MOTION)], valid=np.array([True]))
    assert list(values.fitness) == ["good"]
    assert values.refusals == ()
    with pytest.raises(FunctionalError, match=r"a fitness that gives .* there is none: .*Correct"):
        FunctionalEvaluator(functionals(fitness={"bad": fitness}), examples=[moment(0.0)])


def test_a_fitness_that_gives_a_number_on_one_example_is_used():
    evaluate = FunctionalEvaluator(
        functionals(fitness={"log": lambda info: math.log(x_of(info))}),
        examples=[moment(0.0), moment(1.0)],
    )

    assert evaluate.fitness_names == ("log",)
    assert evaluate.dropped == ()


def test_without_examples_nothing_can_be_tried():
    with pytest.raises(FunctionalError, match="at least one example moment of the task"):
        FunctionalEvaluator(functionals(), examples=[])


def test_a_quantity_is_measured_on_the_first_example_that_it_can_measure():
    def late(info):
        return (1.0, 2.0, 3.0) if info["object_position"][0] > 0.5 else None

    evaluate = FunctionalEvaluator(
        functionals(quantities={"late": late}), examples=[moment(0.0), moment(1.0)]
    )

    assert set(evaluate.descriptors.values()) == {3}
    assert evaluate.dropped == ()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"fitness": {}}, r"in fitness, with names without dots, but got the names \(\)"),
        ({"timestamps": {"a.b": first_contact}}, "in timestamps.*'a.b'"),
        ({"quantities": {"": place}}, "in quantities"),
    ],
)
def test_names_must_be_there_and_without_dots(changes, message):
    with pytest.raises(FunctionalError, match=message):
        functionals(**changes)
