"""What an instance asks, in words."""

import math

import pytest

from lqd_envs import PAPER_TASKS
from lqd_envs.instances import (
    KINDS,
    ApproachLimit,
    HeldPart,
    Instance,
    InstanceError,
    JointBand,
    MovedSector,
    Obstacle,
    SceneChange,
    describe,
    generate_instances,
)

FAUCET, DRAWER, GRASP, PUSH = "LQD/Faucet-v0", "LQD/Drawer-v0", "LQD/Grasp-v0", "LQD/Push-v0"


@pytest.mark.parametrize(
    ("instance", "sentence"),
    [
        (
            Instance(FAUCET, predicate=JointBand("hot_tap", math.radians(30), math.radians(45))),
            "The joint hot_tap ends between 30.0° and 45.0°.",
        ),
        (
            Instance(DRAWER, predicate=JointBand("drawer", 0.10, 0.125)),
            "The joint drawer ends between 10.0 and 12.5 cm.",
        ),
        (
            Instance(GRASP, predicate=HeldPart("rim", -0.01, 0.03)),
            "The mug is held by its rim, with the fingertips -1.0 to 3.0 cm above its bottom.",
        ),
        (
            Instance(PUSH, predicate=MovedSector(-math.pi / 2, math.radians(20), 0.06, 0.1)),
            "The object ends 6.0 to 10.0 cm from where it stood, at most 20° off 90° to the right "
            "of straight ahead.",
        ),
        (
            Instance(PUSH, approach=ApproachLimit((0, 0, -1), math.radians(25))),
            "At the start the fingers point at most 25° off the direction 90° below the "
            "horizontal.",
        ),
        (
            Instance(PUSH, approach=ApproachLimit((1, 0, 1), math.radians(25))),
            "At the start the fingers point at most 25° off the direction 45° above the "
            "horizontal, straight ahead from the robot.",
        ),
        (
            Instance(PUSH, obstacles=(Obstacle((0.5, 0.1, 0.1), (0.02, 0.03, 0.1), math.pi / 2),)),
            "A box of 4.0 by 6.0 by 20.0 cm, which the robot must not touch, stands on the table "
            "at x 0.500, y 0.100 m, turned by 90°.",
        ),
        (
            Instance(PUSH, obstacles=(Obstacle((0.5, 0.1, 0.31), (0.02, 0.03, 0.01)),)),
            "A box of 4.0 by 6.0 by 2.0 cm, which the robot must not touch, is 30.0 cm up at "
            "x 0.500, y 0.100 m, turned by 0°.",
        ),
        (
            Instance(PUSH, obstacles=(Obstacle((0.5, 0.1, 0.1), (0.02, 0.03, 0.2)),)),
            "A box of 4.0 by 6.0 by 40.0 cm, which the robot must not touch, begins 10.0 cm below "
            "the table's top at x 0.500, y 0.100 m, turned by 0°.",
        ),
        (
            Instance(PUSH, change=SceneChange(shift=(0.01, -0.02), turn=0.2, mass=1.5)),
            "The object is changed: it is moved by +1.0 cm in x and -2.0 cm in y, it is turned by "
            "+11°, its mass is scaled by 1.50.",
        ),
        (Instance(PUSH, change=SceneChange()), "The object is changed: by nothing."),
        (Instance(PUSH), "Nothing is particular: it is the task itself."),
    ],
)
def test_each_part_is_a_sentence(instance, sentence):
    assert describe(instance) == (sentence,)


@pytest.mark.parametrize("task", PAPER_TASKS, ids=lambda task: task.name)
@pytest.mark.parametrize("kind", KINDS)
def test_different_drawn_instances_are_described_differently(task, kind):
    instances = generate_instances(task, kind, count=10, seed=1)

    described = [describe(instance) for instance in instances]

    assert len(set(described)) == 10
    for instance, sentences in zip(instances, described, strict=True):
        assert len(sentences) == max(1, len(instance.obstacles))


def test_an_instance_that_does_not_fit_its_task_is_an_error():
    with pytest.raises(InstanceError, match="Expected a joint of"):
        describe(Instance(PUSH, predicate=JointBand("hot_tap", 0.1, 0.2)))
