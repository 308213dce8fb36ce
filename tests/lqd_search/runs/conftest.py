"""A run that is recorded without a simulator."""

from dataclasses import dataclass

import numpy as np
import pytest

from lqd_envs import SolutionSpace, Verdict, get_task
from lqd_search import LanguageDrivenQD, Values
from lqd_search.evaluation.motion_evaluator import passive_fields
from lqd_search.loop import search
from lqd_search.methods.random_search import RandomSearch
from lqd_search.runs.function_text import FunctionText
from lqd_search.runs.run_config import RunConfig
from lqd_search.runs.run_folder import RunFolder
from lqd_search.runs.run_recorder import RunRecorder
from lqd_search.runs.run_state import RunState

TASK = get_task("LQD/Faucet-v0")


class EnoughError(Exception):
    """A run was stopped in its middle."""


def evaluate(solutions):
    """Values for any motions, as if an object stood beside the centre."""
    distance = np.linalg.norm(solutions[:, :3] - 0.5, axis=1)
    valid = solutions[:, 2] > -0.5
    success = valid & (distance < 0.5)
    return Values(
        valid=valid,
        success=success,
        fitness={"near": np.where(valid, -distance, np.nan), "flat": np.where(valid, 0.0, np.nan)},
        measures={
            "end.place": np.where(valid[:, None], solutions[:, :2], np.nan),
            "end.motion": np.where(valid[:, None], solutions[:, 6:8], np.nan),
        },
        passive={
            "expert": success & (solutions[:, 0] > 0.3),
            "ground_truth": np.where(valid, distance, np.nan)[:, None],
            "digest": (distance * 1e9).astype(np.uint64),
            "verdict": np.where(valid, Verdict.VALID, Verdict.UNREACHABLE).astype(np.uint8),
        },
    )


@dataclass
class RecordedRun:
    """A run of a method that searches by `evaluate`."""

    folder: RunFolder
    state: RunState

    def record(self, *, generations=10_000, on_generation=lambda _: None):
        """Go on from the last checkpoint until that many generations are done, or to the end."""
        state = self.folder.state.load() or self.state

        def note(metrics):
            on_generation(metrics)
            if metrics.generation == generations:
                raise EnoughError

        recorder = RunRecorder(
            self.folder,
            task=TASK,
            state=state,
            on_generation=note,
            on_refusal=lambda *_: None,
            on_stopped=lambda _: None,
        )
        try:
            search(state.method, evaluate, observe=recorder.observe)
        except EnoughError:
            return state
        recorder.finish()
        return state


def _ours(evaluations, *, minimum=16):
    return LanguageDrivenQD(
        SolutionSpace(),
        descriptors={"end.place": 2, "end.motion": 2},
        fitness_names=("near", "flat"),
        evaluations=evaluations,
        batch_size=32,
        rng=np.random.default_rng(3),
        passive_fields=passive_fields(TASK),
        minimum=minimum,
        cells=25,
    )


def _random(evaluations):
    return RandomSearch(
        SolutionSpace(),
        fitness="near",
        evaluations=evaluations,
        batch_size=32,
        rng=np.random.default_rng(3),
        passive_fields=passive_fields(TASK),
    )


METHODS = {"ours": _ours, "random": _random}


@pytest.fixture
def new_run(tmp_path):
    def make(name="run", *, method="ours", evaluations=640, **options):
        config = RunConfig(
            task=TASK.id,
            instruction=TASK.instruction,
            method=method,
            seed=3,
            sample=0,
            evaluations=evaluations,
            batch_size=32,
            explored=2,
            failure_competition="fitness",
            llm="folder",
            prompt_hashes={},
            model="none",
            provenance="written by hand",
            functionals="abc",
            lengths={},
        )
        text = FunctionText("success", "success", "Whether it is near.", "def success(infos): ...")
        folder = RunFolder.create(tmp_path / name, config=config, functionals=[text])
        return RecordedRun(folder, RunState(config, METHODS[method](evaluations, **options)))

    return make
