import pickle
import struct
import sys
from collections import Counter, OrderedDict, deque
from contextlib import suppress
from importlib import import_module

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from ribs.archives import GridArchive
from ribs.archives._array_store import ArrayStore

from lqd_envs import SolutionSpace, Verdict
from lqd_search.archives.competition import compete_by_coin, compete_by_fitness
from lqd_search.archives.grid_spec import GridSpec
from lqd_search.evaluation.descriptor_report import DescriptorReport
from lqd_search.methods.plus_switches import Switch, emitter_with
from lqd_search.runs.run_folder import RunFolder
from lqd_search.runs.state_pickle import (
    MODULES,
    NAMES,
    StateError,
    pickle_state,
    unpickle_state,
)
from lqd_search.runs.tally import Tally


def again(value):
    return unpickle_state(pickle_state(value))


PLAIN = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats(allow_nan=False)
    | st.text()
    | st.binary(),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.tuples(inner, inner)
        | st.dictionaries(st.text(max_size=4), inner, max_size=4)
        | st.lists(inner, max_size=4).map(deque)
        | st.sets(st.integers(), max_size=4)
        | st.frozensets(st.text(max_size=3), max_size=4)
        | st.dictionaries(st.text(max_size=4), inner, max_size=4).map(OrderedDict)
        | st.dictionaries(st.text(max_size=4), st.integers(), max_size=4).map(Counter)
    ),
    max_leaves=12,
)


@given(PLAIN)
def test_plain_values_come_back(value):
    read = again(value)
    assert read == value
    assert type(read) is type(value)


@pytest.mark.parametrize("kind", [Verdict, Switch])
def test_members_of_an_enumeration_come_back_however_python_would_pickle_them(kind, monkeypatch):
    usual = [pickle_state(member) for member in kind]
    # As the first releases of Python 3.11 do.
    monkeypatch.setattr(kind, "__reduce_ex__", lambda member, _: (getattr, (kind, member.name)))

    assert [pickle_state(member) for member in kind] == usual
    assert all(again(member) is member for member in kind)


def test_what_states_are_made_of_comes_back():
    state = {
        "types": [int, float, bool, str, np.float64, np.bool_, np.int32, np.uint64],
        "rest": [2 + 3j, range(3), slice(1, 9, 2), Verdict.VALID],
        "spec": GridSpec(dims=(2,), ranges=((0.0, 1.0),)),
        "tally": Tally(evaluations=3, refusals=Counter({("fitness", "f", "raised"): 2})),
        "report": DescriptorReport(same=(("a", "b"),), degenerate=(), undefined=()),
        "rule": compete_by_fitness,
    }
    assert again(state) == state
    assert again(state)["rule"] is compete_by_fitness


def test_pyribs_archives_come_back():
    archive = GridArchive(solution_dim=2, dims=(3, 3), ranges=[(0.0, 1.0)] * 2, seed=1)
    archive.add(np.ones((4, 2)), np.arange(4.0), np.random.default_rng(0).random((4, 2)))
    twin = again(archive)
    assert {k: v.tolist() for k, v in twin.data().items()} == (
        {k: v.tolist() for k, v in archive.data().items()}
    )
    assert twin.sample_elites(9)["objective"].tolist() == (
        archive.sample_elites(9)["objective"].tolist()
    )


def test_the_emitter_with_every_switch_can_be_pickled():
    emitter = emitter_with(tuple(Switch), space=SolutionSpace())
    assert type(again(emitter)) is type(emitter)


def test_a_coin_competition_goes_on_where_it_was():
    coin = compete_by_coin(np.random.default_rng(3))
    assert again(coin).rng.random(4).tolist() == coin.rng.random(4).tolist()


@pytest.mark.parametrize("name", sorted(NAMES))
def test_every_name_of_the_list_is_there(name):
    home, _, last = name.rpartition(".")
    found = getattr(import_module(home), last)
    assert f"{found.__module__}.{found.__qualname__}" == name


@pytest.mark.parametrize("name", MODULES)
def test_every_module_of_the_list_is_there(name):
    assert import_module(name).__name__ == name


class Stranger:
    pass


def stray():
    pass


