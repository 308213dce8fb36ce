import json
import string

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lqd_llm.reply import FunctionSource, Reply
from lqd_search.runs.function_text import FUNCTION_KINDS, SINGLE_KINDS, FunctionText
from lqd_search.runs.functionals_folder import (
    FunctionalsFolderError,
    read_functionals,
    read_origin,
    write_functionals,
)
from lqd_search.runs.functionals_index import Origin

SUCCESS = FunctionText("success", "success", "Done?", "def success(infos):\n    return True\n")
ORIGIN = Origin("Wave", "some model", "Made up.", {"success": "ab"})


def fitness(name, code="def fitness(info):\n    return 0.0\n"):
    return FunctionText("fitness", name, f"what {name} says", code)


names = st.from_regex(r"[a-z_][a-z0-9_]{0,12}", fullmatch=True)
words = st.text(st.characters(exclude_categories=("Cs",)) | st.sampled_from(string.whitespace))


@st.composite
def functionals(draw):
    """Functionals in the order of their kinds, as every set of them is."""
    texts = [SUCCESS]
    for kind in FUNCTION_KINDS:
        if kind in SINGLE_KINDS:
            its = [kind.rpartition(".")[2]] if draw(st.booleans()) and kind != "success" else []
        else:
            its = draw(st.lists(names, max_size=4, unique=True))
        texts.extend(FunctionText(kind, name, draw(words), draw(words)) for name in its)
    return tuple(texts)


@settings(max_examples=60, suppress_health_check=[HealthCheck.too_slow], deadline=None)
@given(functionals(), st.none() | st.just(ORIGIN))
def test_what_is_written_is_read_again(tmp_path_factory, texts, origin):
    path = tmp_path_factory.mktemp("folders") / "new" / "one"
    write_functionals(path, texts, origin=origin)

    assert read_functionals(path) == texts
    assert read_origin(path) == origin
    assert {f.name: f.read_bytes() for f in path.glob("*.py")} == {
        text.file_name: text.source.encode() for text in texts
    }


@pytest.fixture
def folder(tmp_path):
    """A folder whose fitness functions are not in the order of their names."""
    write_functionals(tmp_path, [SUCCESS, fitness("b"), fitness("a"), fitness("d")])
    return tmp_path


def read_names(folder):
    return [text.name for text in read_functionals(folder)]


def test_a_file_that_was_added_comes_last_and_one_that_is_gone_is_left_out(folder):
    (folder / "fitness.d.py").unlink()
    (folder / "fitness.c.py").write_text("# new\ndef fitness(info):\n    return 1.0\n")
    (folder / "fitness.aa.py").write_text("# new\ndef fitness(info):\n    return 1.0\n")

    assert read_names(folder) == ["success", "b", "a", "aa", "c"]


def test_without_its_index_a_folder_is_read_by_name(folder):
    (folder / "functionals.json").unlink()

    assert read_names(folder) == ["success", "a", "b", "d"]
    assert read_origin(folder) is None


def test_what_a_person_changed_is_read(folder):
    (folder / "fitness.a.py").write_text("#   other words  \r\n\n\ndef fitness(info): return 2\n\n")
    (folder / "fitness.b.py").write_text("\ufeff#\nx", encoding="utf-8")
    _, b, a, _ = read_functionals(folder)

    assert (a.description, a.code) == ("other words", "\n\ndef fitness(info): return 2\n\n")
    assert (b.description, b.code) == ("", "x")


def test_other_files_are_passed_over(folder):
    (folder / "inference").mkdir()
    (folder / "__pycache__").mkdir()
    for name in ("notes.md", ".fitness.a.py", "fitness.a.py~", "fitness.a.pyc"):
        (folder / name).write_text("anything")

    assert read_names(folder) == ["success", "b", "a", "d"]


def test_direct_functions_alone_are_enough(tmp_path):
    direct = [FunctionText(kind, kind.split(".")[1], "", "") for kind in FUNCTION_KINDS[-3:]]
    write_functionals(tmp_path, direct)

    assert read_functionals(tmp_path) == tuple(direct)


