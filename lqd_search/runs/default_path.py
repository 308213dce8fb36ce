"""Where a command writes if nobody says so."""

import os
from datetime import datetime
from pathlib import Path

from lqd_envs import Task


def default_path(task: Task, *, parent: str = "runs") -> Path:
    """Return a name that is still free, such as `runs/faucet-20260131-235959`.

    Args:
        task: The task.
        parent: The folder that it is in.
    """
    stem = f"{task.name}-{datetime.now().astimezone():%Y%m%d-%H%M%S}"
    path = Path(parent) / stem
    number = 2
    while os.path.lexists(path):
        path = Path(parent) / f"{stem}-{number}"
        number += 1
    return path
