"""`lqd infer`."""

import json
import sys

import pytest

from lqd_envs import get_task
from lqd_envs.tasks.examples import example_solutions
from lqd_llm import CheckOutcome, ExchangeFolder, LiveProvider, ReplayProvider, infer
from lqd_llm.sandbox import SandboxError
from lqd_llm.sandbox.supervisor import Supervisor
from lqd_search.cli import checked_functionals
from lqd_search.runs.functionals_folder import read_functionals, read_origin

KEY = "sk-ant-test-0123456789"
TASK = "LQD/Faucet-v0"


@pytest.fixture(autouse=True)
def few_examples(monkeypatch, tmp_path):
    """Fewer example motions, to save time, in an empty folder."""
    monkeypatch.setattr(
        checked_functionals, "example_solutions", lambda task: example_solutions(task)[60:70]
    )
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def live(call, api, no_credentials, sleeps, monkeypatch):  # noqa: ARG001
    """Run `lqd infer` with a model that is asked at the fake API."""
    monkeypatch.setenv("ANTHROPIC_API_KEY", KEY)
    monkeypatch.setenv("ANTHROPIC_BASE_URL", api.url)

    def infer(*arguments):
        status, out, err = call("infer", TASK, "--llm", "live", "--threads", 1, *arguments)
        assert KEY not in out + err
        assert "Traceback" not in err
        return status, out, err

    return infer


@pytest.fixture
def recorded():
    """What is recorded for the task."""
    task = get_task(TASK)
    return infer(
        instruction=task.instruction,
        schema=task.schema,
        provider=ReplayProvider(),
        check=lambda candidates: [CheckOutcome() for _ in candidates],
    )


def functions(inferred):
    direct = inferred.direct
    groups = (inferred.fitness, inferred.timestamps, inferred.quantities)
    ends = (direct.success, direct.fitness, direct.descriptor)
    return [inferred.success, *(f for group in groups for f in group), *ends]


def is_repair(body):
    return "```python" in body["messages"][0]["content"]


def in_one_line(output):
    return " ".join(output.split())


@pytest.mark.usefixtures("no_network")
def test_replay_shows_every_function_and_writes_nothing(call, recorded, tmp_path):
    status, out, err = call("infer", TASK)
    lines = out.splitlines()

    assert (status, err) == (0, "")
    assert lines[0] == "LQD/Faucet-v0 “Turn on the hot water”"
    for function in functions(recorded):
        assert in_one_line(function.description) in in_one_line(out)
        assert in_one_line(function.code) in in_one_line(out)
    titles = [f"{kind} · {f.name}" for kind, group in (
        ("fitness", recorded.fitness),
        ("timestamp", recorded.timestamps),
        ("quantity", recorded.quantities),
    ) for f in group]  # fmt: skip
    singles = ["success", "direct success", "direct fitness", "direct descriptor"]
    assert {*titles, *singles} <= set(lines)
    assert max(map(len, lines)) <= 100
    assert (
        "Checks: 15 functions pass (3 of them direct), of which 0 were repaired; 0 are not used."
    ) in lines
    assert "outside the API: no request id, no usage" in in_one_line(out)
    assert lines[-1] == "Usage: 5 requests, usage not reported."
    assert not list(tmp_path.iterdir())


def test_recordings_that_cannot_be_written_are_told_before_anything_is_asked(live, api, tmp_path):
    (tmp_path / "file").touch()
    status, _, err = live("--llm", "record", "--recordings", "file/recordings")

    assert (status, api.bodies) == (2, [])
    assert "that answers can be written to, but file/recordings is none (Not a directory)" in err
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_what_cannot_become_a_recording_is_paid_for_once(live, api, tmp_path):
    api.answer, answer = lambda body: _then_full(answer(body), tmp_path), api.answer
    status, _, err = live("--llm", "record")
    assert (status, len(api.bodies)) == (2, 1)
    assert "cannot be written to recordings" in err
    (tmp_path / "recordings").unlink()

    status, _, _ = live("--llm", "record")
    assert (status, len(api.bodies)) == (0, 5)
    assert len(list((tmp_path / "recordings").iterdir())) == 5


def _then_full(response, folder):
    """Put a file where the recordings are to be, while the model thinks."""
    if not (folder / "recordings").exists():
        (folder / "recordings").touch()
    return response


