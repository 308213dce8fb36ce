"""Every layer holds on this machine, and the probes would notice if one did not."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from lqd_llm.sandbox import layers as module
from lqd_llm.sandbox import start
from lqd_llm.sandbox.layers import LAYERS, probe_layers

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the layers are Linux's")

# Locks a child of its own as a worker locks itself, and makes one attempt; prints what came of it.
ATTEMPTS = """
import ctypes, mmap, os, signal, socket, subprocess, sys
from lqd_llm.sandbox.worker import _lock
from lqd_llm.sandbox.wire import Order

libc = ctypes.CDLL(None, use_errno=True)
PTRACE = {"x86_64": 101, "aarch64": 117}[os.uname().machine]

def call(number, *arguments):
    if libc.syscall(number, *arguments) < 0:
        raise OSError(ctypes.get_errno(), "failed")

ATTEMPTS = {
    "nothing": lambda: None,
    "calculate": lambda: [i * i for i in range(100_000)],
    "open": lambda: os.open("/etc/hostname", os.O_RDONLY),
    "create": lambda: os.open("/tmp/sandbox_canary", os.O_CREAT | os.O_WRONLY),
    "list": lambda: os.listdir("/"),
    "mkdir": lambda: os.mkdir("sandbox_canary"),
    "unlink": lambda: os.unlink("/tmp/nothing"),
    "stat": lambda: os.stat("/"),
    "chdir": lambda: os.chdir("/tmp"),
    "memfd": lambda: os.memfd_create("x"),
    "pipe": lambda: os.pipe(),
    "socket": lambda: socket.socket(),
    "fork": lambda: os.fork(),
    "exec": lambda: os.execv(sys.executable, [sys.executable, "-c", ""]),
    "spawn": lambda: subprocess.run([sys.executable, "-c", ""]),
    "signal": lambda: os.kill(os.getppid(), signal.SIGTERM),
    "ptrace": lambda: call(PTRACE, 16, os.getppid(), 0, 0),
    "executable": lambda: mmap.mmap(-1, 4096, prot=mmap.PROT_READ | mmap.PROT_EXEC),
    "memory": lambda: bytearray(256 << 20),
    "stdout": lambda: os.write(1, b"text"),
    "stderr": lambda: os.write(2, b"text"),
    "import": lambda: __import__("xml.dom.minidom"),
    "rights": lambda: os.setuid(1),
}
names = sys.argv[1:]
for name in names:
    sys.stdout.flush()
    child = os.fork()
    if child == 0:
        answers = os.dup2(1, 3)
        _lock(Order(0, (0, 0), (0, 0), 64 << 20))
        try:
            ATTEMPTS[name]()
        except BaseException as error:
            os.write(answers, f"{name} {type(error).__name__}\\n".encode())
        else:
            os.write(answers, f"{name} done\\n".encode())
        os._exit(0)
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        print(name, signal.Signals(os.WTERMSIG(status)).name)
"""
EXPECTED = {
    **dict.fromkeys(("nothing", "calculate"), "done"),
    **dict.fromkeys(("open", "create", "list", "mkdir", "unlink"), "PermissionError"),
    **dict.fromkeys(("stat", "chdir", "memfd", "signal", "executable"), "PermissionError"),
    **dict.fromkeys(("stdout", "stderr", "rights", "pipe", "import"), "PermissionError"),
    **dict.fromkeys(("socket", "fork", "exec", "ptrace"), "SIGSYS"),
    "memory": "MemoryError",
    # It needs a pipe before it starts anything.
    "spawn": "PermissionError",
}

# Puts nothing on, and probes all the same.
WITHOUT = """
import os, sys
from lqd_llm.sandbox import probe
for name in ("apply_landlock", "apply_seccomp", "drop_capabilities"):
    setattr(probe, name, lambda **_: None)
probe.apply_rlimits = lambda memory, files: None
probe.main({"layer": sys.argv[1], "columns": (0, 0), "environment": []})
os._exit(0)
"""


def test_every_layer_holds_here():
    layers = probe_layers()
    assert {layer.name: layer.why_not for layer in layers} == dict.fromkeys(LAYERS, "")
    assert all(layer.active and layer.purpose == LAYERS[layer.name] for layer in layers)


@pytest.mark.parametrize("layer", ["process", "capabilities", "rlimits", "landlock", "seccomp"])
def test_a_probe_notices_a_layer_that_is_not_there(layer):
    if layer == "capabilities" and os.geteuid() != 0:
        pytest.skip("only a superuser has capabilities to lose")
    said = _python(WITHOUT, layer)
    assert "it does not hold" in said.splitlines()[-1]


def test_without_a_process_nothing_is_known_to_hold(monkeypatch):
    def refuse(*_, **__):
        raise BlockingIOError(11, "Resource temporarily unavailable")

    monkeypatch.setattr(module.subprocess, "run", refuse)

    assert {layer.why_not for layer in probe_layers()} == {
        "no process starts to try it ([Errno 11] Resource temporarily unavailable)"
    }
    assert not any(layer.active for layer in probe_layers())


def test_what_a_worker_cannot_do():
    said = _python(ATTEMPTS, *EXPECTED)
    assert dict(line.split() for line in said.splitlines()) == EXPECTED


_LIKE_A_WORKER = f"""
import sys
sys.path.insert(0, {str(Path(start.__file__).parent)!r})
import start
start.know_package(
    {start.__name__.rpartition(".")[0]!r},
    folder=sys.path.pop(0),
    libraries={str(Path(np.__file__).parent.parent)!r},
)
"""


def _python(code, *arguments):
    run = subprocess.run(
        [sys.executable, "-S", "-c", _LIKE_A_WORKER + code, *arguments],
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert run.stdout, run.stderr
    return run.stdout
