import copy
import sys
from dataclasses import replace

import numpy as np
import pytest

from lqd_envs import (
    TASKS,
    LQDError,
    MotionPlan,
    SolutionError,
    UnknownTaskError,
    Verdict,
    plan_motions,
    rollout,
)
from lqd_envs.motion import plan_in_scene
from lqd_envs.rollout import simulate
from lqd_envs.scenes.panda import HOME

COLUMNS = (
    "object_position",
    "object_orientation",
    "object_table_contact",
    "robot_table_contact",
    "gripper_position",
    "gripper_orientation",
    "gripper_contacts",
    "joint_positions",
)

# Moments of the turning motion: gripper position, gripper orientation, angle of the hot tap.
GOLDEN = {
    0: (
        (0.5072202758366428, 0.06804091563311182, 0.13508333592731242),
        (0.4700529623681622, -0.8300883642625753, 2.4100424149360435),
        0.0,
    ),
    40: (
        (0.49763637045478376, 0.04093843705250313, 0.13929326509555834),
        (0.3716444755326884, -0.778143625337042, 2.4735744188991813),
        0.579162342505349,
    ),
    50: (
        (0.4791186920291957, 0.03287671440997078, 0.14048019138602452),
        (0.28376707511146515, -0.7735452189456424, 2.5234636967426263),
        1.5458427524516445,
    ),
    75: (
        (0.4732092887693283, 0.033348074171644364, 0.13654947937245837),
        (0.13617452771491156, -0.7438213916206751, 2.541740983200709),
        1.6052329873151614,
    ),
}


# One success of each other task: solution, and at its end object position, gripper position, joint.
GOLDEN_ENDS = {
    "LQD/Grasp-v0": (
        (0.03, 0.22, 0.36, 0.65, -0.27, -2.44, 0.92, -0.08, 0.13),
        (0.7215288638999268, -0.044582381870485153, 0.03793951151727136),
        (0.6834874545447642, 0.005348558807862655, 0.09927573502942132),
        (),
    ),
    "LQD/Push-v0": (
        (-0.84, -0.23, -0.08, -1.15, 1.34, 2.39, 0.52, 0.3, 0.28),
        (0.5683815454874512, 0.031739697501886356, -3.348576882340577e-05),
        (0.5192413382785285, 0.036516545816911314, 0.08723508553818786),
        (),
    ),
    "LQD/Drawer-v0": (
        (-0.6, -0.27, -0.09, -1.36, -0.71, 2.65, -0.89, 0.03, 0.13),
        (0.68, 0.0, 0.0),
        (0.31300105922712884, -0.025747455553005144, 0.12092726355198917),
        (0.18937328697084613,),
    ),
}


def assert_same_rows(some, rows, every):
    """Check that `some` are the `rows` of `every`, bit for bit."""
    assert some.verdicts.tolist() == every.verdicts[rows].tolist()
    for column in COLUMNS:
        assert (
            getattr(some.columns, column).tobytes()
            == getattr(every.columns, column)[rows].tobytes()
        )


@pytest.mark.parametrize("threads", [1, 2])
def test_same_bits_at_any_number_of_threads(faucet, solutions, trajectories, threads):
    again = rollout(faucet, solutions, threads=threads)

    assert_same_rows(again, slice(None), trajectories)


@pytest.mark.parametrize("rows", [slice(7, 8), slice(0, 60, 7), slice(50, 20, -1)])
def test_same_bits_whatever_the_other_rows(faucet, solutions, trajectories, rows):
    assert_same_rows(rollout(faucet, solutions[rows]), rows, trajectories)


def test_same_bits_in_chunks(monkeypatch, scene, solutions, trajectories):
    # By `sys.modules`, since the package's attribute of this name is the function.
    monkeypatch.setattr(sys.modules["lqd_envs.rollout"], "_CHUNK", 9)

    again = simulate(scene, solutions, trajectories.plan)

    assert_same_rows(again, slice(None), trajectories)


def test_task_is_found_by_its_id(solutions, trajectories):
    rows = slice(0, 5)

    assert_same_rows(rollout("LQD/Faucet-v0", solutions[rows]), rows, trajectories)


