"""What a benchmark runs on, in a few words."""

import os
import platform
import subprocess
from pathlib import Path

from lqd_search.evaluation.installation import processor_name


def describe_machine() -> str:
    """Return system, processor and number of CPUs, and nothing that tells whose machine it is."""
    processor = processor_name() or platform.processor() or "unknown processor"
    return f"{platform.system()} {platform.machine()}, {processor}, {usable_cpus()} CPUs"


def describe_commit() -> str:
    """Return the commit of these sources, with a `+` where they were changed since.

    It is empty where there is no git, or where the sources are not in a repository.
    """
    here = Path(__file__).parent
    try:
        head = _git("rev-parse", "--short=12", "HEAD", folder=here)
        changes = _git("status", "--porcelain", "--untracked-files=no", folder=here)
    except (OSError, subprocess.CalledProcessError):
        return ""
    return f"{head}+" if changes else head


def usable_cpus() -> int:
    """Return how many CPUs this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _git(*arguments: str, folder: Path) -> str:
    return subprocess.run(
        ["git", *arguments], cwd=folder, check=True, capture_output=True, text=True
    ).stdout.strip()
