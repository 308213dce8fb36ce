"""What a process computes with: the processes that a run is spread over must have it in common."""

import platform
from collections.abc import Mapping
from functools import cache
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path

from lqd_search.runs.run_config import installed_versions

OWN_PACKAGES = ("lqd_envs", "lqd_search", "lqd_llm")
"""The packages of this project, of which the sources are compared: many have the same version."""

_CPU_INFO = Path("/proc/cpuinfo")


# Once in a process: sources that are changed later are not those that it has loaded.
@cache
def installation() -> Mapping[str, str]:
    """Return what the results of this process depend on, other than its processor.

    Returns:
        The versions of `installed_versions`, and for each of `OWN_PACKAGES` the digest of its
        sources. Any Python can unpickle it, whatever is installed there.
    """
    return installed_versions() | {name: _digest_of_package(name) for name in OWN_PACKAGES}


def sources_digest(folder: Path) -> str:
    """Return the SHA-256 of a package's sources, their names and what they hold.

    Args:
        folder: The package's folder; its `*.py` files count, also those in folders within.
    """
    digest = sha256()
    for name in sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*.py")):
        for part in (name.encode(), (folder / name).read_bytes()):
            digest.update(sha256(part).digest())
    return digest.hexdigest()


def processor() -> str:
    """Return the architecture and, where the system tells it, the name of this processor."""
    return f"{platform.machine()} {processor_name()}".rstrip()


def processor_name() -> str:
    """Return the name of this processor; empty where the system does not tell it."""
    # Linux alone says nothing of it through `platform`.
    lines = _CPU_INFO.read_text().splitlines() if _CPU_INFO.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else ""


def _digest_of_package(name: str) -> str:
    # Finding it does not import it, which for lqd_llm needs further packages.
    spec = find_spec(name)
    if spec is None or spec.origin is None:
        return "none"
    return sources_digest(Path(spec.origin).parent)
