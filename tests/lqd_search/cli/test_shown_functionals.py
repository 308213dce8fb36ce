"""Functionals as the terminal shows them."""

from hypothesis import given
from hypothesis import strategies as st

from lqd_llm import Usage
from lqd_search.cli.checked_functionals import CheckedFunctionals
from lqd_search.cli.shown_functionals import functionals_lines
from lqd_search.runs.function_text import FunctionText

LONG = "def fitness(info):\n    return 0.0  # " + "x" * 150


def shown(*texts, **changes):
    return list(functionals_lines(CheckedFunctionals(texts=texts, lengths={}, **changes)))


def test_long_line_of_code_goes_on_in_the_next():
    lines = shown(FunctionText("fitness", "near", "How near.", LONG))

    assert lines[:5] == [
        "fitness · near",
        "How near.",
        "",
        "    def fitness(info):",
        f"        return 0.0  # {'x' * 78}",
    ]
    assert lines[5] == f"            {'x' * 72}"
    assert max(map(len, lines)) <= 100


def test_control_characters_are_shown_and_not_obeyed():
    text = FunctionText("success", "success", "a\x1b[2Jb\u202ec", "x = '\x1b]0;\x07'\r\n\ty = 1\n")
    lines = shown(text, dropped=("The \x1b function",))

    assert lines[1] == r"a\x1b[2Jb\u202ec"
    assert lines[3:5] == [r"    x = '\x1b]0;\x07'", "        y = 1"]
    assert r"- not used: The \x1b function" in lines


def test_what_the_checks_said():
    lines = shown(
        FunctionText("direct.success", "success", "", "code"),
        repaired=("One.",),
        dropped=("Two.",),
        remarks=("Three.",),
        model="a model",
        provenance="Asked.",
        usage=Usage(requests=3),
    )

    assert lines == [
        *("direct success", "", "    code", ""),
        "Checks: 1 functions pass (1 of them direct), of which 1 were repaired; 1 are not used.",
        *("- repaired: One.", "- not used: Two.", "- remark: Three.", "Model: a model. Asked."),
        "Usage: 3 requests, 0 tokens sent (0 of them from the cache), 0 received, about $0.00.",
    ]


def test_usage_of_a_folder_is_not_shown():
    assert not [line for line in shown() if line.startswith("Usage")]


@given(st.text(), st.text())
def test_every_line_can_be_shown(description, code):
    for line in shown(FunctionText("fitness", "near", description, code)):
        assert len(line) <= 100
        assert line.isprintable()
