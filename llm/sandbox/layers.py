"""The layers of the sandbox, and which of them hold on this machine."""

import signal
import subprocess
from dataclasses import dataclass

from lqd_llm.sandbox.probe import HELD, LAST
from lqd_llm.sandbox.process import ENVIRONMENT, start_command
from lqd_llm.sandbox.shared_memory import SharedMemory

LAYERS = {
    "process": "a process of its own, without the user's environment, terminal and open files",
    "columns": "columns that can be read and not written to",
    "capabilities": "no rights of a superuser, and no way to gain any",
    "rlimits": "limits on memory, files and CPU time",
    "landlock": "no file or folder can be opened, made or removed, and no port",
    "seccomp": "no system call but those that calculating needs",
}
"""What each layer is for, by name."""

_SECONDS = 60


@dataclass(frozen=True)
class Layer:
    """One layer of the sandbox on this machine.

    Attributes:
        name: Its name, one of `LAYERS`.
        purpose: What it is for.
        active: Whether it holds; it was tried.
        why_not: Why it does not; empty if it does.
    """

    name: str
    purpose: str
    active: bool
    why_not: str = ""


def probe_layers() -> tuple[Layer, ...]:
    """Try each layer in a process of its own: lock it in, and do what must now fail.

    Raises:
        SandboxError: Python does not know its own interpreter, or there is no memory to share.
    """
    columns = SharedMemory("lqd-probe", size=4096, writable=False)
    columns.memory[0] = 1
    try:
        return tuple(_probe(name, purpose, columns) for name, purpose in LAYERS.items())
    finally:
        columns.close()


def _probe(name: str, purpose: str, columns: SharedMemory) -> Layer:
    shared = name == "columns"
    order = {
        "layer": name,
        "columns": (columns.file, columns.size),
        "environment": list(ENVIRONMENT),
    }
    try:
        probe = subprocess.run(
            start_command("probe", order),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            check=False,
            text=True,
            timeout=_SECONDS,
            pass_fds=(columns.file,) if shared else (),
            env=ENVIRONMENT,
            cwd="/",
            start_new_session=True,
        )
    except subprocess.TimeoutExpired:
        return Layer(name, purpose, active=False, why_not=f"trying it took over {_SECONDS} s")
    except OSError as error:
        return Layer(name, purpose, active=False, why_not=f"no process starts to try it ({error})")
    said = probe.stdout.split("\n")[-2] if "\n" in probe.stdout else ""
    # The last thing that seccomp forbids ends the process.
    if said == HELD or (said == LAST and probe.returncode == -signal.SIGSYS):
        return Layer(name, purpose, active=True)
    why = said or (probe.stderr.strip().splitlines() or [f"it ended with {probe.returncode}"])[-1]
    return Layer(name, purpose, active=False, why_not=why)