@pytest.mark.parametrize("long", ["a" * 70, "1" * 70])
def test_names_as_long_as_a_reply_may_bring_are_taken(tmp_path, long):
    sources = [FunctionSource(name=long, description="d", code="") for _ in range(12)]
    names = [one.name for one in Reply(functions=tuple(sources)).functions]

    write_functionals(tmp_path, [SUCCESS, *map(fitness, names)])

    assert [text.name for text in read_functionals(tmp_path)[1:]] == names


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("helper.py", "Expected only files of functionals, but got helper.py; a folder of"),
        ("descriptor.py", "Expected only files of functionals, but got descriptor.py"),
        ("__init__.py", "Expected only files of functionals, but got __init__.py"),
        ("success.two.py", "Expected only files of functionals, but got success.two.py"),
        ("direct.fitness.two.py", "Expected only files of functionals, but got direct.fitness.two"),
        ("fitness.py", "Expected only files of functionals, but got fitness.py"),
        ("fitness..py", "Expected only files of functionals, but got fitness..py"),
        ("fitness.a.b.py", "Expected an identifier of plain letters, digits and _ as the name of a "
         "fitness, but got 'a.b' from fitness.a.b.py; rename the file."),
        ("quantity.2nd.py", "as the name of a quantity, but got '2nd'"),
        ("timestamp.größe.py", "as the name of a timestamp, but got 'größe'"),
        (f"quantity.{'a' * 101}.py", "Expected at most 100 characters as the name of a quantity, "
         "but got 101 from quantity.aaa"),
    ],
)  # fmt: skip
def test_file_that_is_no_functional(folder, name, told):
    (folder / name).write_text("# what it is\n")

    with pytest.raises(FunctionalsFolderError) as caught:
        read_functionals(folder)
    assert told in str(caught.value)


@pytest.mark.parametrize("content", ["", "\n", "# words", "def fitness(info): return 0\n"])
def test_file_without_a_description(folder, content):
    (folder / "fitness.a.py").write_text(content)

    first = content.partition("\n")[0]
    with pytest.raises(FunctionalsFolderError) as caught:
        read_functionals(folder)
    assert str(caught.value) == (
        f"Expected a comment that says what the function measures in the first line of "
        f"{folder / 'fitness.a.py'}, but it is {first!r}; put one such as "
        "'# How near the gripper is.' before it."
    )


def test_file_that_is_not_utf_8(folder):
    (folder / "fitness.a.py").write_bytes(b"# ab\xff\n")

    with pytest.raises(FunctionalsFolderError, match=r"fitness\.a\.py, but byte 4 is none; save"):
        read_functionals(folder)


def test_folder_without_a_condition_of_success(folder):
    (folder / "success.py").unlink()

    with pytest.raises(FunctionalsFolderError) as caught:
        read_functionals(folder)
    assert str(caught.value).startswith(
        f"Expected functionals with success.py in {folder}, but it holds fitness.b.py, "
        "fitness.a.py, fitness.d.py; a folder of functionals has success.py, fitness.<name>.py, "
    )


def test_empty_folder(tmp_path):
    with pytest.raises(FunctionalsFolderError, match=r"but it holds no \.py file at all; a folder"):
        read_functionals(tmp_path)


@pytest.mark.parametrize("name", ["nowhere", "file"])
def test_no_folder(tmp_path, name):
    (tmp_path / "file").touch()

    with pytest.raises(FunctionalsFolderError, match=r"^Expected .* cannot be read \(No(t| such)"):
        read_functionals(tmp_path / name)


@pytest.mark.parametrize(
    "content",
    [
        b"{",
        b"\xff",
        b"[" * 100_000,
        b"[]",
        b'{"format": 2, "functionals": []}',
        b'{"format": 1, "functionals": [1]}',
        b'{"format": 1, "functionals": [{"file_name": "a"}]}',
        b'{"format": 1, "functionals": [], "origin": {"model": "a"}}',
    ],
)
def test_damaged_index(folder, content):
    (folder / "functionals.json").write_bytes(content)

    for read in (read_functionals, read_origin):
        with pytest.raises(FunctionalsFolderError, match=r"restore the file, or remove it to have"):
            read(folder)


def test_index_may_say_more_than_is_known(folder):
    path = folder / "functionals.json"
    content = json.loads(path.read_text())
    content["more"] = content["functionals"][0]["more"] = 1
    path.write_text(json.dumps(content))

    assert read_names(folder) == ["success", "b", "a", "d"]


@pytest.mark.parametrize(
    ("texts", "told"),
    [
        ([SUCCESS, fitness("a"), fitness("a")], "distinct names that are identifiers, but got fit"),
        ([FunctionText("success", "opened", "", "")], "but got success.py for 'opened'; rename it"),
        ([fitness("../a")], "as the name of a fitness, but got '../a'"),
        ([FunctionText("reward", "a", "", "")], "Expected only files of functionals, but got rew"),
        ([fitness("a", code="'\ud800'")], "text that UTF-8 can hold in fitness.a.py, but it holds"),
    ],
)
def test_functionals_that_cannot_be_written(tmp_path, texts, told):
    with pytest.raises(FunctionalsFolderError) as caught:
        write_functionals(tmp_path / "new", texts)
    assert told in str(caught.value)
    assert not (tmp_path / "new").exists()


def test_place_that_cannot_be_written(tmp_path):
    (tmp_path / "file").touch()

    with pytest.raises(FunctionalsFolderError, match=r"see to the folder and its disk, or name"):
        write_functionals(tmp_path / "file" / "new", [SUCCESS])
