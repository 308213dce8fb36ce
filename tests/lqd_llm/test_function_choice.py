import pytest

from lqd_envs.errors import LQDError
from lqd_llm.check import Candidate
from lqd_llm.errors import FunctionError, InferenceError
from lqd_llm.function_choice import candidates_of, choose_direct, choose_functions
from lqd_llm.functions import InferredFunction
from lqd_llm.reply import FunctionSource, Reply


def reply_of(*names):
    sources = (FunctionSource(name=name, description="", code=f"# {name}") for name in names)
    return Reply(functions=tuple(sources))


def make(source, kind, entry):
    """Make any function but those whose names begin with `bad`."""
    if source.name.startswith("bad"):
        raise FunctionError(f"The {kind} function {source.name!r} is bad.")
    return InferredFunction(source.name, source.description, source.code, entry)


def names(choice):
    return [function.name for function in choice.functions]


def test_first_functions_are_chosen_up_to_the_number():
    choice = choose_functions(reply_of("a", "b", "c", "spare"), kind="fitness", make=make)

    assert names(choice) == ["a", "b", "c"]
    assert {function.entry for function in choice.functions} == {"fitness"}
    assert choice.dropped == (
        "The fitness function 'spare' is not used: 3 came before it, as many as were asked for.",
    )


def test_function_beyond_the_number_stands_in_for_one_that_cannot_be_used():
    choice = choose_functions(reply_of("a", "bad", "c", "spare"), kind="fitness", make=make)

    assert names(choice) == ["a", "c", "spare"]
    assert choice.dropped == ("The fitness function 'bad' is bad.",)


def test_fewer_functions_than_asked_for_will_do():
    choice = choose_functions(reply_of("bad_one", "b", "bad"), kind="quantities", make=make)

    assert names(choice) == ["b"]
    assert len(choice.dropped) == 2


@pytest.mark.parametrize("kind", ["success", "fitness", "timestamps", "quantities"])
def test_kind_without_any_function_fails(kind):
    with pytest.raises(InferenceError) as caught:
        choose_functions(reply_of("bad", "bad_too"), kind=kind, make=make)

    assert isinstance(caught.value, LQDError)
    assert str(caught.value) == (
        f"Expected a {kind} function that can be used, got none out of bad, bad_too; take another "
        f"sample. The {kind} function 'bad' is bad. The {kind} function 'bad_too' is bad."
    )


def test_of_very_many_that_cannot_be_used_a_few_are_told():
    with pytest.raises(InferenceError) as caught:
        choose_functions(reply_of(*[f"bad_{k}" for k in range(60)]), kind="fitness", make=make)

    told = str(caught.value)
    assert "got none out of bad_0, bad_1, bad_2, bad_3, bad_4 and 55 more; take another" in told
    assert told.endswith(" The fitness function 'bad_4' is bad.")
    assert len(told) < 400


def test_empty_reply_fails():
    with pytest.raises(InferenceError) as caught:
        choose_functions(reply_of(), kind="timestamps", make=make)

    assert str(caught.value) == (
        "Expected a timestamps function that can be used, got none out of an empty reply; "
        "take another sample."
    )


def test_direct_functions_are_told_by_their_names():
    reply = reply_of("descriptor", "other", "success", "fitness")
    choice = choose_direct(reply, make=make)

    assert names(choice) == ["success", "fitness", "descriptor"]
    assert [function.entry for function in choice.functions] == names(choice)
    assert choice.dropped == (
        "The direct function 'other' is not used: expected the names success, fitness, descriptor.",
    )


def test_direct_needs_all_three():
    with pytest.raises(InferenceError) as caught:
        choose_direct(reply_of("success", "fitness", "measures"), make=make)

    assert str(caught.value) == (
        "Expected a direct descriptor that can be used, got none out of success, fitness, "
        "measures; take another sample. The direct function 'measures' is not used: expected the "
        "names success, fitness, descriptor."
    )


def test_direct_function_that_cannot_be_used_is_told():
    def refuse(source, kind, entry):
        raise FunctionError(f"The {kind} function {source.name!r} does not define {entry!r}.")

    with pytest.raises(InferenceError, match=r"a direct success .* does not define 'success'\."):
        choose_direct(reply_of("success", "fitness", "descriptor"), make=refuse)


def test_candidates_are_the_functions_that_are_chosen_if_all_can_be_used():
    mesh = reply_of("a", "b", "c", "spare")
    direct = reply_of("other", "descriptor", "success")

    assert candidates_of(mesh, kind="fitness") == [
        Candidate(source, "fitness", "fitness") for source in mesh.functions[:3]
    ]
    assert candidates_of(direct, kind="direct") == [
        Candidate(source, "direct", source.name) for source in direct.functions[1:]
    ]
