"""A task as a Gymnasium environment."""

from collections.abc import Mapping
from typing import Any

import gymnasium as gym
import mujoco
import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike, NDArray

from lqd_envs.action import ACTION_DIM, CONTROL_STEP
from lqd_envs.errors import LQDError
from lqd_envs.inputs import (
    checked_action,
    checked_arm,
    checked_size,
    overlap_error,
    require_known_options,
)
from lqd_envs.instances.instance import Instance, task_of
from lqd_envs.observation import Observation
from lqd_envs.perception import Columns
from lqd_envs.rendering import ArrayRenderer, WindowRenderer
from lqd_envs.reward import get_reward
from lqd_envs.scene import load_scene
from lqd_envs.scenes.panda import HOME

MAX_EPISODE_STEPS = 150
"""Length of an episode in control steps (3 s): twice that of a motion primitive."""


class ManipulationEnv(gym.Env[NDArray[np.float64], NDArray[np.float32]]):
    """A Franka Panda arm at a table, with one object and one task.

    ## Description

    The robot's base is at the origin of the world frame, x pointing away from it, y to its left,
    z up; the table top is the plane z = 0. On the table is one object, half a metre before the
    robot:

    * `LQD/Grasp-v0`, a mug: "Grasp the mug". Success: it touches the gripper and not the table.
    * `LQD/Faucet-v0`, a faucet with a hot and a cold tap: "Turn on the hot water". Success: the
      hot tap is turned by at least 0.314 rad.
    * `LQD/Drawer-v0`, a chest with a drawer: "Open the drawer at least 10cm". Success: the drawer
      is out by at least 0.10 m.
    * `LQD/Push-v0`, the same mug: "Slide the mug on the table at least 5cm". Success: the mug is
      on the table, its base at least 0.05 m from where it stood, horizontally.

    ## Action space

    `Box(-1, 1, (8,), float32)`, mapped affinely; values outside are clipped. A control step lasts
    20 ms.

    | entry | target of | at -1 | at +1 | unit |
    |---|---|---|---|---|
    | 0 | arm joint 1 | -2.8973 | 2.8973 | rad |
    | 1 | arm joint 2 | -1.7628 | 1.7628 | rad |
    | 2 | arm joint 3 | -2.8973 | 2.8973 | rad |
    | 3 | arm joint 4 | -3.0718 | -0.4 | rad |
    | 4 | arm joint 5 | -2.8973 | 2.8973 | rad |
    | 5 | arm joint 6 | -1.6573 | 2.1127 | rad |
    | 6 | arm joint 7 | -2.8973 | 2.8973 | rad |
    | 7 | each finger; below 0 they squeeze | -0.01 | 0.04 | m |

    ## Observation space

    A `Box` of float64 with finite bounds: positions (rad) and velocities (rad/s) of the seven arm
    joints, positions of the two fingers (m), gripper position (m, the midpoint between the
    fingertips) and quaternion (w >= 0 first), the same of the object's base, positions of the
    object's joints (rad or m), and, as 0 or 1, whether the object and the robot touch the table
    and whether the gripper touches each link of the object. `env.unwrapped.observation_names`
    lists them one by one.

    ## Info

    The eight keys of the perception API (`lqd_envs.Info`) and `is_success`, the expert's word on
    the present moment, a bool.

    ## Reward

    `reward="sparse"`: 1 where `is_success` holds, 0 elsewhere. `reward="dense"`: 1 where it holds;
    elsewhere half of a nearness in [0, 1], of which a quarter is exp(-d / 0.1 m) for the distance d
    from the gripper to what it should touch, and three quarters are the share of the task that is
    done (the task's page says what that is).

    ## Start

    The arm above the table with open fingers, the object at rest, everything still; every start
    is the same. `reset(options={"arm": [...]})` starts from seven joint positions of one's own
    (rad): within the joint limits, and with nothing of the robot inside table or object.

    ## End

    An episode never terminates. It is truncated after 150 control steps, or as soon as the
    simulation diverges; MuJoCo then starts over from its default state, and `is_success` is False.

    ## Arguments

    * `task`: id of the task.
    * `instance`: an `lqd_envs.instances.Instance` of the task, the dictionary of one, or None. Its
      scene is simulated, and a success is what it calls one. Once the robot has touched one of its
      obstacles, there is no success and no reward until the next reset.
    * `reward`: `"sparse"` or `"dense"`.
    * `render_mode`: `"rgb_array"`, `"human"` or None.
    * `width`, `height`: size of the pictures in pixels.

    ## Version history

    * v0: first version.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 - Gymnasium's contract
        "render_modes": ["human", "rgb_array"],
        "render_fps": round(1.0 / CONTROL_STEP),
    }

    def __init__(
        self,
        task: str = "LQD/Faucet-v0",
        *,
        instance: Instance | Mapping[str, Any] | None = None,
        reward: str = "sparse",
        render_mode: str | None = None,
        width: int = 640,
        height: int = 480,
    ) -> None:
        if render_mode is not None and render_mode not in self.metadata["render_modes"]:
            raise LQDError(
                f"expected render_mode to be one of {self.metadata['render_modes']} or None, "
                f"got {render_mode!r}"
            )
        self.render_mode = render_mode
        self._size = checked_size(width, height)
        self._scene = load_scene(task_of(task, instance))
        self._reward = get_reward(reward)
        self._layout = Observation.of(self._scene)
        self._renderer: ArrayRenderer | None = None
        self._window: WindowRenderer | None = None
        self._start_sensordata: NDArray[np.float64] | None = None
        self._obstructed = False
        self.model = self._scene.model
        self.data = mujoco.MjData(self.model)
        self.action_space = spaces.Box(-1.0, 1.0, (ACTION_DIM,), np.float32)
        self.observation_space = spaces.Box(self._layout.low, self._layout.high, dtype=np.float64)

    @property
    def observation_names(self) -> tuple[str, ...]:
        """Name and unit of every entry of the observation."""
        return self._layout.names

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float64], dict[str, Any]]:
        """Start an episode.

        Args:
            seed: Seed of the env's random generator.
            options: `{"arm": (7,) joint positions in rad}`, or nothing for the usual start.

        Returns:
            The first observation and info.

        Raises:
            ResetError: An option is unknown, or the arm cannot start there.
        """
        super().reset(seed=seed)
        options = options or {}
        require_known_options(options, known=("arm",))
        arm = checked_arm(options.get("arm", HOME), scene=self._scene)
        self._start_sensordata = None
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:] = self._scene.start_qpos(arm)
        mujoco.mj_forward(self.model, self.data)
        if self._scene.sensors.robot_touches(self.data.sensordata):
            raise overlap_error()
        self._start_sensordata = self.data.sensordata.copy()
        self._obstructed = False
        if self.render_mode == "human":
            self.render()
        observation, _, info = self._observe(self._start_sensordata)
        return observation, info

    def step(
        self, action: ArrayLike
    ) -> tuple[NDArray[np.float64], float, bool, bool, dict[str, Any]]:
        """Simulate one control step of 20 ms.

        Args:
            action: (8,) in [-1, 1].

        Returns:
            Observation, reward, terminated (never), truncated (where the simulation diverged)
            and info.

        Raises:
            LQDError: The action has another shape or is not finite, or `reset` was not called.
        """
        if self._start_sensordata is None:
            raise LQDError("expected reset() before the first step(): call env.reset() once")
        self.data.ctrl[:] = self._scene.action_map.controls(checked_action(action))
        mujoco.mj_step(self.model, self.data, nstep=self._scene.substeps)
        # Sensors describe the state before the last substep; this makes them current, and the
        # next step goes on from it without computing anything twice.
        mujoco.mj_step1(self.model, self.data)
        if self.render_mode == "human":
            self.render()
        observation, columns, info = self._observe(self._start_sensordata)
        diverged = bool(np.any(self.data.warning.number))
        self._obstructed |= bool(self._scene.sensors.robot_touches_obstacle(self.data.sensordata))
        failed = diverged or self._obstructed
        info["is_success"] &= not failed
        reward = 0.0 if failed else float(self._reward(self._scene.task, columns)[0])
        return observation, reward, False, diverged, info

    def render(self) -> NDArray[np.uint8] | None:
        """Return a picture (`rgb_array`), show the window (`human`), or do nothing.

        Returns:
            (height, width, 3) uint8, or None.

        Raises:
            RenderingError: There is nothing here to draw with.
        """
        if self.render_mode == "rgb_array":
            if self._renderer is None:
                width, height = self._size
                self._renderer = ArrayRenderer(self.model, width=width, height=height)
            return self._renderer.render(self.data)
        if self.render_mode == "human":
            if self._window is None:
                self._window = WindowRenderer(self.model, self.data)
            self._window.render()
        return None

    def close(self) -> None:
        """Close the window and free the OpenGL context; a second call does nothing."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None
        if self._window is not None:
            self._window.close()
            self._window = None

    def __getstate__(self) -> dict[str, Any]:
        # An OpenGL context and a window belong to their process; a copy opens its own.
        return {**vars(self), "_renderer": None, "_window": None}

    def _observe(
        self, start: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], Columns, dict[str, Any]]:
        sensordata = self.data.sensordata
        since_start = np.stack([start, sensordata])
        columns = self._scene.sensors.columns(since_start[None])
        observation = self._layout.vector(
            self._scene,
            qpos=self.data.qpos[None],
            qvel=self.data.qvel[None],
            sensordata=sensordata[None],
            columns=columns,
        )[0]
        info: dict[str, Any] = dict(columns.infos(0)[-1])
        info["is_success"] = bool(self._scene.task.success(columns)[0])
        return observation, columns, info
