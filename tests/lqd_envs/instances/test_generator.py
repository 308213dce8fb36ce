import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lqd_envs import PAPER_TASKS, UnknownTaskError, get_task, rollout
from lqd_envs.instances import (
    KINDS,
    HeldPart,
    Instance,
    InstanceError,
    JointBand,
    drawn_obstacles,
    generate_instances,
)
from lqd_envs.instances.keep_out import KeepOut
from lqd_envs.scenes.faucet import TAP_RANGE

IDS = [task.id for task in PAPER_TASKS]

GOLDEN = {
    ("LQD/Grasp-v0", "predicate"): (
        ("grasp-predicate-8c4641a3", "00000011"),
        ("grasp-predicate-2b6f9e2f", "00000001"),
    ),
    ("LQD/Grasp-v0", "obstacles"): (
        ("grasp-obstacles-b9173efc", "00000000"),
        ("grasp-obstacles-3044196d", "01000000"),
    ),
    ("LQD/Grasp-v0", "approach"): (
        ("grasp-approach-fe60a136", "00010000"),
        ("grasp-approach-d8ca0b49", "00011000"),
    ),
    ("LQD/Grasp-v0", "change"): (
        ("grasp-change-834fa5ae", "00001000"),
        ("grasp-change-457d9f4f", "00011000"),
    ),
    ("LQD/Faucet-v0", "predicate"): (
        ("faucet-predicate-24b0414c", "00010000"),
        ("faucet-predicate-646b9aa5", "00010000"),
    ),
    ("LQD/Faucet-v0", "obstacles"): (
        ("faucet-obstacles-4801ee04", "00101111"),
        ("faucet-obstacles-8d4d6237", "00100111"),
    ),
    ("LQD/Faucet-v0", "approach"): (
        ("faucet-approach-f1ccd8e5", "00000000"),
        ("faucet-approach-562f18a8", "00000000"),
    ),
    ("LQD/Faucet-v0", "change"): (
        ("faucet-change-a6b3402e", "00111100"),
        ("faucet-change-4ca76027", "00111110"),
    ),
    ("LQD/Drawer-v0", "predicate"): (
        ("drawer-predicate-034b69a1", "00011000"),
        ("drawer-predicate-6d46d4ca", "00110000"),
    ),
    ("LQD/Drawer-v0", "obstacles"): (
        ("drawer-obstacles-a3ba7450", "11111111"),
        ("drawer-obstacles-385059bb", "11111111"),
    ),
    ("LQD/Drawer-v0", "approach"): (
        ("drawer-approach-42bd6545", "00000000"),
        ("drawer-approach-dbf7c244", "00010000"),
    ),
    ("LQD/Drawer-v0", "change"): (
        ("drawer-change-dc875bb4", "00000000"),
        ("drawer-change-bbf0f98d", "00000000"),
    ),
    ("LQD/Push-v0", "predicate"): (
        ("push-predicate-8558f809", "00000000"),
        ("push-predicate-c49de48a", "10000000"),
    ),
    ("LQD/Push-v0", "obstacles"): (
        ("push-obstacles-705aa090", "01011010"),
        ("push-obstacles-a6619a79", "10111111"),
    ),
    ("LQD/Push-v0", "approach"): (
        ("push-approach-2ad73d93", "00000110"),
        ("push-approach-55649f17", "01010000"),
    ),
    ("LQD/Push-v0", "change"): (
        ("push-change-b9acb599", "00010101"),
        ("push-change-113796e8", "01111101"),
    ),
}
"""First two instances of seed 0: name, and which of the solving motions solve it."""

