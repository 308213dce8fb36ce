import json
from pathlib import Path

import numpy as np
import pytest

from lqd_llm.sandbox import SandboxError, corpus
from lqd_llm.sandbox.corpus import CorpusLine, CorpusOutcome, read_corpus, run_corpus
from lqd_llm.sandbox.roles import Role

CORPORA = Path(__file__).parent / "corpora"


def run(lines, layout, mugs):
    columns = mugs.rows(np.arange(3)).arrays()
    return list(run_corpus(lines, layout=layout, columns=columns))


def line(code, *, kind=Role.FITNESS, expected="ok", also_ok=()):
    return CorpusLine("line", kind, "entry", f"def entry(x):\n    {code}\n", expected, also_ok)


@pytest.mark.parametrize(
    "name",
    [
        "attacks",
        *(
            pytest.param(name, marks=pytest.mark.slow)
            for name in ("attacks_more", "attacks_tricks")
        ),
    ],
)
def test_every_attack_ends_as_expected(name, layout, mugs):
    lines = read_corpus(CORPORA / f"{name}.jsonl")
    differing = [
        (outcome.line.name, outcome.outcome, outcome.detail)
        for outcome in run(lines, layout, mugs)
        if not outcome.as_expected
    ]
    assert differing == []


@pytest.mark.parametrize(
    ("code", "kind", "outcome"),
    [
        ("return 1.0", Role.FITNESS, "ok"),
        ("return x[-1]", Role.TIMESTAMP, "ok"),
        ("return (1.0, 2.0)", Role.QUANTITY, "ok"),
        ("return None", Role.FITNESS, "bad_value"),
        ("return x['nothing']", Role.FITNESS, "bad_value"),
        ("return eval('1')", Role.FITNESS, "rejected"),
        ("return 0.5 in range(10 ** 12)", Role.FITNESS, "timeout"),
        ("return len([0] * 10 ** 11)", Role.FITNESS, "memory"),
    ],
)
def test_each_outcome(code, kind, outcome, layout, mugs):
    (came,) = run([line(code, kind=kind)], layout, mugs)
    assert came.outcome == outcome
    assert came.as_expected == (outcome == "ok")
    assert bool(came.detail) == (outcome != "ok")


def test_what_ran_is_contained_where_that_is_asked_for(layout, mugs):
    lines = [
        line("return 1.0", expected="contained"),
        line("return x['nothing']", expected="contained"),
        line("return None", expected="contained", also_ok=("bad_value",)),
        line("return eval('1')", expected="contained"),
    ]
    outcomes = [outcome.outcome for outcome in run(lines, layout, mugs)]
    assert outcomes == ["contained", "contained", "bad_value", "rejected"]


def test_a_canary_is_seen(layout, mugs, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def escape(_, **__):
        Path("sandbox_canary").touch()
        return "ok", ""

    (before,) = run([line("return 1.0")], layout, mugs)
    monkeypatch.setattr(corpus, "_try", escape)
    (escaped,) = run([line("return 1.0")], layout, mugs)
    assert (before.outcome, escaped.outcome) == ("ok", "escaped")
    assert "sandbox_canary appeared" in escaped.detail


def test_outcomes_that_are_as_good_are_as_expected():
    told = line("", expected="timeout", also_ok=("memory",))
    assert CorpusOutcome(told, "memory").as_expected
    assert not CorpusOutcome(told, "ok").as_expected


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("nothing", "Expected an object with name, kind"),
        ("[]", "Expected an object with name, kind"),
        (json.dumps({"name": "a", "kind": "other"}), "'other' is not a valid Role"),
        ("[" * 100_000, "Expected an object with name, kind"),
        (json.dumps({"name": "a", "kind": "success", "also_ok": 3}), "'entry'"),
        (
            json.dumps(
                dict.fromkeys(("name", "entry", "code", "expected"), "a") | {"kind": "success"}
            ),
            "Expected the outcomes ok, .* names a",
        ),
    ],
)
def test_a_corpus_of_another_form_is_refused(text, words, tmp_path):
    file = tmp_path / "corpus.jsonl"
    file.write_text(text)
    with pytest.raises(SandboxError, match=words):
        read_corpus(file)


def test_lines_of_nothing_are_passed_over(tmp_path):
    told = {"name": "a", "kind": "fitness", "entry": "f", "code": "", "expected": "rejected"}
    file = tmp_path / "corpus.jsonl"
    file.write_text(f"\n{json.dumps(told)}\r\n  \n{json.dumps(told | {'also_ok': None})}\n")
    assert [line.also_ok for line in read_corpus(file)] == [(), ()]


def test_a_corpus_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(SandboxError, match="cannot be read"):
        read_corpus(tmp_path / "corpus.jsonl")