def test_motion_that_turns_on_the_hot_water(turning):
    infos = turning.infos(0)

    assert turning.verdicts.tolist() == [Verdict.VALID]
    assert turning.success().tolist() == [True]
    for moment, (position, orientation, angle) in GOLDEN.items():
        info = infos[moment]
        # Rounding 1e-13 apart at the start stays below 1e-12, so another machine is within 1e-6.
        assert info["gripper_position"] == pytest.approx(position, rel=1e-6)
        assert info["gripper_orientation"] == pytest.approx(orientation, rel=1e-6)
        assert info["joint_positions"]["hot_tap"] == pytest.approx(angle, rel=1e-6, abs=1e-9)
        assert info["joint_positions"]["cold_tap"] == pytest.approx(0.0, abs=1e-9)
    assert [info["gripper_contacts"]["hot_tap"] for info in infos[::25]] == [
        False,
        True,
        True,
        True,
    ]


@pytest.mark.parametrize("task_id", GOLDEN_ENDS)
def test_motion_that_does_the_task(task_id):
    solution, object_position, gripper_position, joints = GOLDEN_ENDS[task_id]
    trajectories = rollout(task_id, np.array([solution]))
    end = trajectories.infos(0)[-1]

    assert trajectories.success().tolist() == [True]
    # A start 1e-10 m apart ends within 2e-9, so another machine is within 1e-6.
    assert end["object_position"] == pytest.approx(object_position, abs=1e-6)
    assert end["gripper_position"] == pytest.approx(gripper_position, abs=1e-6)
    assert tuple(end["joint_positions"].values()) == pytest.approx(joints, abs=1e-6)


def test_verdicts_of_random_solutions(trajectories):
    counts = {
        verdict: int(np.sum(trajectories.verdicts == verdict)) / len(trajectories)
        for verdict in Verdict
    }

    assert 0.02 < counts[Verdict.UNREACHABLE] < 0.2
    assert 0.25 < counts[Verdict.OVERLAPPING] < 0.6
    assert 0.35 < counts[Verdict.VALID] < 0.65
    assert sum(counts[v] for v in Verdict if v.discarded) < 0.05


def test_rejected_rows_are_blank(trajectories):
    rejected = ~trajectories.simulated

    assert rejected.any()
    for column in COLUMNS:
        assert not getattr(trajectories.columns, column)[rejected].any()


def test_columns_have_their_documented_shapes(trajectories):
    n = len(trajectories)
    shapes = {column: getattr(trajectories.columns, column).shape for column in COLUMNS}

    assert shapes == {
        "object_position": (n, 76, 3),
        "object_orientation": (n, 76, 3),
        "object_table_contact": (n, 76),
        "robot_table_contact": (n, 76),
        "gripper_position": (n, 76, 3),
        "gripper_orientation": (n, 76, 3),
        "gripper_contacts": (n, 76, 3),
        "joint_positions": (n, 76, 2),
    }
    assert all(np.isfinite(getattr(trajectories.columns, column)).all() for column in COLUMNS)


def test_no_solutions_give_no_trajectories(faucet):
    nothing = rollout(faucet, np.zeros((0, 9)))

    assert len(nothing) == 0
    assert nothing.success().shape == (0,)
    assert nothing.ground_truth().shape == (0, 1)
    assert nothing.digests().shape == (0,)


def test_only_rejected_solutions_are_fine(faucet, solutions, trajectories):
    rows = np.flatnonzero(~trajectories.simulated)[:3]

    assert_same_rows(rollout(faucet, solutions[rows]), rows, trajectories)


@pytest.fixture
def from_home(scene):
    """One motion made by hand: from above the table, everything stays where it is."""
    starts = np.array([HOME])
    action = scene.action_map.actions(starts, finger_target=np.full(1, 0.04))
    return MotionPlan(
        verdicts=np.array([Verdict.VALID], dtype=np.uint8),
        starts=starts,
        actions=np.repeat(action[:, None], 75, axis=1),
    )


@pytest.fixture
def with_spring(scene):
    """A function that gives a scene whose hot tap a spring opens."""

    def make(stiffness):
        model = copy.copy(scene.physics)
        joint = model.joint("hot_tap")
        model.jnt_stiffness[joint.id] = stiffness
        model.qpos_spring[joint.qposadr[0]] = 2.0
        return replace(scene, physics=model)

    return make


def test_calm_motion_is_valid(scene, from_home):
    calm = simulate(scene, np.zeros((1, 9)), from_home)

    assert calm.verdicts.tolist() == [Verdict.VALID]
    assert not calm.columns.joint_positions.any()


