"""What the functions that ship say of two motions made by hand, called as plain Python."""

import copy
import math

import pytest

from benchmarks.plain_functions import plain_function
from lqd_llm import KINDS, load_recording
from lqd_llm.functions import ENTRIES


def functions_of(task, sample):
    """The functions of a recording that can be called, by the kind of prompt and their names."""
    exchanges = load_recording(task.name, sample=sample).exchanges
    return {
        kind: {
            source.name: plain_function(source.code, entry=ENTRIES.get(kind, source.name))
            for source in exchanges[kind].reply.functions
        }
        for kind in KINDS
    }


@pytest.fixture
def functions(task, sample):
    return functions_of(task, sample)


@pytest.fixture
def motions(no_contact, contact):
    return no_contact, contact


def test_success_tells_the_motions_apart(functions, no_contact, contact):
    for success in (functions["success"]["success"], functions["direct"]["success"]):
        assert success(no_contact) is False
        assert success(contact) is True


def test_fitness_is_a_finite_number(functions, motions):
    for fitness in (*functions["fitness"].values(), functions["direct"]["fitness"]):
        for infos in motions:
            values = [fitness(info) for info in infos]
            assert all(isinstance(value, float) and math.isfinite(value) for value in values)


def test_timestamp_is_a_moment_itself_or_none(functions, motions):
    for timestamp in functions["timestamps"].values():
        for infos in motions:
            moment = timestamp(infos)
            assert moment is None or any(moment is info for info in infos)


def test_some_moments_of_a_contact_never_come_without(functions, no_contact, contact):
    without = [timestamp(no_contact) for timestamp in functions["timestamps"].values()]
    touching = [timestamp(contact) for timestamp in functions["timestamps"].values()]

    assert None in without
    assert None not in touching


def test_quantity_is_a_short_tuple_of_one_length(functions, motions):
    for quantity in functions["quantities"].values():
        values = [quantity(info) for infos in motions for info in infos]
        assert all(is_measures(value) for value in values)
        assert len({len(value) for value in values}) == 1


def test_descriptor_is_a_short_tuple_or_none(functions, no_contact, contact):
    descriptor = functions["direct"]["descriptor"]

    assert is_measures(descriptor(contact))
    without = descriptor(no_contact)
    assert without is None or is_measures(without)


def is_measures(value):
    return (
        isinstance(value, tuple)
        and 2 <= len(value) <= 5
        and all(isinstance(number, float) and math.isfinite(number) for number in value)
    )


def test_functions_leave_the_infos_as_they_are(functions, contact):
    before = copy.deepcopy(contact)
    for function in (*functions["success"].values(), *functions["timestamps"].values()):
        function(contact)
    for function in (*functions["fitness"].values(), *functions["quantities"].values()):
        function(contact[0])

    assert contact == before


def test_samples_differ(task):
    samples = [load_recording(task.name, sample=sample) for sample in range(5)]
    for kind in ("fitness", "timestamps", "quantities"):
        replies = [str(recording.exchanges[kind].reply) for recording in samples]
        assert len(set(replies)) == 5
