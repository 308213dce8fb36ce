import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lqd_llm.sandbox import CheckedSource, SandboxError
from lqd_llm.sandbox.decode import decode
from lqd_llm.sandbox.functions import SandboxedFunction
from lqd_llm.sandbox.reasons import Reason
from lqd_llm.sandbox.record_check import (
    check_counts,
    check_definitions,
    check_header,
    check_records,
)
from lqd_llm.sandbox.roles import Role
from lqd_llm.sandbox.wire import MAGIC, RECORD, VERSION, Status, Word, slots_of

ROLES = list(Role)
FUNCTIONS = [SandboxedFunction(str(role), role, CheckedSource("", "entry")) for role in ROLES]
SLOTS = slots_of(ROLES)
SLOT_ROLES = [ROLES[slot.function] for slot in SLOTS]
MOMENTS = 76


def header(**words):
    told = {"MAGIC": MAGIC, "VERSION": VERSION, "DONE": 5, "STATUS": Status.WORKING, **words}
    array = np.zeros(16, np.uint64)
    for word, number in told.items():
        array[Word[word]] = number
    return array


def accepted():
    """Records of two motions, as a worker writes them."""
    records = np.zeros((2, len(SLOTS)), RECORD)
    records["reason"], records["length"] = Reason.ACCEPTED, 1
    for k, role in enumerate(SLOT_ROLES):
        if role in (Role.QUANTITY, Role.DESCRIPTOR):
            records["length"][:, k] = 3
    return records


def checked(records):
    check_records(records, roles=SLOT_ROLES, dropped=[False] * len(SLOTS), moments=MOMENTS)
    return decode(
        records, functions=FUNCTIONS, slots=SLOTS, lengths={}, dropped=(), dropped_before={}
    )


def test_a_header_of_ours_is_read():
    assert check_header(header(), start=2, motions=9) == (5, Status.WORKING)
    check_counts(header(FUNCTIONS=3, SLOTS=4), functions=3, slots=4)


@pytest.mark.parametrize(
    "words",
    [{"MAGIC": 1}, {"VERSION": 2}, {"DONE": 1}, {"DONE": 10}, {"DONE": 2**64 - 1}, {"STATUS": 9}],
)
def test_another_header_is_refused(words):
    with pytest.raises(SandboxError, match="its results are not used"):
        check_header(header(**words), start=2, motions=9)


def test_another_number_of_functions_is_refused():
    with pytest.raises(SandboxError, match="wrote 3 functions and 5 slots"):
        check_counts(header(FUNCTIONS=3, SLOTS=5), functions=3, slots=4)


def test_records_of_ours_are_read():
    results = checked(accepted())
    assert results.moments["timestamp"].tolist() == [0, 0]
    assert results.refusals == ()


@pytest.mark.parametrize(
    ("role", "field", "value", "words"),
    [
        (Role.SUCCESS, "numbers", 0.5, "a success other than true and false"),
        (Role.SUCCESS, "reason", Reason.NOT_TUPLE, "the reason 8 for a success"),
        (Role.FITNESS, "numbers", np.inf, "numbers that are not finite"),
        (Role.FITNESS, "numbers", -sys.float_info.max, "a fitness as large as no mean may be"),
        (Role.FITNESS, "length", 2, "a fitness of another length"),
        (Role.TIMESTAMP, "numbers", 76.0, "a moment that there is not"),
        (Role.TIMESTAMP, "numbers", -1.0, "a moment that there is not"),
        (Role.TIMESTAMP, "numbers", 0.5, "a moment that there is not"),
        (Role.QUANTITY, "length", 6, "a quantity of another length"),
        (Role.QUANTITY, "length", -1, "a quantity of another length"),
        (Role.DESCRIPTOR, "numbers", np.nan, "numbers that are not finite"),
        (Role.DESCRIPTOR, "reason", Reason.UNWRITTEN, "the reason 0 for a descriptor"),
        (Role.DESCRIPTOR, "reason", Reason.DROPPED, "the reason 4 for a descriptor"),
        (Role.DESCRIPTOR, "reason", 60_000, "the reason 60000"),
        (Role.DESCRIPTOR, "detail", 1, "a detail of ACCEPTED out of range"),
        (Role.DESCRIPTOR, "line", 1, "a line of ACCEPTED out of range"),
    ],
)
def test_a_record_that_no_worker_writes_is_refused(role, field, value, words):
    records = accepted()
    records[field][1, SLOT_ROLES.index(role)] = value
    with pytest.raises(SandboxError, match=words):
        checked(records)


@pytest.mark.parametrize(("length", "possible"), [(-1, 0), (0, 1), (1, 1), (2, 0), (5, 0), (6, 1)])
def test_a_wrong_count_is_one_that_is_not_right(length, possible):
    records = accepted()
    slot = SLOT_ROLES.index(Role.QUANTITY)
    records["reason"][:, slot], records["length"][:, slot] = Reason.WRONG_COUNT, length
    if possible:
        assert (
            f"returned {length} numbers, not between 2 and 5" in checked(records).refusals[0].reason
        )
        return
    with pytest.raises(SandboxError, match="a wrong count that is right or negative"):
        checked(records)


@given(st.binary(min_size=RECORD.itemsize, max_size=RECORD.itemsize), st.sampled_from(ROLES))
def test_whatever_a_worker_writes_is_refused_or_harmless(noise, role):
    records = accepted()
    records[1, SLOT_ROLES.index(role)] = np.frombuffer(noise, RECORD)[0]
    try:
        results = checked(records)
    except SandboxError:
        return
    assert np.isfinite(results.quantities["timestamp", "quantity"][0, :3]).all()
    assert ((results.moments["timestamp"] >= -2) & (results.moments["timestamp"] < MOMENTS)).all()


@given(
    st.sampled_from(ROLES),
    st.sampled_from(Reason),
    st.integers(0, 300),
    st.integers(0, 20_000),
    st.integers(-3, 9),
    st.lists(st.floats(), min_size=5, max_size=5),
)
def test_plausible_records_are_refused_or_harmless(role, reason, detail, line, length, numbers):
    records = accepted()
    slot = SLOT_ROLES.index(role)
    records[1, slot] = (reason, detail, line, length, numbers)
    try:
        results = checked(records)
    except SandboxError:
        return
    assert results.success["success"].dtype == bool
    assert not np.isinf(results.fitness["fitness"]).any()
    assert results.moments["timestamp"][1] in range(-2, MOMENTS)
    for block in (*results.quantities.values(), *results.descriptors.values()):
        assert not np.isinf(block).any()
    for refused in results.refusals:
        assert refused.reason.startswith(("returned ", "raised ", "changed "))
        assert refused.motions.tolist() == [1]


def test_definitions_are_checked():
    records = np.zeros(2, RECORD)
    records["reason"] = [Reason.ACCEPTED, Reason.DROPPED]
    check_definitions(records, dropped=[False, True])
    with pytest.raises(SandboxError, match="the reason 4 for a definition"):
        check_definitions(records, dropped=[False, False])
