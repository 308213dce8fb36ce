import gymnasium as gym
import numpy as np
import pytest

from lqd_envs import PAPER_TASKS, get_task, rollout
from lqd_envs.instances import (
    Instance,
    InstanceError,
    Obstacle,
    SceneChange,
    generate_instances,
)
from lqd_envs.scene import load_scene

FAUCET, DRAWER, PUSH = "LQD/Faucet-v0", "LQD/Drawer-v0", "LQD/Push-v0"
AWAY = Obstacle((0.3, 0.3, 0.05), (0.02, 0.02, 0.05))
# The mug's wall is 36 mm from its axis, at (0.5, 0).
BESIDE = Obstacle((0.5, -0.067, 0.04), (0.03, 0.03, 0.04))
INSIDE = Obstacle((0.5, -0.061, 0.04), (0.03, 0.03, 0.04))


@pytest.mark.parametrize(
    ("task_id", "obstacles", "number", "depth"),
    [
        (PUSH, (INSIDE,), 0, r"5\.\d"),
        (PUSH, (AWAY, INSIDE), 1, r"5\.\d"),
        (PUSH, (Obstacle((0.5, -0.064, 0.04), (0.03, 0.03, 0.04)), AWAY, INSIDE), 2, r"5\.\d"),
        (FAUCET, (Obstacle((0.5, 0.12, 0.14), (0.02, 0.02, 0.02)),), 0, r"\d+\.\d"),
        (DRAWER, (Obstacle((0.52, 0.0, 0.10), (0.02, 0.05, 0.10)),), 0, r"\d+\.\d"),
    ],
)
def test_obstacle_in_the_object_is_refused(task_id, obstacles, number, depth):
    instance = Instance(task_id, obstacles=obstacles)
    text = (
        rf"^Expected obstacles that do not touch the object at the start, but got "
        rf"obstacles\[{number}\], which is {depth} mm inside it; move it away, or make it small"
    )

    with pytest.raises(InstanceError, match=text):
        load_scene(instance.apply(get_task(task_id)))


def test_nothing_is_simulated_with_it():
    instance = Instance(PUSH, obstacles=(INSIDE,))
    with pytest.raises(InstanceError, match="which is 5"):
        rollout(instance.apply(get_task(PUSH)), np.zeros((0, 9)))
    with pytest.raises(InstanceError, match="which is 5"):
        gym.make(PUSH, instance=instance)
    with pytest.raises(InstanceError, match="which is 5"):
        gym.make_vec(PUSH, num_envs=1, instance=instance)


def test_object_that_is_moved_into_an_obstacle_is_refused():
    assert load_scene(Instance(PUSH, obstacles=(BESIDE,)).apply(get_task(PUSH)))
    moved = Instance(PUSH, obstacles=(BESIDE,), change=SceneChange(shift=(0.0, -0.01)))

    with pytest.raises(InstanceError, match=r"which is 9\.\d mm inside it"):
        load_scene(moved.apply(get_task(PUSH)))


@pytest.mark.parametrize("task_id", [task.id for task in PAPER_TASKS])
def test_drawn_obstacles_stay_clear(task_id):
    for instance in generate_instances(task_id, "obstacles", count=4, seed=11):
        assert load_scene(instance.apply(get_task(task_id))).sensors.sees_obstacles
