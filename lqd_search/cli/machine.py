"""What this machine and its Python are, as `lqd doctor` says it."""

import os
import platform
import sys
from importlib.metadata import PackageNotFoundError, version

from lqd_envs.rendering_backend import has_display
from lqd_search.cli.install import INSTALL_ALL
from lqd_search.runs.run_config import installed_versions

_INFERENCE = ("anthropic", "pydantic")
_KEYS = ("ANTHROPIC_API_KEY", "ANTHROPIC_AUTH_TOKEN")


def machine_facts() -> list[tuple[str, str]]:
    """Return what each thing is called, and how it is here.

    Whether there is a key for the language model is said, never the key itself.

    Raises:
        PackageNotFoundError: A package that every command needs is not installed.
    """
    versions = installed_versions()
    return [
        ("Python", f"{versions.pop('python')} ({sys.executable})"),
        *versions.items(),
        ("system", f"{platform.system()} {platform.release()} on {platform.machine()}"),
        ("CPUs", _cpus()),
        ("rendering", _rendering()),
        ("extra llm", _extra()),
        ("API key", _key()),
    ]


def _cpus() -> str:
    there = os.cpu_count() or 1
    usable = len(os.sched_getaffinity(0)) if sys.platform == "linux" else there
    return f"{usable}" if usable == there else f"{usable} of {there}"


def _rendering() -> str:
    backend = os.environ.get("MUJOCO_GL")
    if backend:
        return f"{backend} (MUJOCO_GL)"
    if has_display():
        return "on the display"
    return "none: motions are simulated, pictures and videos fail"


def _extra() -> str:
    missing, there = [], []
    for name in _INFERENCE:
        try:
            there.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            missing.append(name)
    if missing:
        return f"not installed ({', '.join(missing)}); {INSTALL_ALL}"
    return f"installed ({', '.join(there)})"


def _key() -> str:
    found = [name for name in _KEYS if os.environ.get(name)]
    return (
        f"set ({found[0]})"
        if found
        else f"not set ({_KEYS[0]}); only --llm live and --llm record need one"
    )
