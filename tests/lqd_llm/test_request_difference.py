from lqd_llm.model_options import ModelOptions
from lqd_llm.request import Turn
from lqd_llm.request_difference import compare


def test_equal_requests_do_not_differ(ask):
    assert compare(ask(), ask()).parts == ()
    assert compare(ask(), ask()).distance == (0, 0)


def test_every_part_that_differs_is_named(ask):
    there = ask(
        "One\nTwo\nThree",
        options=ModelOptions(model="a", effort="low"),
        system="Be long.",
        sample=1,
        attempt=2,
        schema={"type": "object"},
    )
    here = ask("One\n2\n3", options=ModelOptions(model="b"), schema={"type": "array"})

    assert compare(there, here).parts == (
        "the model is 'a' there and 'b' here",
        "the effort is 'low' there and None here",
        "the sample is 1 there and 0 here",
        "the repair attempt is 2 there and 0 here",
        "line 1 of the system prompt is 'Be long.' there and 'Be brief.' here",
        "line 2 of the messages is 'Two' there and '2' here",
        'line 2 of the schema is \' "type": "object"\' there and \' "type": "array"\' here',
    )
    assert compare(there, here).distance == (7, 4)


def test_model_may_be_left_out(ask):
    there = ask(options=ModelOptions(model="a", effort="low"), schema={}, sample=1)

    assert compare(there, ask(), any_model=True).parts == ("the sample is 1 there and 0 here",)


def test_missing_line_and_other_speaker_are_named(ask):
    longer = ask(messages=(Turn("user", "Write"), Turn("assistant", "No")))

    (part,) = compare(ask(), longer).parts
    assert part == "line 2 of the messages is missing there and 'assistant: No' here"


def test_of_a_long_line_the_place_is_shown(ask):
    there, here = "a" * 300 + "b" + "c" * 300, "a" * 300 + "d" + "c" * 300

    (part,) = compare(ask(there), ask(here)).parts
    assert part.count("...") == 4
    assert "a" * 30 + "b" in part
    assert "a" * 30 + "d" in part
    assert len(part) < 300


def test_line_break_of_another_kind_is_shown(ask):
    (part,) = compare(ask("One\r\nTwo"), ask("One\nTwo")).parts

    assert part == r"line 1 of the messages is 'user: One\r' there and 'user: One' here"
