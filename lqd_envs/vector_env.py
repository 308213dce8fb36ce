"""A task as many environments that are simulated together."""

from collections.abc import Mapping
from typing import Any

import gymnasium as gym
import mujoco
import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from mujoco.batch import Batch
from numpy.typing import ArrayLike, NDArray

from lqd_envs.action import ACTION_DIM, CONTROL_STEP
from lqd_envs.env import MAX_EPISODE_STEPS
from lqd_envs.errors import LQDError
from lqd_envs.inputs import (
    ResetError,
    checked_actions,
    checked_arms,
    checked_count,
    checked_limit,
    checked_mask,
    checked_mode,
    checked_size,
    named_envs,
    overlap_error,
    require_known_options,
)
from lqd_envs.instances.instance import Instance, task_of
from lqd_envs.observation import Observation
from lqd_envs.perception import Columns
from lqd_envs.rendering import ArrayRenderer
from lqd_envs.reward import get_reward
from lqd_envs.scene import load_scene
from lqd_envs.scenes.panda import HOME
from lqd_envs.vector_info import column_infos, final_infos

_NO_STAGE = int(mujoco.mjtStage.mjSTAGE_NONE)
_VEL_STAGE = int(mujoco.mjtStage.mjSTAGE_VEL)

_Bools = NDArray[np.bool_]
_Floats = NDArray[np.float64]


