import copy
import math
from dataclasses import replace

import pytest

from lqd_envs.errors import LQDError
from lqd_llm import (
    KINDS,
    infer_from_recording,
    prompt_hash,
    render_prompt,
    render_system,
)
from lqd_llm.errors import InferenceError, RecordingError


def infer(task, *, sample=0, **changes):
    words = {"instruction": task.instruction, "schema": task.schema, **changes}
    return infer_from_recording(task.name, sample=sample, **words)


@pytest.fixture
def functionals(task, sample):
    return infer(task, sample=sample)


@pytest.fixture
def motions(no_contact, contact):
    return no_contact, contact


def test_every_recorded_function_is_built(functionals):
    assert len(functionals.fitness) == 3
    assert len(functionals.timestamps) == 4
    assert len(functionals.quantities) == 4
    assert functionals.success.name == "success"
    direct = functionals.direct
    assert [direct.success.name, direct.fitness.name, direct.descriptor.name] == [
        "success",
        "fitness",
        "descriptor",
    ]
    assert functionals.dropped == ()


def test_success_tells_the_motions_apart(functionals, no_contact, contact):
    for success in (functionals.success, functionals.direct.success):
        assert success.call(no_contact) is False
        assert success.call(contact) is True


def test_fitness_is_a_finite_number(functionals, motions):
    for fitness in (*functionals.fitness, functionals.direct.fitness):
        for infos in motions:
            values = [fitness.call(info) for info in infos]
            assert all(isinstance(value, float) and math.isfinite(value) for value in values)


def test_timestamp_is_a_moment_itself_or_none(functionals, motions):
    for timestamp in functionals.timestamps:
        for infos in motions:
            moment = timestamp.call(infos)
            assert moment is None or any(moment is info for info in infos)


def test_some_moments_of_a_contact_never_come_without(functionals, no_contact, contact):
    without = [timestamp.call(no_contact) for timestamp in functionals.timestamps]
    touching = [timestamp.call(contact) for timestamp in functionals.timestamps]

    assert None in without
    assert None not in touching


def test_quantity_is_a_short_tuple_of_one_length(functionals, motions):
    for quantity in functionals.quantities:
        values = [quantity.call(info) for infos in motions for info in infos]
        assert all(is_measures(value) for value in values)
        assert len({len(value) for value in values}) == 1


def test_descriptor_is_a_short_tuple_or_none(functionals, no_contact, contact):
    descriptor = functionals.direct.descriptor

    assert is_measures(descriptor.call(contact))
    without = descriptor.call(no_contact)
    assert without is None or is_measures(without)


def is_measures(value):
    return (
        isinstance(value, tuple)
        and 2 <= len(value) <= 5
        and all(isinstance(number, float) and math.isfinite(number) for number in value)
    )


def test_functions_leave_the_infos_as_they_are(functionals, contact):
    before = copy.deepcopy(contact)
    for function in (functionals.success, *functionals.timestamps):
        function.call(contact)
    for function in (*functionals.fitness, *functionals.quantities):
        function.call(contact[0])

    assert contact == before


def test_functionals_say_where_they_come_from(faucet):
    functionals = infer(faucet)

    assert functionals.model == "claude (version not reported)"
    assert "outside the API" in functionals.provenance
    system = render_system(faucet.schema)
    assert functionals.prompt_hashes == {
        kind: prompt_hash(system, render_prompt(kind, instruction=faucet.instruction))
        for kind in KINDS
    }


def test_samples_differ(faucet):
    assert infer(faucet, sample=0).success.code != infer(faucet, sample=1).success.code


def test_other_instruction_is_refused(faucet):
    with pytest.raises(RecordingError) as caught:
        infer(faucet, instruction="Turn on the cold water")

    assert str(caught.value) == (
        "Sample 0 of the task 'faucet' answers another success prompt than the task renders: "
        "line 1 is 'The task is: \"Turn on the hot water\"' in the recording and "
        "'The task is: \"Turn on the cold water\"' in the task; restore the task's instruction "
        "and perception schema, or record the task again."
    )