@pytest.mark.usefixtures("no_network")
def test_folder_that_is_written(call, recorded, tmp_path):
    out = tmp_path / "some" / "folder"
    status, printed, _ = call("infer", TASK, "--out", out)

    assert status == 0
    assert printed.endswith(f"\nFunctionals: {out}\n")
    texts = read_functionals(out)
    assert [text.code for text in texts] == [f.code for f in functions(recorded)]
    assert [text.name for text in texts[:4]] == ["success", *(f.name for f in recorded.fitness)]
    origin = read_origin(out)
    assert (origin.instruction, origin.model) == ("Turn on the hot water", recorded.model)
    assert origin.prompt_hashes == recorded.prompt_hashes
    assert len(list(ExchangeFolder(out / "inference").exchanges())) == 5
    assert [path.name for path in out.parent.iterdir()] == ["folder"]


def test_existing_folder_is_refused(call, tmp_path):
    status, out, err = call("infer", TASK, "--out", tmp_path)

    assert (status, out) == (2, "")
    assert err == (
        f"lqd: Expected a new folder for the functionals, but {tmp_path} exists; name another with "
        "--out.\n"
    )


@pytest.mark.usefixtures("no_network")
@pytest.mark.parametrize(
    ("options", "told"),
    [
        (
            ("--instruction", "Turn on the cold water"),
            "the nearest is faucet-0.json, but line 1 of the messages is 'user: The task is: "
            '"Turn on the hot water"\' there and \'user: The task is: "Turn on the cold water"\' '
            "here; ask for what is recorded (the instructions of the tasks drawer, faucet, grasp, "
            "push, with the samples 0, 1, 2, 3, 4), ask a model with `--llm live` or ",
        ),
        (("--sample", 77), "the nearest is faucet-0.json, but the sample is 0 there and 77 here"),
        (("--instruction", " "), "Expected an instruction of at least one word, but it is empty"),
        (("--model", ""), "Expected the name of a model, but got ''"),
        (("--recordings", "nowhere"), "Expected a folder of recordings at nowhere, but there is"),
        (("--llm", "live", "--recordings", "a"), "Expected --recordings with --llm replay or"),
    ],
)
def test_what_cannot_be_had_is_one_sentence(call, tmp_path, options, told):
    status, out, err = call("infer", TASK, "--out", tmp_path / "folder" / "one", *options)

    assert (status, out) == (2, "")
    assert err.startswith("lqd: ")
    assert err.count("\n") == 1
    assert told in err
    assert not list(tmp_path.iterdir())


def test_a_miss_names_the_key(call):
    _, _, err = call("infer", TASK, "--instruction", "Turn on the cold water")

    assert err.startswith("lqd: Found no recording of the success prompt with the key ")
    assert len(err.split("the key ")[1].split(";")[0]) == 64


def test_model_that_is_asked(live, api, tmp_path):
    status, out, err = live("--effort", "high", "--max-tokens", 123, "--model", "claude-sonnet-5")

    assert (status, err) == (0, "")
    assert len(api.bodies) == 5
    for body in api.bodies:
        assert (body["model"], body["max_tokens"]) == ("claude-sonnet-5", 123)
        assert body["output_config"]["effort"] == "high"
    assert (
        "Usage: 5 requests, 500 tokens sent (0 of them from the cache), 100 received, about $0.00."
    ) in out.splitlines()
    assert "through the Anthropic API" in in_one_line(out)
    (folder,) = (tmp_path / "inferred").iterdir()
    assert folder.name.startswith("faucet-")
    assert len(read_functionals(folder)) == 15
    assert len(list((folder / "inference").iterdir())) == 5
    assert not [file for file in tmp_path.rglob("*.*") if KEY in file.read_text()]


def test_another_instruction(live, api, tmp_path):
    answer = api.answer

    def translated(body):
        prompt = body["messages"][0]["content"]
        assert '"Turn on the cold water"' in prompt
        hot = prompt.replace("cold water", "hot water")
        return answer({"messages": [{"content": hot}]})

    api.answer = translated
    status, out, _ = live("--instruction", "Turn on the cold water", "--out", tmp_path / "cold")

    assert status == 0
    assert out.startswith("LQD/Faucet-v0 “Turn on the cold water”")
    assert read_origin(tmp_path / "cold").instruction == "Turn on the cold water"


def test_recording_and_replaying_it(live, api, call, tmp_path):
    status, _, _ = live("--llm", "record", "--sample", 9)
    assert status == 0
    assert len(list((tmp_path / "recordings").iterdir())) == len(api.bodies) == 5

    status, out, _ = call("infer", TASK, "--recordings", "recordings", "--sample", 9)

    assert status == 0
    assert len(api.bodies) == 5
    assert "Usage: 5 requests, 500 tokens sent" in out
    (folder,) = (tmp_path / "inferred").iterdir()
    assert len(list((folder / "inference").iterdir())) == 5