@pytest.mark.parametrize("value", [Stranger(), Stranger, stray])
def test_a_stranger_needs_trust(value):
    trusted = [Stranger, stray]
    name = f"{__name__}.{'stray' if value is stray else 'Stranger'}"
    with pytest.raises(StateError, match=f"it holds {name}, which no state may name"):
        pickle_state(value)
    pickled = pickle_state([value], trusted=trusted)
    with pytest.raises(StateError, match=f"it names {name}, which no state may name"):
        unpickle_state(pickled)
    (read,) = unpickle_state(pickled, trusted=trusted)
    assert read is value or type(read) is Stranger


@pytest.mark.parametrize(
    ("value", "what"),
    [
        (lambda: None, r"lambda"),
        (sys, "builtins.module"),
        (np.add, "numpy.ufunc"),
        (RunFolder("."), "run_folder.RunFolder"),
        (RunFolder(".").write, "the bound method RunFolder.write"),
        (np.random.default_rng(0).random, "the bound method Generator.random"),
        ((i for i in ()), "builtins.generator"),
        (np.array([None]), "the dtype object"),
    ],
)
def test_what_a_state_must_not_hold_is_named_when_it_is_written(value, what):
    with pytest.raises(StateError, match=rf"^it holds .*{what}"):
        pickle_state({"deep": [value]})


# Pickles put together by hand, as somebody would who wants them to do harm.


def text(value):
    return pickle.BINUNICODE + struct.pack("<I", len(value.encode())) + value.encode()


def named(module, name):
    return text(module) + text(name) + pickle.STACK_GLOBAL


def dict_of(**items):
    pairs = b"".join(text(key) + value for key, value in items.items())
    return pickle.EMPTY_DICT + pickle.MARK + pairs + pickle.SETITEMS


def instance(module, name):
    return named(module, name) + pickle.EMPTY_TUPLE + pickle.NEWOBJ


def read(*parts):
    return unpickle_state(pickle.PROTO + b"\x05" + b"".join(parts) + pickle.STOP)


SPEC = ("lqd_search.archives.grid_spec", "GridSpec")
STORE = ("ribs.archives._array_store", "ArrayStore")


@pytest.mark.parametrize(
    "name",
    [
        "os.system",
        "posix.system",
        "subprocess.Popen",
        "builtins.eval",
        "builtins.exec",
        "builtins.getattr",
        "builtins.__import__",
        "builtins.open",
        "builtins.type",
        "builtins.object",
        "functools.partial",
        "operator.attrgetter",
        "copyreg._reconstructor",
        "importlib.import_module",
        "pathlib.PosixPath",
        "numpy.load",
        "numpy.save",
        "numpy.ndarray",
        "numpy.dtype",
        "numpy.void",
        "numpy.object_",
        "numpy.testing",
        "numpy.f2py",
        "numpy.ctypeslib",
        "numpy.testing.measure",
        "numpy._core.multiarray._reconstruct",
        "numpy._core.multiarray.scalar",
        "numpy.random._pickle.__generator_ctor",
        "pymoo.core.population.Population",
        "ribs.archives._archive_data_frame.ArchiveDataFrame",
        "ribs.archives._cvt_archive.CVTArchive",
        "ribs.emitters._bayesian_opt_emitter.BayesianOptimizationEmitter",
        "ribs.emitters.opt._pycma_es.PyCMAEvolutionStrategy",
        "ribs.visualize.grid_archive_heatmap",
        "lqd_search.archives.competition.np",
        "lqd_search.archives.competition.Callable",
        "lqd_search.archives.competition.compete_by_coin",
        "lqd_search.archives.grid_spec.LQDError",
        "lqd_search.archives.grid_spec.no_such_class",
        "lqd_search.archives.no_such_module.Nothing",
        "lqd_search.archives...GridSpec",
        "lqd_search.archives_of_mine.GridSpec",
        "lqd_search.runs.checkpoint.os",
        "lqd_search.runs.run_folder.RunFolder",
        "lqd_search.runs.run_recorder.RunRecorder",
        "lqd_search.runs.state_pickle._StateUnpickler",
        "lqd_search.cli.main.main",
        "lqd_search.GridSpec",
        "lqd_envs.env.LQDEnv",
    ],
)
def test_no_file_names_anything_else(name):
    before = set(sys.modules)
    with pytest.raises(StateError, match=r"^it names .*, which no state|^ModuleNotFoundError: "):
        read(named(*name.rsplit(".", 1)))
    assert {"numpy.f2py", "numpy.testing"}.isdisjoint(set(sys.modules) - before)