FIRST = {
    ("LQD/Faucet-v0", "predicate"): (
        '{"approach": null, "change": null, "obstacles": [], "predicate": {"high": 0'
        '.878, "joint": "hot_tap", "kind": "joint_band", "low": 0.6615}, "task": "LQ'
        'D/Faucet-v0"}'
    ),
    ("LQD/Grasp-v0", "predicate"): (
        '{"approach": null, "change": null, "obstacles": [], "predicate": {"high": 0'
        '.0972, "kind": "held_part", "low": 0.0493, "part": "body"}, "task": "LQD/Gr'
        'asp-v0"}'
    ),
    ("LQD/Push-v0", "predicate"): (
        '{"approach": null, "change": null, "obstacles": [], "predicate": {"directio'
        'n": 0.1159, "farthest": 0.1346, "half_width": 0.4552, "kind": "moved_sector'
        '", "nearest": 0.0695}, "task": "LQD/Push-v0"}'
    ),
    ("LQD/Drawer-v0", "obstacles"): (
        '{"approach": null, "change": null, "obstacles": [{"half_size": [0.0671, 0.0'
        '512, 0.0114], "position": [0.5981, 0.142, 0.2614], "yaw": 0.5597}], "predic'
        'ate": null, "task": "LQD/Drawer-v0"}'
    ),
    ("LQD/Grasp-v0", "approach"): (
        '{"approach": {"direction": [-0.2105, 0.947, -0.2426], "half_angle": 0.8195}'
        ', "change": null, "obstacles": [], "predicate": null, "task": "LQD/Grasp-v0'
        '"}'
    ),
    ("LQD/Drawer-v0", "change"): (
        '{"approach": null, "change": {"contact_friction": 1.4851, "damping": 1.4158'
        ', "joint_friction": 1.8018, "mass": 1.3926, "shift": [-0.0198, -0.0199], "t'
        'urn": -0.3275}, "obstacles": [], "predicate": null, "task": "LQD/Drawer-v0"'
        "}"
    ),
}
"""Parameters of the first instance of seed 0."""


@pytest.mark.parametrize(("task_id", "kind"), GOLDEN)
def test_first_instances_and_who_solves_them(solving, task_id, kind):
    motions = solving(task_id)
    assert motions.success().all()
    found = generate_instances(task_id, kind, count=2, seed=0)

    solved = [
        rollout(instance.apply(motions.task), motions.solutions).success() for instance in found
    ]

    assert (
        tuple(
            (instance.name, "".join("01"[int(bit)] for bit in bits))
            for instance, bits in zip(found, solved, strict=True)
        )
        == GOLDEN[task_id, kind]
    )


@pytest.mark.parametrize(("task_id", "kind"), FIRST)
def test_parameters_of_the_first_instance(task_id, kind):
    (instance,) = generate_instances(task_id, kind, count=1, seed=0)

    assert instance == Instance.from_json(FIRST[task_id, kind])


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("task_id", IDS)
def test_the_seed_is_all_that_counts(task_id, kind):
    some = generate_instances(task_id, kind, count=6, seed=5)

    assert generate_instances(get_task(task_id), kind, count=6, seed=5) == some
    assert generate_instances(task_id, kind, count=3, seed=5) == some[:3]
    others = generate_instances(task_id, kind, count=6, seed=6)
    assert len({instance.name for instance in (*some, *others)}) == 12


def test_tasks_have_streams_of_their_own():
    first, second = (
        generate_instances(task_id, "approach", count=1, seed=0) for task_id in IDS[:2]
    )

    assert first[0].approach != second[0].approach


@settings(deadline=None, derandomize=True, max_examples=60)
@given(task_id=st.sampled_from(IDS), kind=st.sampled_from(list(KINDS)), seed=st.integers(0, 2**40))
def test_drawn_instances_have_one_part_and_fit_their_task(task_id, kind, seed):
    (instance,) = generate_instances(task_id, kind, count=1, seed=seed)

    assert instance.kind == kind
    assert instance.task == task_id
    assert Instance.from_json(instance.to_json()) == instance
    instance.apply(get_task(task_id))


@settings(deadline=None, derandomize=True, max_examples=60)
@given(task_id=st.sampled_from(IDS), seed=st.integers(0, 2**40))
def test_ranges_of_changes(task_id, seed):
    change = generate_instances(task_id, "change", count=1, seed=seed)[0].change

    assert math.hypot(*change.shift) <= 0.03 + 1e-4
    assert abs(change.turn) <= math.radians(20) + 1e-4
    for scale in (change.contact_friction, change.mass, change.joint_friction, change.damping):
        assert 0.5 <= scale <= 2.0
    if not get_task(task_id).schema.joints:
        assert change.joint_friction == change.damping == 1.0


