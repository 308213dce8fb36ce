import math
from dataclasses import replace

import numpy as np
import pytest

from lqd_envs import Info, LQDError, Trajectories, Verdict, rollout

KEYS = tuple(Info.__annotations__)
DISCARDS = [verdict for verdict in Verdict if verdict.discarded]


@pytest.fixture(scope="module")
def row(trajectories):
    """A motion that was simulated and touches the object."""
    touching = trajectories.columns.gripper_contacts.any(axis=(1, 2)) & trajectories.valid
    return int(np.flatnonzero(touching)[0])


@pytest.fixture
def infos(trajectories, row):
    return trajectories.infos(row)


def test_motion_has_76_infos_of_eight_keys(infos):
    assert len(infos) == 76
    assert len(KEYS) == 8
    assert all(tuple(info) == KEYS for info in infos)


@pytest.mark.parametrize(
    "key", ["object_position", "object_orientation", "gripper_position", "gripper_orientation"]
)
def test_vectors_are_tuples_of_three_plain_floats(infos, key):
    assert {type(info[key]) for info in infos} == {tuple}
    assert {len(info[key]) for info in infos} == {3}
    assert {type(number) for info in infos for number in info[key]} == {float}
    assert all(math.isfinite(number) for info in infos for number in info[key])


@pytest.mark.parametrize("key", ["object_table_contact", "robot_table_contact"])
def test_flags_are_plain_bools(infos, key):
    assert {type(info[key]) for info in infos} == {bool}


def test_dictionaries_hold_plain_values_under_the_names_of_the_task(infos):
    assert {tuple(info["gripper_contacts"]) for info in infos} == {("base", "hot_tap", "cold_tap")}
    assert {tuple(info["joint_positions"]) for info in infos} == {("hot_tap", "cold_tap")}
    assert {type(v) for info in infos for v in info["gripper_contacts"].values()} == {bool}
    assert {type(v) for info in infos for v in info["joint_positions"].values()} == {float}


def test_nothing_mutable_is_shared(trajectories, row, infos):
    again = trajectories.infos(row)
    everything = [*infos, *again]
    dictionaries = [
        d for info in everything for d in (info, info["gripper_contacts"], info["joint_positions"])
    ]
    assert len({id(d) for d in dictionaries}) == len(dictionaries)

    for d in (infos[0], infos[0]["gripper_contacts"], infos[0]["joint_positions"]):
        d.clear()

    assert trajectories.infos(row) == again


def test_infos_are_the_columns(trajectories, row, infos):
    columns = trajectories.columns

    for moment, info in enumerate(infos):
        assert info["gripper_position"] == tuple(columns.gripper_position[row, moment])
        assert info["object_position"] == tuple(columns.object_position[row, moment])
        assert info["gripper_contacts"]["hot_tap"] == columns.gripper_contacts[row, moment, 1]
        assert info["joint_positions"]["hot_tap"] == columns.joint_positions[row, moment, 0]
        assert info["robot_table_contact"] == columns.robot_table_contact[row, moment]


def test_fixed_object_touches_the_table_and_stands_still(infos):
    assert all(info["object_table_contact"] is True for info in infos)
    assert {info["object_position"] for info in infos} == {(0.5, 0.0, 0.0)}
    assert {info["object_orientation"] for info in infos} == {(0.0, 0.0, 0.0)}


@pytest.mark.parametrize("verdict", [Verdict.UNREACHABLE, Verdict.OVERLAPPING])
def test_rejected_motion_has_no_infos(trajectories, verdict):
    i = int(np.flatnonzero(trajectories.verdicts == verdict)[0])

    with pytest.raises(LQDError) as caught:
        trajectories.infos(i)

    assert str(caught.value) == (
        f"expected a motion that was simulated, got motion {i}, which was rejected as "
        f"{verdict.name.lower()}: ask only for motions whose verdict is not a rejection"
    )


def test_valid_and_simulated(trajectories):
    every = replace(
        trajectories,
        solutions=trajectories.solutions[:6],
        verdicts=np.array(list(Verdict), dtype=np.uint8),
    )

    assert len(every) == 6
    assert every.valid.tolist() == [True, False, False, False, False, False]
    assert every.simulated.tolist() == [True, False, False, True, True, True]


def test_verdicts_are_valid_rejected_or_discarded():
    assert [v for v in Verdict if v.rejected] == [Verdict.UNREACHABLE, Verdict.OVERLAPPING]
    assert [v for v in Verdict if not v.rejected and not v.discarded] == [Verdict.VALID]


def test_success_and_ground_truth_agree_with_the_columns(trajectories, turning):
    for some in (trajectories, turning):
        angle = some.columns.joint_positions[:, -1, 0]

        assert np.array_equal(some.success(), some.valid & (angle >= 0.314))
        assert some.success().dtype == np.bool_
        # The stop of a tap yields a little under the arm's push.
        expected = np.where(some.valid, np.minimum(angle, 2 * math.pi / 3), np.nan)[:, None]
        assert np.array_equal(some.ground_truth(), expected, equal_nan=True)


def test_turning_motion_is_in_its_cell(turning, faucet):
    angle = turning.infos(0)[-1]["joint_positions"]["hot_tap"]

    cell = faucet.ground_truth.cells(turning.ground_truth())

    assert cell.tolist() == [int(angle / (2 * math.pi / 3) * 100)]


@pytest.mark.parametrize("verdict", [v for v in Verdict if v != Verdict.VALID])
def test_motion_that_failed_is_no_success(turning, verdict):
    failed = replace(turning, verdicts=np.array([verdict], dtype=np.uint8))

    assert failed.success().tolist() == [False]
    assert np.isnan(failed.ground_truth()).tolist() == [[True]]


@pytest.mark.parametrize("verdict", DISCARDS)
def test_discarded_motion_can_be_looked_at(turning, verdict):
    discarded = replace(turning, verdicts=np.array([verdict], dtype=np.uint8))

    assert discarded.infos(0) == turning.infos(0)
    assert discarded.digests().tolist() == turning.digests().tolist()


def test_digests_are_equal_where_infos_are(faucet, solutions, trajectories):
    rows = np.flatnonzero(trajectories.simulated)[[0, 1, 0, 2, 1]]

    repeated = rollout(faucet, solutions[rows])

    digests = repeated.digests()
    assert digests.dtype == np.uint64
    assert digests.tolist() == trajectories.digests()[rows].tolist()
    for i in range(5):
        for j in range(5):
            same = repeated.infos(i) == repeated.infos(j)
            assert (digests[i] == digests[j]) == same == (rows[i] == rows[j])


def test_digests_of_a_batch(trajectories):
    digests = trajectories.digests()

    assert not digests[~trajectories.simulated].any()
    assert len(set(digests[trajectories.simulated].tolist())) == trajectories.simulated.sum()


@pytest.mark.parametrize("column", KEYS)
@pytest.mark.parametrize("moment", [0, 75])
def test_digest_sees_every_bit(turning, column, moment):
    changed = getattr(turning.columns, column).copy()
    view = changed.view(np.uint8)
    view[(0, moment) + (0,) * (view.ndim - 2)] ^= 1
    other = replace(turning, columns=replace(turning.columns, **{column: changed}))
    assert isinstance(other, Trajectories)

    assert other.digests() != turning.digests()