@pytest.mark.parametrize(
    ("module", "name"),
    [
        ("lqd_search.archives.competition", "np.load"),
        ("lqd_search.archives.competition", "compete_by_fitness.__globals__"),
        ("lqd_search.archives.grid_spec", "GridSpec.from_dict"),
        ("lqd_search.runs.checkpoint", "os.system"),
        ("numpy", "testing.measure"),
        ("numpy", "float64.fromhex"),
    ],
)
def test_no_file_reaches_through_what_it_may_name(module, name):
    with pytest.raises(StateError, match=f"^it names {module}.{name}, which no state may name$"):
        read(named(module, name))


def test_no_file_calls_a_program(tmp_path):
    class Evil:
        def __reduce__(self):
            return exec, (f"open({str(tmp_path / 'harm')!r}, 'w')",)

    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        with pytest.raises(StateError):
            unpickle_state(pickle.dumps(Evil(), protocol))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "content",
    [b"(S'true'\nios\nsystem\n.", b"(cos\nsystem\nS'true'\no.", b"Pname\n.", b"\x82\x01."],
)
def test_opcodes_of_old_protocols_are_unknown(content):
    with pytest.raises(StateError, match=r"^KeyError: "):
        unpickle_state(content)


@pytest.mark.parametrize("module", ["harm", "ribs.harm"])
def test_no_file_makes_pyribs_import_a_module(tmp_path, monkeypatch, module):
    (tmp_path / "harm.py").write_text("raise SystemExit")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(StateError, match="ArrayStore without NumPy"):
        read(instance(*STORE), dict_of(_xp=text(module)), pickle.BUILD)
    renamed = dict_of(XP_NAME=text("other"))
    with pytest.raises(StateError, match="ArrayStore without NumPy"):
        read(instance(*STORE), renamed, pickle.BUILD, dict_of(other=text(module)), pickle.BUILD)
    assert isinstance(
        read(instance(*STORE), dict_of(_xp=text("array_api_compat.numpy")), pickle.BUILD),
        ArrayStore,
    )


def test_no_file_changes_a_class_a_function_or_a_member_of_an_enumeration():
    change = pickle.NONE + dict_of(dims=pickle.NONE) + pickle.TUPLE2 + pickle.BUILD
    verdict = named("lqd_envs.verdict", "Verdict") + pickle.BININT1 + b"\x00" + pickle.TUPLE1
    with pytest.raises(StateError, match=r"^it changes builtins\.type$"):
        read(named(*SPEC), change)
    with pytest.raises(StateError, match=r"^it changes builtins\.function$"):
        read(named("lqd_search.archives.competition", "compete_by_fitness"), change)
    with pytest.raises(StateError, match=r"^it changes lqd_envs\.verdict\.Verdict$"):
        read(verdict, pickle.REDUCE, change)
    assert not hasattr(GridSpec, "dims")


def test_no_file_calls_an_instance():
    coin = instance("lqd_search.archives.competition", "_CoinCompetition")
    with pytest.raises(StateError, match=r"^it calls an instance of .*_CoinCompetition$"):
        read(coin, pickle.EMPTY_TUPLE, pickle.REDUCE)
    with pytest.raises(StateError, match=r"^it makes an instance of "):
        read(coin, pickle.EMPTY_TUPLE, pickle.NEWOBJ)


def test_no_state_holds_a_bound_method():
    with pytest.raises(StateError, match=r"the bound method SolutionSpace.repair; hold the inst"):
        pickle_state({"repair": SolutionSpace().repair})


STATE = pickle_state(
    [Tally(verdicts=Counter({Verdict.VALID: 3})), np.arange(3.0), GridSpec((2,), ((0.0, 1.0),))]
)


@given(st.integers(0, len(STATE) - 1), st.integers(0, 255), st.integers(0, len(STATE)))
def test_a_changed_pickle_is_a_state_or_a_state_error(place, byte, end):
    for content in (STATE[:place] + bytes([byte]) + STATE[place + 1 :], STATE[:end]):
        # Any other error fails the test.
        with suppress(StateError):
            unpickle_state(content)
            assert content != STATE[:end] or end == len(STATE)
