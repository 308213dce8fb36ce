"""Pictures of a simulation: arrays without a display, a window with one."""

import os
import time
import warnings
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from lqd_envs.action import CONTROL_STEP
from lqd_envs.errors import LQDError
from lqd_envs.rendering_backend import DISPLAY_VARIABLES, has_display
from lqd_envs.scenes.workspace import CAMERA


class RenderingError(LQDError):
    """A picture was asked for where none can be drawn."""


class ArrayRenderer:
    """Draws a simulation into RGB arrays.

    Args:
        model: The scene.
        width: Pixels.
        height: Pixels.

    Raises:
        RenderingError: There is no OpenGL here; the message says what to install.
    """

    def __init__(self, model: mujoco.MjModel, *, width: int, height: int) -> None:
        try:
            # GLFW warns before MuJoCo raises; the error below says it all.
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                self._renderer = mujoco.Renderer(model, height=height, width=width)
        # What is raised depends on the backend and on what exactly it misses.
        except (mujoco.FatalError, ImportError, AttributeError, OSError, RuntimeError) as error:
            raise RenderingError(
                "expected OpenGL to draw a picture with, but MuJoCo could not use it "
                f"(MUJOCO_GL={os.environ.get('MUJOCO_GL', '')!r}: {error}): without a display "
                "install EGL (on Debian and Ubuntu `apt-get install libegl1 libgl1`) and import "
                "lqd_envs before mujoco, or set MUJOCO_GL=egl before Python starts; everything but "
                "pictures works without it"
            ) from error

    def render(self, data: mujoco.MjData) -> NDArray[np.uint8]:
        """Return a (height, width, 3) uint8 picture of `data`."""
        self._renderer.update_scene(data, camera=CAMERA)
        return np.asarray(self._renderer.render())

    def close(self) -> None:
        """Free the OpenGL context."""
        self._renderer.close()


class WindowRenderer:
    """Shows a simulation in MuJoCo's interactive viewer.

    Args:
        model: The scene.
        data: The simulation to show, which goes on being the caller's.

    Raises:
        RenderingError: There is no display.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        if not has_display():
            raise RenderingError(
                'expected a display for render_mode="human", got none '
                f"({' and '.join(DISPLAY_VARIABLES)} are not set): use "
                'render_mode="rgb_array", or run where there is a screen'
            )
        import mujoco.viewer

        self._viewer: Any = mujoco.viewer.launch_passive(
            model, data, show_left_ui=False, show_right_ui=False
        )
        self._next_frame = time.monotonic()

    def render(self) -> None:
        """Show the simulation as it is now, no faster than it would happen."""
        self._viewer.sync()
        now = time.monotonic()
        self._next_frame = max(self._next_frame + CONTROL_STEP, now)
        time.sleep(self._next_frame - now)

    def close(self) -> None:
        """Close the window."""
        self._viewer.close()
