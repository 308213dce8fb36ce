"""A task as a Gymnasium environment."""

import copy
from collections.abc import Mapping
from typing import Any

import gymnasium as gym
import mujoco
import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike, NDArray

from lqd_envs.action import ACTION_DIM, CONTROL_STEP
from lqd_envs.discarded import spoils
from lqd_envs.errors import LQDError
from lqd_envs.inputs import checked_action, checked_options, checked_render_mode, checked_size
from lqd_envs.instances.instance import Instance, task_of
from lqd_envs.observation import Observation
from lqd_envs.perception import Columns
from lqd_envs.rendering import ArrayRenderer, WindowRenderer
from lqd_envs.reward import get_reward
from lqd_envs.scene import load_scene
from lqd_envs.start_arm import checked_arm, checked_start_arm, overlap_error

MAX_EPISODE_STEPS = 150
"""Length of a registered env's episode in control steps (3 s): two motion primitives."""


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
    and whether the gripper touches each link of the object: 33 numbers for grasp and push, 35 for
    the drawer, 37 for the faucet. `env.unwrapped.observation_names` lists them one by one.

    ## Info

    The eight keys of the perception API (`lqd_envs.Info`) and two bools:

    * `is_success`: the expert's word on the present moment; False where `discarded` is True.
    * `discarded`: whether anything since the reset was what no real contact does, or what a real
      robot would have stopped at: two bodies more than 3 mm inside each other, the object's
      farthest point faster than 2 m/s, a simulation that diverged, or the robot at an obstacle. It
      is looked at after each control step, and within the limits of `lqd_envs.rollout`.

    ## Reward

    `reward="sparse"`: 1 where `is_success` holds, 0 elsewhere. `reward="dense"`: 1 where it holds;
    elsewhere half of a nearness in [0, 1], of which a quarter is exp(-d / 0.1 m) for the distance d
    from the gripper to what it should touch, and three quarters are the share of the task that is
    done (the task's page says what that is). Both are 0 from the step on at which `discarded`
    becomes True.

    A success is of the moment: a mug that a bump lifts off the table for one control step, while
    the gripper touches it, is rewarded at that step. Judge a policy by `is_success` at the end of
    the episode, as motions are judged.

    ## Start

    The arm above the table with open fingers, the object at rest, everything still; every start
    is the same. `reset(options={"arm": [...]})` starts from seven joint positions of one's own
    (rad), and the argument `start_arm` makes them the usual start: within the joint limits, with
    hand, fingers and links 6 and 7 outside table and object, and no link in an obstacle.

    ## End

    An episode never terminates. It is truncated after 150 control steps, by the `TimeLimit` that
    `gymnasium.make` puts around the env (one that is built by `ManipulationEnv(...)` itself goes
    on), or as soon as the simulation diverges; MuJoCo then starts over from its default state, and
    `discarded` is True.

    ## Simulation

    `env.unwrapped.model` and `env.unwrapped.data` are the `mujoco.MjModel` and `mujoco.MjData` of
    this env alone (25 MB for the model): what you change in them changes no other env. Frictions,
    masses and gains may be changed; the physics step and the number of anything must stay.

    ## Arguments

    * `task`: id of the task.
    * `instance`: an `lqd_envs.instances.Instance` of the task, the dictionary of one, or None. Its
      scene is simulated, and a success is what it calls one. Once the robot has touched one of its
      obstacles, the episode is discarded.
    * `start_arm`: seven joint positions (rad) of the usual start, or None for the arm above the
      table.
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
        start_arm: ArrayLike | None = None,
        reward: str = "sparse",
        render_mode: str | None = None,
        width: int = 640,
        height: int = 480,
    ) -> None:
        self.render_mode = checked_render_mode(render_mode, known=self.metadata["render_modes"])
        self._size = checked_size(width, height)
        self._scene = load_scene(task_of(task, instance))
        self._start_arm = checked_start_arm(start_arm, scene=self._scene)
        self._reward = get_reward(reward)
        self._layout = Observation.of(self._scene)
        self._renderer: ArrayRenderer | None = None
        self._window: WindowRenderer | None = None
        self._start_sensordata: NDArray[np.float64] | None = None
        self._discarded = False
        # The scene's own is shared by all that simulate the task.
        self.model = copy.copy(self._scene.model)
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
        given = checked_options(options, known=("arm",))
        arm = checked_arm(given.get("arm", self._start_arm), scene=self._scene)
        self._start_sensordata = None
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:] = self._scene.start_qpos(arm)
        mujoco.mj_forward(self.model, self.data)
        if self._scene.sensors.robot_touches(self.data.sensordata):
            raise overlap_error(usual="arm" not in given)
        self._start_sensordata = self.data.sensordata.copy()
        self._discarded = bool(spoils(self._scene.sensors, self.data.sensordata))
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
        start = self._require_started("step")
        self.data.ctrl[:] = self._scene.action_map.controls(checked_action(action))
        mujoco.mj_step(self.model, self.data, nstep=self._scene.substeps)
        # Sensors describe the state before the last substep; this makes them current, and the
        # next step goes on from it without computing anything twice.
        mujoco.mj_step1(self.model, self.data)
        if self.render_mode == "human":
            self.render()
        diverged = bool(np.any(self.data.warning.number))
        spoiled = bool(spoils(self._scene.sensors, self.data.sensordata))
        self._discarded = self._discarded or diverged or spoiled
        observation, columns, info = self._observe(start)
        reward = 0.0 if self._discarded else float(self._reward(self._scene.task, columns)[0])
        return observation, reward, False, diverged, info

    def render(self) -> NDArray[np.uint8] | None:
        """Return a picture (`rgb_array`), show the window (`human`), or do nothing.

        Returns:
            (height, width, 3) uint8, or None.

        Raises:
            LQDError: `reset` was not called.
            RenderingError: There is nothing here to draw with.
        """
        if self.render_mode is not None:
            self._require_started("render")
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

    def _require_started(self, caller: str) -> NDArray[np.float64]:
        if self._start_sensordata is None:
            raise LQDError(f"expected reset() before the first {caller}(): call env.reset() once")
        return self._start_sensordata

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
        info["is_success"] = bool(self._scene.task.success(columns)[0]) and not self._discarded
        info["discarded"] = self._discarded
        return observation, columns, info
