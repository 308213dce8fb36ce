"""The choice of an OpenGL backend, apart from everything that imports mujoco."""

import ctypes
import os
import sys

DISPLAY_VARIABLES = ("DISPLAY", "WAYLAND_DISPLAY")


def choose_headless_backend() -> None:
    """Let MuJoCo draw through EGL where there is no display, unless the user chose a backend.

    It has an effect only before mujoco is first imported. Where EGL is missing too, nothing is
    changed: MuJoCo then simulates as ever, and only pictures fail.
    """
    has_display = any(os.environ.get(name) for name in DISPLAY_VARIABLES)
    if sys.platform != "linux" or has_display or "MUJOCO_GL" in os.environ:
        return
    try:
        ctypes.CDLL("libEGL.so.1")
    except OSError:
        return
    os.environ["MUJOCO_GL"] = "egl"
