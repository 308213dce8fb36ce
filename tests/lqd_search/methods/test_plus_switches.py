import dataclasses
import hashlib
import io
import pickle

import numpy as np
import pytest

from lqd_envs import SolutionSpace
from lqd_search import LanguageDrivenQD, MethodError, Values
from lqd_search.methods.plus_switches import Switch, emitter_with

SPACE = SolutionSpace()
FIELDS = {"contact": ((6,), np.float64), "expert": ((), np.bool_)}
EACH = [(switch,) for switch in Switch]
ALL = tuple(Switch)


def evaluate(solutions):
    """A motion touches what it starts near of, and succeeds if it then goes up far enough."""
    away = np.linalg.norm(solutions[:, :3], axis=1)
    valid = solutions[:, 2] > -0.6
    touches = valid & (away < 0.9)
    place = np.where(valid[:, None], solutions[:, :2], np.nan)
    return Values(
        valid=valid,
        success=touches & (solutions[:, 8] > 0.5),
        fitness={
            "near": np.where(valid, -away, np.nan),
            "up": np.where(valid, solutions[:, 8], np.nan),
        },
        measures={
            "start.place": place,
            "touch.place": np.where(touches[:, None], solutions[:, 3:5], np.nan),
            "start.one": np.where(valid[:, None], [[1.0, 2.0]], np.nan),
        },
        passive={"expert": touches & (solutions[:, 8] > 0.6)},
        perceived={"contact": np.where(touches[:, None], solutions[:, :6], np.nan)},
    )


def new_method(switches, *, seed=0, **options):
    return LanguageDrivenQD(
        SPACE,
        descriptors={"start.place": 2, "touch.place": 2, "start.one": 2},
        fitness_names=("near", "up"),
        evaluations=1021,
        batch_size=51,
        rng=np.random.default_rng(seed),
        passive_fields=FIELDS,
        minimum=16,
        cells=400,
        **({"emitter": emitter_with(switches, space=SPACE)} | options),
    )


def step(method):
    solutions = method.ask()
    method.tell(evaluate(solutions))
    return solutions


def finish(method):
    generations = []
    while not method.done:
        generations.append(step(method))
    return generations


def in_bytes(generations):
    return np.concatenate(generations).tobytes()


def test_with_no_switch_it_is_the_emitter_of_ours():
    ours = in_bytes(finish(new_method((), emitter=None)))
    assert in_bytes(finish(new_method(()))) == ours


@pytest.mark.parametrize("switches", [*EACH, ALL], ids=str)
def test_every_switch_asks_for_feasible_solutions_of_its_own(switches):
    method = new_method(switches)
    generations = finish(method)
    assert SPACE.feasible(np.concatenate(generations)).all()
    assert sum(map(len, generations)) == 1021
    assert in_bytes(generations) != in_bytes(finish(new_method(())))
    assert in_bytes(generations) == in_bytes(finish(new_method(switches[::-1])))
    assert method.output()["success"].any()


@pytest.mark.parametrize("generations", [1, 2, 5, 9])
@pytest.mark.parametrize("switches", [*EACH, ALL], ids=str)
def test_pickled_in_the_middle_it_goes_on_bit_for_bit(switches, generations):
    method = new_method(switches)
    for _ in range(generations):
        step(method)
    twin = pickle.loads(pickle.dumps(method))
    for _ in range(5):
        assert step(method).tobytes() == step(twin).tobytes()


def named_in(pickled):
    names = set()

    class Noting(pickle.Unpickler):
        def find_class(self, module, name):
            names.add(f"{module}.{name}")
            return super().find_class(module, name)

    Noting(io.BytesIO(pickled)).load()
    return names


def test_a_pickle_names_no_function_that_could_do_harm():
    method = new_method(ALL)
    for _ in range(8):
        step(method)
    names = named_in(pickle.dumps(method))
    assert not [name for name in names if name.startswith("builtins.") and "getattr" in name]
    assert not [name for name in names if "KDTree" in name]
    known = ("lqd_envs.solution_space.", "lqd_search.", "numpy", "ribs.")
    assert not [name for name in names if not name.startswith(known)]


def test_no_passive_column_steers():
    def run(wrong):
        method = new_method(ALL)
        asked = []
        while not method.done:
            asked.append(method.ask())
            values = evaluate(asked[-1])
            passive = {"expert": values.passive["expert"] ^ wrong}
            method.tell(dataclasses.replace(values, passive=passive))
        return in_bytes(asked)

    assert run(wrong=False) == run(wrong=True)


def test_a_small_run_with_all_switches_comes_out_as_ever():
    # Rounded, so that it is the same everywhere; CMA-ES rests on LAPACK and is left out.
    switches = set(Switch) - {Switch.EVOLUTION}
    asked = np.concatenate(finish(new_method(switches, seed=7)))
    rounded = np.round(asked * 1e6).astype("<i8")
    assert hashlib.sha256(rounded.tobytes()).hexdigest()[:16] == "3b382a8c5c499d30"


def test_a_misspelt_switch_is_refused():
    with pytest.raises(
        MethodError, match=r"among line, random, credit, screen, .* but got 'lime';"
    ):
        emitter_with({"lime"}, space=SPACE)
