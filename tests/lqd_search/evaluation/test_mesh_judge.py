import dataclasses

import numpy as np
import pytest

from lqd_search import FunctionalEvaluator, Functionals, Values
from lqd_search.evaluation.mesh_judge import MeshJudge

KEYS = {
    "object_position",
    "object_orientation",
    "object_table_contact",
    "robot_table_contact",
    "gripper_position",
    "gripper_orientation",
    "gripper_contacts",
    "joint_positions",
}


def first_touch(infos):
    return next((info for info in infos if any(info["gripper_contacts"].values())), None)


def late(info):
    if info["joint_positions"]["hot_tap"] > 0.3:
        raise KeyError("late")
    return 0.0


@pytest.fixture
def evaluator(faucet_motions):
    functionals = Functionals(
        success=lambda infos: infos[-1]["joint_positions"]["hot_tap"] > 0.314,
        fitness={"height": lambda info: info["gripper_position"][2], "late": late},
        timestamps={"end": lambda infos: infos[-1], "touch": first_touch},
        quantities={
            "place": lambda info: info["gripper_position"],
            "never": lambda _: (1.0, float("nan")),
        },
    )
    return FunctionalEvaluator(functionals, examples=[faucet_motions.infos(0)[0]])


def test_it_says_what_its_functionals_say(faucet_motions, evaluator):
    judge = MeshJudge(evaluator)
    assert judge.fitness_names == ("height", "late")
    assert judge.descriptors == {"end.place": 3, "touch.place": 3}
    assert judge.dropped == evaluator.dropped
    assert len(judge.dropped) == 1
    values = judge(faucet_motions)
    motions = [(int(i), faucet_motions.infos(i)) for i in np.flatnonzero(faucet_motions.valid)]
    expected = evaluator(motions, valid=faucet_motions.valid)
    for field in dataclasses.fields(Values):
        ours, theirs = getattr(values, field.name), getattr(expected, field.name)
        np.testing.assert_equal(ours, theirs)
    assert values.success[0]
    assert [refusal.functional for refusal in values.refusals] == ["late"]


def test_its_values_are_those_of_the_recorded_columns(faucet_motions, evaluator):
    values, valid = MeshJudge(evaluator)(faucet_motions), faucet_motions.valid
    columns = faucet_motions.columns
    end = np.where(valid[:, None], columns.gripper_position[:, -1], np.nan)
    assert values.measures["end.place"].tobytes() == end.tobytes()
    opened = valid & (columns.joint_positions[:, -1, 0] > 0.314)
    assert values.success.tolist() == opened.tolist()
    height = columns.gripper_position[valid, :, 2].mean(axis=1)
    assert values.fitness["height"][valid] == pytest.approx(height, abs=1e-12)


def test_functionals_see_the_infos_and_nothing_of_the_experts(faucet_motions):
    seen = []

    def note(argument):
        seen.extend(argument if isinstance(argument, list) else [argument])
        return argument[0] if isinstance(argument, list) else (0.0, 0.0)

    functionals = Functionals(
        success=lambda infos: note(infos) is None,
        fitness={"f": lambda info: note(info)[0]},
        timestamps={"h": note},
        quantities={"g": note},
    )
    example = faucet_motions.infos(0)[0]
    MeshJudge(FunctionalEvaluator(functionals, examples=[example]))(faucet_motions)
    assert len(seen) > 76 * faucet_motions.valid.sum()
    for info in seen:
        assert type(info) is dict
        assert set(info) == KEYS
        for value in info.values():
            parts = value.values() if isinstance(value, dict) else value
            parts = parts if isinstance(value, dict | tuple) else [value]
            assert {type(part) for part in parts} <= {float, bool}
