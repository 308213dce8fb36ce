import pickle
from dataclasses import asdict, replace

import numpy as np
import pytest

from lqd_envs import get_task, rollout
from lqd_envs.instances import (
    ApproachLimit,
    HeldPart,
    Instance,
    InstanceError,
    JointBand,
    MovedSector,
    Obstacle,
    SceneChange,
    generate_instances,
)
from lqd_envs.scene import load_scene

FAUCET, GRASP, PUSH = "LQD/Faucet-v0", "LQD/Grasp-v0", "LQD/Push-v0"
BOX = Obstacle((0.4, 0.2, 0.1), (0.02, 0.03, 0.1), 0.5)
EVERYTHING = Instance(
    FAUCET,
    predicate=JointBand("hot_tap", 0.5, 1.0),
    obstacles=(BOX, Obstacle((0.4, -0.2, 0.1), (0.02, 0.03, 0.1))),
    approach=ApproachLimit((0.0, 0.0, -1.0), 0.7),
    change=SceneChange((0.01, -0.02), 0.1, mass=2.0),
)
INSTANCES = [
    Instance(FAUCET),
    EVERYTHING,
    Instance(GRASP, predicate=HeldPart("rim", 0.01, 0.08)),
    Instance(PUSH, predicate=MovedSector(1.0, 0.5, 0.05, 0.1)),
    Instance(PUSH, obstacles=[BOX]),
]


@pytest.mark.parametrize("instance", INSTANCES, ids=lambda instance: instance.name)
def test_round_trips(instance):
    for copy in (
        Instance.from_json(instance.to_json()),
        Instance.from_dict(instance.to_dict()),
        Instance.from_dict(asdict(instance)),
        pickle.loads(pickle.dumps(instance)),
    ):
        assert copy == instance
        assert hash(copy) == hash(instance)
        assert copy.name == instance.name
        assert copy.to_json() == instance.to_json()


def test_names_say_what_it_is_and_tell_instances_apart():
    assert [instance.kind for instance in INSTANCES] == [
        "plain",
        "predicate+obstacles+approach+change",
        "predicate",
        "predicate",
        "obstacles",
    ]
    assert EVERYTHING.name.startswith("faucet-predicate+obstacles+approach+change-")
    assert len({instance.name for instance in INSTANCES}) == len(INSTANCES)
    assert INSTANCES[-1].name == "push-obstacles-194d2c12"


def test_equal_numbers_make_equal_names():
    some = Instance(PUSH, obstacles=[Obstacle([0, -0.0, 1], np.array([1, 0.5, 1]))])
    other = Instance(PUSH, obstacles=(Obstacle((0.0, 0.0, 1.0), (1.0, 0.5, 1.0), -0.0),))

    assert some == other
    assert some.name == other.name


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "an instance as JSON, but got text that is none"),
        ("[]", r"an instance as a dictionary, but got \[\]"),
        ("{}", "an instance with the keys task, but they are missing"),
        ('{"task": 3}', "`task` to be the id of a task, but got 3"),
        ('{"task": "x", "speed": 3}', "but got speed; remove"),
        ('{"task": "x", "obstacles": 3}', "`obstacles` to be a list of boxes, but got 3"),
        ('{"task": "x", "obstacles": [{}]}', "an obstacle with the keys position, half_size"),
        ('{"task": "x", "predicate": {}}', "one of joint_band, moved_sector, held_part"),
        ('{"task": "x", "predicate": {"kind": "luck"}}', "one of joint_band"),
        ('{"task": "x", "predicate": {"kind": "held_part", "part": "lid"}}', "'lid'"),
        ('{"task": "x", "predicate": {"kind": "joint_band", "joint": "a"}}', "keys low, high"),
        ('{"task": "x", "change": {"mass": 0}}', "`mass` to be a number from 0.01 to 100, but"),
        ('{"task": "x", "change": {"shift": [0.2, 0]}}', "each number of `shift`"),
        ('{"task": "x", "predicate": {"kind": ["held_part"]}}', "one of joint_band"),
        ('{"task": "x", "predicate": {"kind": "held_part", "part": ["rim"]}}', r"got \['rim'\]"),
        (
            '{"task": "x", "predicate": '
            '{"kind": "joint_band", "joint": ["a"], "low": 0, "high": 1}}',
            r"`joint` to be the name of a joint, but got \['a'\]",
        ),
        ('{"task": "x", "obstacles": {}}', "`obstacles` to be a list of boxes, but got {}"),
        ('{"task": "x", "obstacles": false}', "`obstacles` to be a list of boxes, but got False"),
        pytest.param("[" * 100_000, "an instance as JSON, but got text that is none", id="deep"),
        ('{"task": "x", "approach": {"direction": 1, "half_angle": 1}}', "`direction` to be 3"),
    ],
)
def test_what_is_no_instance(text, message):
    with pytest.raises(InstanceError, match=message):
        Instance.from_json(text)


