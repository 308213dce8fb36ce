"""A run folder with an archive that a test made up."""

import pytest

from lqd_envs import get_task
from lqd_search.runs.run_config import RunConfig
from lqd_search.runs.run_folder import ARCHIVE, RunFolder
from lqd_search.runs.stored_archive import StoredArchive


@pytest.fixture
def make_folder(tmp_path):
    """Return a way to make the folder of a run with the columns of its archive."""

    def make(name, fields, *, task, **settings):
        config = RunConfig(
            **{
                "task": task,
                "instruction": get_task(task).instruction,
                "method": "ours",
                "seed": 0,
                "sample": 0,
                "evaluations": 100,
                "batch_size": 10,
                "failure_competition": "fitness",
                "explored": 3,
                "llm": "replay",
                "prompt_hashes": {},
                "model": "a model",
                "provenance": "Made up for a test.",
                "functionals": "",
                "lengths": {},
            }
            | settings
        )
        folder = RunFolder.create(tmp_path / name, config=config, functionals=())
        (folder.path / ARCHIVE).write_bytes(StoredArchive(fields, {}).to_bytes())
        return folder.path

    return make