class ManipulationVectorEnv(gym.vector.VectorEnv[_Floats, ArrayLike, NDArray[Any]]):
    """Many `ManipulationEnv`s of one task, simulated together on several threads.

    ## Description

    `gymnasium.make_vec("LQD/Faucet-v0", num_envs=16)` makes one. Spaces, rewards, starts and ends
    are those of `lqd_envs.ManipulationEnv`. Every env gives the same numbers, bit for bit, as a
    single one that is given the same actions, whatever the number of threads.

    ## Info

    Columns instead of a dictionary for each env: positions and orientations are (num_envs, 3)
    float64, contacts and `is_success` (num_envs,) bool. `gripper_contacts` and `joint_positions`
    are dictionaries of (num_envs,) arrays. Beside each key, `_key` is a (num_envs,) bool array of
    the envs that the value is for: all of them, or those that were just reset by a `reset_mask`;
    the others' values are zero.

    ## Autoreset

    | `autoreset_mode` | an env that was truncated |
    |---|---|
    | `NEXT_STEP` | is reset by the next step, which ignores its action and gives it reward 0 |
    | `SAME_STEP` | is reset at once; `final_obs` and `final_info` hold what was before |
    | `DISABLED` | must be reset with a `reset_mask` before the next step |

    An autoreset starts from the usual start.

    ## Options of `reset`

    * `arm`: seven joint positions (rad) for every env, or (num_envs, 7), a row for each.
    * `reset_mask`: (num_envs,) bool array, the envs to reset; the others go on.

    ## Arguments

    * `num_envs`: number of envs.
    * `task`, `instance`, `reward`, `width`, `height`: as in `ManipulationEnv`.
    * `max_episode_steps`: control steps after which an episode is truncated; None or -1: never.
    * `autoreset_mode`: a `gymnasium.vector.AutoresetMode` or its value, such as `"SameStep"`.
    * `render_mode`: `"rgb_array"` or None.
    * `threads`: threads to use; 0: one for each CPU.

    ## Version history

    * v0: first version.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 - Gymnasium's contract
        "render_modes": ["rgb_array"],
        "render_fps": round(1.0 / CONTROL_STEP),
        "autoreset_mode": AutoresetMode.NEXT_STEP,
    }

    def __init__(
        self,
        num_envs: int,
        task: str = "LQD/Faucet-v0",
        *,
        instance: Instance | Mapping[str, Any] | None = None,
        reward: str = "sparse",
        max_episode_steps: int | None = MAX_EPISODE_STEPS,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        render_mode: str | None = None,
        width: int = 640,
        height: int = 480,
        threads: int = 0,
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise LQDError(f"expected render_mode to be 'rgb_array' or None, got {render_mode!r}")
        self.num_envs = checked_count(num_envs)
        self._mode = checked_mode(autoreset_mode)
        self._limit = checked_limit(max_episode_steps)
        self._size = checked_size(width, height)
        self.render_mode = render_mode
        self.metadata = {**self.metadata, "autoreset_mode": self._mode}
        self._scene = load_scene(task_of(task, instance))
        self._reward = get_reward(reward)
        self._layout = Observation.of(self._scene)
        self._renderer: ArrayRenderer | None = None
        self.single_action_space = spaces.Box(-1.0, 1.0, (ACTION_DIM,), np.float32)
        self.single_observation_space = spaces.Box(
            self._layout.low, self._layout.high, dtype=np.float64
        )
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.batch = Batch(self._scene.model, self.num_envs, threads, persistent=True)
        self._sensordata: _Floats = self.batch.bind("sensordata")
        self._start_sensordata = np.zeros_like(self._sensordata)
        self._started = np.zeros(self.num_envs, dtype=bool)
        self._done = np.zeros(self.num_envs, dtype=bool)
        self._obstructed = np.zeros(self.num_envs, dtype=bool)
        self._elapsed = np.zeros(self.num_envs, dtype=np.int64)

    @property
    def observation_names(self) -> tuple[str, ...]:
        """Name and unit of every entry of an env's observation."""
        return self._layout.names

    def reset(
        self,
        *,
        seed: int | list[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[_Floats, dict[str, Any]]:
        """Start an episode in every env, or in those of a mask.

        Args:
            seed: Seed of the random generator, or a list of one for each env, of which the first
                is used. The envs themselves draw nothing.
            options: `arm` and `reset_mask`, see the class.

        Returns:
            (num_envs, d) observations of all envs, and the infos of those that were reset.

        Raises:
            ResetError: An option is unknown or wrong, or an arm cannot start there; after the
                latter those envs must be reset again.
        """
        options = options or {}
        require_known_options(options, known=("arm", "reset_mask"))
        mask = np.ones(self.num_envs, dtype=bool)
        if "reset_mask" in options:
            mask = checked_mask(options["reset_mask"], num_envs=self.num_envs)
        self._require_others_started(mask)
        envs = np.flatnonzero(mask)
        arms = checked_arms(
            options.get("arm", HOME), scene=self._scene, num_envs=self.num_envs, envs=envs
        )
        super().reset(seed=self._first_seed(seed))
        self._start(envs, arms)
        observations, columns = self._perceive()
        return observations, column_infos(
            columns, success=self._scene.task.success(columns), mask=mask
        )

    def step(self, actions: ArrayLike) -> tuple[_Floats, _Floats, _Bools, _Bools, dict[str, Any]]:
        """Simulate one control step of 20 ms in every env, but for those that are to be reset.

        Args:
            actions: (num_envs, 8) in [-1, 1].

        Returns:
            (num_envs, d) observations, (num_envs,) rewards, terminations (all False) and
            truncations, and infos.

        Raises:
            LQDError: The actions have another shape or are not finite, or an env must be reset
                first.
        """
        self._require_ready()
        restarts = self._done & (self._mode is AutoresetMode.NEXT_STEP)
        stepped = ~restarts
        self._simulate(np.flatnonzero(stepped), actions)
        self._restart(restarts)

        observations, columns = self._perceive()
        diverged = stepped & self.batch.warning[:, :, 1].any(axis=1)
        self._obstructed |= self._scene.sensors.robot_touches_obstacle(self._sensordata)
        failed = diverged | self._obstructed
        success = self._scene.task.success(columns) & ~failed
        rewards = np.where(
            stepped & ~failed, self._reward(self._scene.task, columns), np.float64(0.0)
        )
        self._done = stepped & (diverged | self._is_over())
        truncations = self._done.copy()
        final: dict[str, Any] = {}
        if self._mode is AutoresetMode.SAME_STEP and truncations.any():
            final = final_infos(observations, columns, success=success, mask=truncations)
            self._restart(truncations)
            observations, columns = self._perceive()
            success = self._scene.task.success(columns) & ~self._obstructed
        infos = final | column_infos(
            columns, success=success, mask=np.ones(self.num_envs, dtype=bool)
        )
        return observations, rewards, np.zeros(self.num_envs, dtype=bool), truncations, infos

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Return a picture of every env, or None without a render mode.

        Returns:
            num_envs times (height, width, 3) uint8, or None.

        Raises:
            LQDError: `reset` was not called.
            RenderingError: There is nothing here to draw with.
        """
        if self.render_mode is None:
            return None
        self._require_started("render")
        if self._renderer is None:
            width, height = self._size
            self._renderer = ArrayRenderer(self._scene.model, width=width, height=height)
        data = mujoco.MjData(self._scene.model)
        return tuple(
            self._renderer.render(self.batch.get_data(env, data)) for env in range(self.num_envs)
        )

    def close_extras(self, **_: Any) -> None:
        """Free the OpenGL context."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    def _simulate(self, envs: NDArray[np.intp], actions: object) -> None:
        checked = checked_actions(actions, num_envs=self.num_envs, envs=envs)
        self.batch.bind("ctrl")[envs] = self._scene.action_map.controls(checked)
        self.batch.step(ids=envs, nstep=self._scene.substeps, stage=_VEL_STAGE)
        self._elapsed[envs] += 1

    def _start(self, envs: NDArray[np.intp], arms: _Floats) -> None:
        self._started[envs] = False
        self.batch.reset(ids=envs, stage=_NO_STAGE)
        self.batch.bind("qpos")[envs] = self._scene.start_qpos(arms)
        self.batch.forward(ids=envs, stage=_VEL_STAGE)
        overlapping = envs[self._scene.sensors.robot_touches(self._sensordata[envs])]
        if len(overlapping):
            raise overlap_error(f" in {named_envs(overlapping)}")
        self._start_sensordata[envs] = self._sensordata[envs]
        self._started[envs] = True
        self._done[envs] = False
        self._obstructed[envs] = False
        self._elapsed[envs] = 0

    def _restart(self, mask: _Bools) -> None:
        envs = np.flatnonzero(mask)
        if len(envs):
            self._start(envs, np.tile(HOME, (len(envs), 1)))

    def _perceive(self) -> tuple[_Floats, Columns]:
        since_start = np.stack([self._start_sensordata, self._sensordata], axis=1)
        columns = self._scene.sensors.columns(since_start)
        observations = self._layout.vector(
            self._scene,
            qpos=self.batch.bind("qpos"),
            qvel=self.batch.bind("qvel"),
            sensordata=self._sensordata,
            columns=columns,
        )
        return observations, columns

    def _is_over(self) -> _Bools:
        if self._limit is None:
            return np.zeros(self.num_envs, dtype=bool)
        return self._elapsed >= self._limit

    def _first_seed(self, seed: int | list[int | None] | None) -> int | None:
        if not isinstance(seed, list | tuple):
            return seed
        if len(seed) != self.num_envs:
            raise ResetError(
                f"expected a seed or a list of {self.num_envs} seeds, one for each env, got a list "
                f"of {len(seed)}"
            )
        return seed[0]

    def _require_others_started(self, mask: _Bools) -> None:
        missing = np.flatnonzero(~self._started & ~mask)
        if len(missing):
            raise ResetError(
                "expected the option 'reset_mask' to pick every env that was not started yet, "
                f"but {named_envs(missing)} would be left out: reset those too"
            )

    def _require_started(self, caller: str) -> None:
        missing = np.flatnonzero(~self._started)
        if len(missing):
            raise LQDError(
                f"expected reset() before {caller}(), but {named_envs(missing)} did not start: "
                "call envs.reset() once"
            )

    def _require_ready(self) -> None:
        self._require_started("step")
        if self._mode is AutoresetMode.DISABLED and self._done.any():
            raise LQDError(
                f"expected {named_envs(np.flatnonzero(self._done))} to be reset after the end of "
                'an episode, since autoreset is disabled: call envs.reset(options={"reset_mask": '
                "terminations | truncations})"
            )
