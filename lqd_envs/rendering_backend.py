"""The choice of an OpenGL backend, apart from everything that imports mujoco."""

import ctypes
import os
import sys

DISPLAY_VARIABLES = ("DISPLAY", "WAYLAND_DISPLAY")


def has_display() -> bool:
    """Return whether a window can be opened, as far as the environment tells."""
    return sys.platform != "linux" or any(os.environ.get(name) for name in DISPLAY_VARIABLES)


def choose_headless_backend() -> None:
    """Let MuJoCo draw through EGL where there is no display, unless the user chose a backend.

    It has an effect only before mujoco is first imported. Where EGL is missing too, nothing is
    changed: MuJoCo then simulates as ever, and only pictures fail.
    """
    if has_display() or "MUJOCO_GL" in os.environ:
        return
    # With EGL chosen but no OpenGL beside it, importing mujoco fails.
    if _loads("libEGL.so.1") and (_loads("libOpenGL.so.0") or _loads("libGL.so.1")):
        os.environ["MUJOCO_GL"] = "egl"


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True