@settings(deadline=None, derandomize=True, max_examples=60)
@given(task_id=st.sampled_from(IDS), seed=st.integers(0, 2**40))
def test_ranges_of_obstacles(task_id, seed):
    center = get_task(task_id).center
    obstacles = generate_instances(task_id, "obstacles", count=1, seed=seed)[0].obstacles

    assert 1 <= len(obstacles) <= 3
    for obstacle in obstacles:
        bottom = obstacle.position[2] - obstacle.half_size[2]
        assert bottom == pytest.approx(0.0, abs=1e-9) or 0.05 - 1e-3 < bottom < 0.30 + 1e-3
        assert math.dist(obstacle.position[:2], center[:2]) <= 0.25 + 1e-3


@settings(deadline=None, derandomize=True, max_examples=60)
@given(seed=st.integers(0, 2**40))
def test_ranges_of_predicates(seed):
    tap, part, opening, sector = (
        generate_instances(f"LQD/{name}-v0", "predicate", count=1, seed=seed)[0].predicate
        for name in ("Faucet", "Grasp", "Drawer", "Push")
    )

    assert isinstance(part, HeldPart)
    assert 0.03 - 1e-3 < part.high - part.low < 0.06 + 1e-3
    assert isinstance(tap, JointBand)
    if tap.joint == "hot_tap":
        assert 0.314 - 1e-4 <= tap.low < tap.high <= TAP_RANGE + 1e-4
    else:
        assert (tap.joint, tap.low) == ("cold_tap", 0.0)
    assert 0.10 <= opening.low < opening.high <= 0.20
    assert sector.nearest >= 0.05


@pytest.mark.parametrize("task_id", IDS)
def test_approach_is_neither_always_nor_never_met_by_random_valid_motions(motions_of, task_id):
    motions = motions_of(task_id)
    columns = motions.columns.rows(np.flatnonzero(motions.valid))
    for instance in generate_instances(task_id, "approach", count=50, seed=7):
        assert 0.0 < instance.approach.holds(columns).mean() < 0.7


def test_errors():
    with pytest.raises(InstanceError, match="'luck'; choose one of predicate, obstacles, approach"):
        generate_instances("LQD/Push-v0", "luck", count=1, seed=0)
    with pytest.raises(InstanceError, match=r"\['change'\]; choose one of predicate, obstacles"):
        generate_instances("LQD/Push-v0", ["change"], count=1, seed=0)
    for count, seed in ((-1, 0), (1.5, 0), (True, 0), (1, "0"), (1, -3), (1, 0.0)):
        with pytest.raises(
            InstanceError,
            match=rf"whole numbers of at least 0, but got {count!r} and {seed!r}; choose",
        ):
            generate_instances("LQD/Push-v0", "change", count=count, seed=seed)


def test_numbers_of_numpy_are_numbers():
    drawn = generate_instances("LQD/Push-v0", "change", count=np.int64(2), seed=np.uint8(3))

    assert drawn == generate_instances("LQD/Push-v0", "change", count=2, seed=3)


def test_predicates_are_those_of_the_paper_s_tasks_alone():
    other = replace(get_task("LQD/Grasp-v0"), id="Home/Faucet-v0")

    with pytest.raises(InstanceError, match="paper's tasks to draw a predicate for, but got Home/"):
        generate_instances(other, "predicate", count=1, seed=0)


def test_where_there_is_no_room_for_a_box_that_is_said(monkeypatch):
    # Wider and taller than all that is drawn.
    everywhere = KeepOut(low=np.full((1, 3), -1.0), high=np.full((1, 3), 1.0))
    monkeypatch.setattr(drawn_obstacles, "keep_out_of", lambda _: everywhere)

    with pytest.raises(InstanceError, match="room for a box around the object of LQD/Push-v0, but"):
        generate_instances("LQD/Push-v0", "obstacles", count=1, seed=0)
    with pytest.raises(UnknownTaskError):
        generate_instances("LQD/Sing-v0", "change", count=1, seed=0)