@pytest.fixture
def dive(from_home):
    """The same start, but the arm pushes its hand down onto the faucet."""
    actions = from_home.actions.copy()
    actions[:, :, 1] = 1.0
    return replace(from_home, actions=actions)


def test_push_that_the_object_withstands_is_valid(scene, dive):
    pushed = simulate(scene, np.zeros((1, 9)), dive)

    assert pushed.verdicts.tolist() == [Verdict.VALID]
    assert pushed.columns.gripper_contacts[0, -1].any()


def test_push_into_something_too_soft_is_discarded(scene, dive):
    model = copy.copy(scene.physics)
    model.geom_solref[:] = (0.2, 1.0)

    pushed = simulate(replace(scene, physics=model), np.zeros((1, 9)), dive)

    assert pushed.verdicts.tolist() == [Verdict.PENETRATING]
    assert pushed.columns.gripper_contacts[0, -1].any()
    assert len(pushed.infos(0)) == 76


def test_tap_that_flies_open_is_discarded(with_spring, from_home):
    flight = simulate(with_spring(10.0), np.zeros((1, 9)), from_home)

    assert flight.verdicts.tolist() == [Verdict.TOO_FAST]
    # The expert would approve of it: that it was discarded must win.
    assert flight.columns.joint_positions[0, -1, 0] > 0.314
    assert flight.success().tolist() == [False]
    assert np.isnan(flight.ground_truth()).all()


def test_tap_that_opens_gently_is_valid(with_spring, from_home):
    gentle = simulate(with_spring(0.12), np.zeros((1, 9)), from_home)

    assert gentle.verdicts.tolist() == [Verdict.VALID]
    assert gentle.columns.joint_positions[0, -1, 0] > 0.1


def test_simulation_that_diverges_is_discarded(monkeypatch, tmp_path, with_spring, from_home):
    monkeypatch.chdir(tmp_path)  # where MuJoCo writes its log

    divergent = simulate(with_spring(1e12), np.zeros((1, 9)), from_home)

    assert divergent.verdicts.tolist() == [Verdict.DIVERGED]
    assert all(np.isfinite(getattr(divergent.columns, column)).all() for column in COLUMNS)
    assert divergent.success().tolist() == [False]


def test_divergence_of_one_leaves_the_others_alone(monkeypatch, tmp_path, scene, solutions):
    monkeypatch.chdir(tmp_path)
    plan = plan_in_scene(scene, solutions[:30])
    rows = np.flatnonzero(plan.verdicts == Verdict.VALID)
    starts = plan.starts.copy()
    starts[rows[0], 0] = 1e30

    calm = simulate(scene, solutions[:30], plan)
    mixed = simulate(scene, solutions[:30], replace(plan, starts=starts))

    assert mixed.verdicts[rows[0]] == Verdict.DIVERGED
    for column in COLUMNS:
        values = getattr(mixed.columns, column)[rows[1:]]
        assert values.tobytes() == getattr(calm.columns, column)[rows[1:]].tobytes()
    assert mixed.verdicts[rows[1:]].tolist() == calm.verdicts[rows[1:]].tolist()


def test_unknown_task_names_the_known_ones():
    with pytest.raises(UnknownTaskError) as caught:
        rollout("LQD/Kettle-v0", np.zeros((1, 9)))

    assert str(caught.value) == (
        f"expected the id of a task, got 'LQD/Kettle-v0': known tasks are {', '.join(TASKS)}"
    )
    assert isinstance(caught.value, LQDError)
    assert isinstance(caught.value, KeyError)


@pytest.mark.parametrize(
    ("solutions", "text"),
    [
        (np.zeros((3, 8)), r"expected solutions of shape \(n, 9\), got \(3, 8\)"),
        (np.full((1, 9), 1e300), r"expected feasible solutions, got 1 that are not, .*\.repair"),
        (np.full((1, 9), np.nan), r"expected finite numbers, got nan for x of solution 0"),
    ],
)
def test_wrong_solutions_are_refused(faucet, solutions, text):
    with pytest.raises(SolutionError, match=text):
        rollout(faucet, solutions)


@pytest.mark.parametrize("simulated", [rollout, plan_motions])
@pytest.mark.parametrize("threads", [-1, "a", 1.5])
def test_threads_are_a_whole_number_from_0_on(simulated, threads):
    with pytest.raises(LQDError, match="expected threads to be a whole number"):
        simulated("LQD/Faucet-v0", np.zeros((0, 9)), threads=threads)