def error(api, status, **headers):
    body = {"type": "error", "error": {"type": "some_error", "message": "Something is wrong."}}
    return api.response(body, status=status, headers=headers)


FAULTS = {
    "rate limit": (
        lambda api, _: error(api, 429, **{"retry-after": "30"}),
        "The Anthropic API refused the timestamps prompt because of a rate limit, 5 times in a row "
        "('Something is wrong', request req_1); try again in 30 seconds.",
    ),
    "overload": (
        lambda api, _: error(api, 529),
        "The Anthropic API is overloaded, 5 times in a row ('Something is wrong', request req_1); "
        "try again in some minutes.",
    ),
    "fault of the server": (
        lambda api, _: error(api, 500),
        "The Anthropic API failed with status 500, 5 times in a row ('Something is wrong', request "
        "req_1); try again in some minutes, and see https://status.claude.com.",
    ),
    "dropped connection": (
        lambda api, _: api.response(fault="dropped"),
        "The connection to 127.0.0.1 failed (RemoteProtocolError), 5 times in a row; check the "
        "network, any proxy and ANTHROPIC_BASE_URL, and try again.",
    ),
    "cut reply": (
        lambda api, words: api.response(words.message('{"fu', stop_reason="max_tokens")),
        "The reply to the timestamps prompt was cut at the limit of 20,000 tokens; raise "
        "max_tokens or lower the effort.",
    ),
    "refusal": (
        lambda api, words: api.response(words.message("", stop_reason="refusal", content=[])),
        "The model claude-opus-5-5 refused to answer the timestamps prompt; word the instruction "
        "differently or ask another model.",
    ),
    "malformed JSON": (
        lambda api, words: api.response(words.message('{"functions": [')),
        "The reply to the timestamps prompt is not JSON (EOF while parsing a list at line 1 column "
        "15); try again or ask another model.",
    ),
    "other JSON": (
        lambda api, words: api.response(words.message('{"functions": 3}')),
        "The reply to the timestamps prompt is JSON of another form than was asked for, at "
        "functions: Input should be a valid array; try again or ask another model.",
    ),
    "wrong key": (
        lambda api, _: error(api, 401),
        "The Anthropic API does not accept the key ('Something is wrong', request req_1); set "
        "ANTHROPIC_API_KEY to a key from https://platform.claude.com.",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_fault_is_one_sentence_and_loses_nothing(live, api, words, tmp_path, fault):
    make, told = FAULTS[fault]
    answer, failing = api.answer, make(api, words)
    fails = "different moments at which to look"
    api.answer = lambda body: failing if fails in body["messages"][0]["content"] else answer(body)
    out = tmp_path / "all" / "one"
    status, printed, err = live("--out", out)

    assert (status, printed) == (2, "")
    (kept,) = out.parent.iterdir()
    assert err == (
        f"note: the answers that came are kept in {kept} and used when the same is asked again\n"
        f"lqd: {told}\n"
    )
    tried = len(api.bodies)
    api.answer = answer
    status, printed, err = live("--out", out)

    assert (status, err) == (0, "")
    # Success and fitness are there already.
    assert len(api.bodies) == tried + 3
    assert list(out.parent.iterdir()) == [out]
    answered = "stop_reason" in json.dumps(failing.body, default=str)
    assert len(list(ExchangeFolder(out / "inference").exchanges())) == 5 + answered
    assert f"Usage: {5 + answered} requests, " in printed


def test_faults_that_pass_are_waited_out(live, api, sleeps):
    api.script.extend(
        [error(api, 429, **{"retry-after": "7"}), error(api, 529), api.response(fault="dropped")]
    )
    status, _, err = live()

    assert (status, err) == (0, "")
    assert len(api.bodies) == 5 + 3
    assert sleeps[0] == 7.0
    assert len(sleeps) == 3


def test_missing_key(live, api, tmp_path, monkeypatch):
    monkeypatch.delenv("ANTHROPIC_API_KEY")
    status, out, err = live()

    assert (status, out) == (2, "")
    assert err == (
        "lqd: Expected a key for the Anthropic API, but found none; set ANTHROPIC_API_KEY to a key "
        "from https://platform.claude.com, or take the recorded replies with `--llm replay`, which "
        "need none but are of the tasks' own instructions only.\n"
    )
    assert api.bodies == []
    assert not list(tmp_path.glob("inferred*"))


def test_interrupted_inference_goes_on(live, api, tmp_path, monkeypatch):
    with monkeypatch.context() as patch:
        ask = LiveProvider.ask

        def stop(self, request):
            if request.subject == "quantities":
                raise KeyboardInterrupt
            return ask(self, request)

        patch.setattr(LiveProvider, "ask", stop)
        status, _, err = live()

    assert status == 130
    assert err.startswith("note: the answers that came are kept in inferred/.inference-")
    assert err.endswith("\nlqd: stopped\n")
    assert len(api.bodies) == 3

    assert live()[0] == 0
    assert len(api.bodies) == 5
    assert len(list((tmp_path / "inferred").iterdir())) == 1


def with_bad_fitness(api, words, *, repaired):
    """A model whose first fitness function fails, and which repairs it as it is told."""
    answer = api.answer

    def reply(body):
        if is_repair(body):
            return api.response(words.message(words.reply_text(("any", repaired))))
        response = answer(body)
        said = json.loads(response.body["content"][-1]["text"])
        first = said["functions"][0]
        if "def fitness" in first["code"]:
            first["code"] = "def fitness(info):\n    return info['nothing']\n"
        return api.response(words.message(json.dumps(said)))

    api.answer = reply


def test_function_that_is_repaired(live, api, words, recorded, tmp_path):
    with_bad_fitness(api, words, repaired="def fitness(info):\n    return 1.5\n")
    name = recorded.fitness[0].name
    status, out, _ = live("--out", tmp_path / "out")

    assert status == 0
    assert "of which 1 were repaired; 0 are not used." in out
    assert (
        f"- repaired: The fitness function '{name}' passes its check after 1 repair (before: "
        "KeyError in line 2: raised on "
    ) in in_one_line(out)
    assert f"- remark: The fitness '{name}' gives the same number for all " in in_one_line(out)
    fitness = next(text for text in read_functionals(tmp_path / "out") if text.name == name)
    assert fitness.code == "def fitness(info):\n    return 1.5\n"
    assert len(api.bodies) == 6
    assert "Usage: 6 requests" in out


def test_function_that_never_passes(live, api, words, recorded):
    with_bad_fitness(api, words, repaired="def fitness(info):\n    return None\n")
    status, out, _ = live()

    assert status == 0
    assert "Checks: 14 functions pass (3 of them direct), of which 0 were repaired; 1 are" in out
    assert (
        f"- not used: The fitness function '{recorded.fitness[0].name}' is not used: it still "
        "fails its check after 3 repairs (TypeError: returned None, not a number, on "
    ) in in_one_line(out)
    assert len(api.bodies) == 5 + 3


def test_kind_that_never_passes(live, api, words, tmp_path):
    bad = words.message(words.reply_text(("any", "import os\n")))
    answer = api.answer
    api.answer = lambda body: (
        api.response(bad)
        if is_repair(body) or "whether a finished candidate" in body["messages"][0]["content"][:200]
        else answer(body)
    )
    status, out, err = live()

    assert (status, out) == (2, "")
    assert "lqd: Expected a success function that can be used, got none out of any;" in err
    assert "after 3 repairs (RejectedCodeError in line 1: " in err
    assert len(api.bodies) == 5 + 3
    (kept,) = (tmp_path / "inferred").iterdir()
    assert len(list(kept.iterdir())) == 5 + 3


@pytest.fixture
def weak_system(monkeypatch):
    """A system on which the sandbox lacks a layer."""

    def check_locks(self, _told):
        if not self._allow_weak:
            raise SandboxError("Expected all layers of the sandbox, but this system lacks one.")

    monkeypatch.setattr(Supervisor, "_check_locks", check_locks)


@pytest.mark.usefixtures("weak_system")
def test_weak_sandbox(call, live, api):
    assert call("infer", TASK)[0] == 0

    status, _, err = live()
    assert (status, err) == (
        2,
        "lqd: Expected all layers of the sandbox, but this system lacks one.\n",
    )
    # Nobody pays for what could not be run.
    assert api.bodies == []
    assert live("--allow-weak-sandbox")[0] == 0


def test_without_the_extra(call, monkeypatch):
    monkeypatch.setitem(sys.modules, "lqd_llm", None)
    status, out, err = call("infer", TASK)

    assert (status, out) == (2, "")
    assert err == (
        "lqd: Expected the packages of the extra `llm` to infer functionals, but lqd_llm is not "
        "installed; run `pip install '.[all]'` in a clone of lqd-envs.\n"
    )