def test_other_schema_is_refused(faucet):
    schema = replace(faucet.schema, links=("base", "tap"))

    message = r'another system prompt .*: line \d+ is .*"hot_tap", .* and .*"base", "tap"\' in'
    with pytest.raises(RecordingError, match=message):
        infer(faucet, schema=schema)


def test_prompt_that_goes_on_is_refused(faucet, recorded, write):
    recorded["replies"]["direct"]["prompt"] += "\n"

    message = r"another direct prompt .*: line 18 is '' in the recording and missing in the task;"
    with pytest.raises(RecordingError, match=message):
        infer(faucet, directory=write(recorded))


def functions(recorded, kind):
    return recorded["replies"][kind]["reply"]["functions"]


def test_function_that_fails_is_dropped_and_told(faucet, recorded, write):
    functions(recorded, "fitness")[0] |= {"name": "bad", "code": "import os"}
    functions(recorded, "quantities")[3] |= {"name": "worse", "code": "def quantity(info:"}
    names = [function["name"] for function in functions(recorded, "fitness")]

    functionals = infer(faucet, directory=write(recorded))

    assert [function.name for function in functionals.fitness] == names[1:]
    assert len(functionals.quantities) == 3
    bad, worse = functionals.dropped
    assert bad.startswith("The fitness function 'bad' cannot be built: line 1: expected no import")
    assert worse.startswith("The quantities function 'worse' cannot be built: line 1:")


def test_function_beyond_the_number_is_dropped_and_told(faucet, recorded, write):
    spare = {"name": "spare", "description": "", "code": "def fitness(info): return 0.0"}
    functions(recorded, "fitness").append(spare)

    functionals = infer(faucet, directory=write(recorded))

    assert len(functionals.fitness) == 3
    assert functionals.dropped == (
        "The fitness function 'spare' is not used: 3 came before it, as many as were asked for.",
    )


def test_function_beyond_the_number_stands_in_for_one_that_fails(faucet, recorded, write):
    spare = {"name": "spare", "description": "", "code": "def fitness(info): return 0.0"}
    functions(recorded, "fitness").append(spare)
    functions(recorded, "fitness")[0]["code"] = ""

    functionals = infer(faucet, directory=write(recorded))

    assert len(functionals.fitness) == 3
    assert functionals.fitness[-1].name == "spare"


@pytest.mark.parametrize("kind", ["success", "fitness", "timestamps", "quantities"])
def test_kind_without_any_function_fails(faucet, recorded, write, kind):
    names = ", ".join(function["name"] for function in functions(recorded, kind))
    for function in functions(recorded, kind):
        function["code"] = "x = 1"

    message = (
        rf"^Expected a {kind} function that can be used, got none out of {names}; "
        rf"take another sample\. The {kind} function '\w+' cannot be built"
    )
    with pytest.raises(InferenceError, match=message):
        infer(faucet, directory=write(recorded))


def test_empty_reply_fails(faucet, recorded, write):
    functions(recorded, "timestamps").clear()

    with pytest.raises(InferenceError) as caught:
        infer(faucet, directory=write(recorded))

    assert str(caught.value) == (
        "Expected a timestamps function that can be used, got none out of an empty reply; "
        "take another sample."
    )


def test_direct_needs_all_three(faucet, recorded, write):
    functions(recorded, "direct")[2]["name"] = "measures"

    with pytest.raises(InferenceError) as caught:
        infer(faucet, directory=write(recorded))

    assert str(caught.value) == (
        "Expected a direct descriptor that can be used, got none out of success, fitness, "
        "measures; take another sample. The direct function 'measures' is not used: expected the "
        "names success, fitness, descriptor."
    )


def test_direct_function_that_fails_is_told(faucet, recorded, write):
    functions(recorded, "direct")[0]["code"] = "def success(infos, k): return True"

    with pytest.raises(InferenceError, match=r"a direct success .* line 1: expected 'success' to"):
        infer(faucet, directory=write(recorded))


def test_errors_are_of_the_project():
    assert issubclass(InferenceError, LQDError)
    assert issubclass(RecordingError, LQDError)