def test_task_must_be_its_own_and_must_fit():
    with pytest.raises(InstanceError, match="an instance of LQD/Push-v0, but got one of LQD/F"):
        EVERYTHING.apply(get_task(PUSH))
    with pytest.raises(InstanceError, match="its joints are: none"):
        Instance(PUSH, predicate=JointBand("drawer", 0.1, 0.2)).apply(get_task(PUSH))


@pytest.mark.parametrize("first", [EVERYTHING, Instance(FAUCET, predicate=EVERYTHING.predicate)])
def test_an_instance_is_applied_to_the_task_itself(first):
    varied = first.apply(get_task(FAUCET))

    with pytest.raises(InstanceError, match=f"Expected {FAUCET} itself, but got .*parts of both"):
        EVERYTHING.apply(varied)


def test_plain_instance_is_the_task_itself():
    assert Instance(FAUCET).apply(get_task(FAUCET)) is get_task(FAUCET)


def test_applied_task_is_equal_each_time_and_keeps_id_schema_and_centre():
    task = get_task(FAUCET)
    varied = EVERYTHING.apply(task)

    assert varied == Instance.from_json(EVERYTHING.to_json()).apply(task) != task
    assert (varied.id, varied.schema, varied.center) == (task.id, task.schema, task.center)
    assert pickle.loads(pickle.dumps(varied)) == varied


def test_scene_is_compiled_once_and_shared_where_it_is_the_task_s():
    task = get_task(FAUCET)
    banded = Instance(FAUCET, predicate=JointBand("hot_tap", 0.5, 1.0)).apply(task)

    assert load_scene(EVERYTHING.apply(task)) is load_scene(EVERYTHING.apply(task))
    assert load_scene(EVERYTHING.apply(task)).model is not load_scene(task).model
    assert load_scene(banded).model is load_scene(task).model
    assert load_scene(banded).task == banded


@pytest.mark.parametrize("kind", ["predicate", "approach"])
@pytest.mark.parametrize("task_id", [FAUCET, GRASP, PUSH, "LQD/Drawer-v0"])
def test_judging_simulated_motions_is_the_same_as_simulating_them_again(solving, task_id, kind):
    motions = solving(task_id)
    instances = generate_instances(task_id, kind, count=20, seed=3)
    solved = [instance.solved_by(motions) for instance in instances]
    for instance, expected in list(zip(instances, solved, strict=True))[:3]:
        again = rollout(instance.apply(get_task(task_id)), motions.solutions[:4])
        assert again.success().tolist() == expected[:4].tolist()

    assert np.any(solved)
    assert not np.all(solved)


def test_a_motion_that_failed_or_did_not_succeed_solves_nothing(motions_of):
    motions = motions_of(FAUCET)
    anyhow = Instance(FAUCET, approach=ApproachLimit((0.0, 0.0, -1.0), 3.1))

    assert anyhow.solved_by(motions).tolist() == motions.success().tolist()
    assert not anyhow.solved_by(motions)[~motions.valid].any()


def test_other_dynamics_cannot_be_judged_without_simulating(solving):
    motions = solving(PUSH)
    for instance in (Instance(PUSH, obstacles=[BOX]), Instance(PUSH, change=SceneChange())):
        with pytest.raises(InstanceError, match="without obstacles and changes, but got push-"):
            instance.solved_by(motions)
    sector = Instance(PUSH, predicate=MovedSector(1.0, 0.5, 0.05, 0.1))
    with pytest.raises(InstanceError, match="simulated in the task itself"):
        sector.solved_by(replace(motions, task=sector.apply(motions.task)))
    with pytest.raises(InstanceError, match="an instance of LQD/Push-v0, but got one of LQD/F"):
        Instance(FAUCET).solved_by(motions)
