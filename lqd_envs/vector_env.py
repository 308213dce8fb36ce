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
from lqd_envs.discarded import spoils
from lqd_envs.env import MAX_EPISODE_STEPS
from lqd_envs.episodes import Episodes
from lqd_envs.errors import LQDError
from lqd_envs.inputs import (
    ResetError,
    checked_actions,
    checked_count,
    checked_limit,
    checked_mask,
    checked_mode,
    checked_options,
    checked_render_mode,
    checked_size,
    checked_threads,
    named_envs,
)
from lqd_envs.instances.instance import Instance, task_of
from lqd_envs.observation import Observation
from lqd_envs.perception import Columns
from lqd_envs.rendering import ArrayRenderer
from lqd_envs.reward import get_reward
from lqd_envs.scene import load_scene
from lqd_envs.start_arm import checked_arms, checked_start_arm, overlap_error
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
    float64, contacts, `is_success` and `discarded` (num_envs,) bool. `gripper_contacts` and
    `joint_positions` are dictionaries of (num_envs,) arrays. Beside each key, `_key` is a
    (num_envs,) bool array of the envs that the value is for: all of them, or those that were just
    reset by a `reset_mask`; the others' values are zero.

    ## Autoreset

    | `autoreset_mode` | an env that was truncated |
    |---|---|
    | `NEXT_STEP` | is reset by the next step, which ignores its action and gives it reward 0 |
    | `SAME_STEP` | is reset at once; `final_obs` and `final_info` hold what was before |
    | `DISABLED` | must be reset with a `reset_mask` before the next step |

    An autoreset starts from the usual start: the argument `start_arm`, whatever the option `arm` of
    the last `reset` was.

    ## Options of `reset`

    * `arm`: seven joint positions (rad) for every env, or (num_envs, 7), a row for each.
    * `reset_mask`: (num_envs,) bool array, the envs to reset; the others go on.

    ## Arguments

    * `num_envs`: number of envs.
    * `task`, `instance`, `start_arm`, `reward`, `width`, `height`: as in `ManipulationEnv`.
    * `max_episode_steps`: control steps after which an episode is truncated; None or -1: never.
      For `gymnasium.make`, of single envs, -1 means that too, but None means 150.
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
        start_arm: ArrayLike | None = None,
        reward: str = "sparse",
        max_episode_steps: int | None = MAX_EPISODE_STEPS,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        render_mode: str | None = None,
        width: int = 640,
        height: int = 480,
        threads: int = 0,
    ) -> None:
        self.num_envs = checked_count(num_envs)
        self._mode = checked_mode(autoreset_mode)
        self._episodes = Episodes.of(self.num_envs, limit=checked_limit(max_episode_steps))
        self._size = checked_size(width, height)
        self.render_mode = checked_render_mode(render_mode, known=self.metadata["render_modes"])
        threads = checked_threads(threads)
        self.metadata = {**self.metadata, "autoreset_mode": self._mode}
        self._scene = load_scene(task_of(task, instance))
        self._start_arm = checked_start_arm(start_arm, scene=self._scene)
        self._reward = get_reward(reward)
        self._layout = Observation.of(self._scene)
        self._renderer: ArrayRenderer | None = None
        self.single_action_space = spaces.Box(-1.0, 1.0, (ACTION_DIM,), np.float32)
        self.single_observation_space = spaces.Box(
            self._layout.low, self._layout.high, dtype=np.float64
        )
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self._batch: Batch | None = Batch(
            self._scene.model, self.num_envs, threads, persistent=True
        )
        self._start_sensordata = np.zeros((self.num_envs, self._scene.model.nsensordata))

    @property
    def batch(self) -> Batch:
        """The simulations.

        Raises:
            LQDError: The envs were closed.
        """
        return self._require_open()

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
            LQDError: The envs were closed.
        """
        self._require_open()
        given = checked_options(options, known=("arm", "reset_mask"))
        mask = np.ones(self.num_envs, dtype=bool)
        if "reset_mask" in given:
            mask = checked_mask(given["reset_mask"], num_envs=self.num_envs)
        self._episodes.require_others_started(mask)
        envs = np.flatnonzero(mask)
        arms = checked_arms(
            given.get("arm", self._start_arm), scene=self._scene, num_envs=self.num_envs, envs=envs
        )
        super().reset(seed=self._first_seed(seed))
        self._start(envs, arms, usual="arm" not in given)
        observations, columns = self._perceive()
        return observations, self._infos(columns, mask=mask)

    def step(self, actions: ArrayLike) -> tuple[_Floats, _Floats, _Bools, _Bools, dict[str, Any]]:
        """Simulate one control step of 20 ms in every env, but for those that are to be reset.

        Args:
            actions: (num_envs, 8) in [-1, 1].

        Returns:
            (num_envs, d) observations, (num_envs,) rewards, terminations (all False) and
            truncations, and infos.

        Raises:
            LQDError: The actions have another shape or are not finite, an env must be reset first,
                or the envs were closed.
            ResetError: The usual start of an autoreset is blocked.
        """
        batch, episodes = self._require_open(), self._episodes
        episodes.require_ready(self._mode)
        restarts = episodes.over & (self._mode is AutoresetMode.NEXT_STEP)
        stepped = ~restarts
        self._simulate(np.flatnonzero(stepped), actions)
        self._restart(restarts)

        observations, columns = self._perceive()
        episodes.go_on(
            stepped,
            spoiled=spoils(self._scene.sensors, self._sensordata),
            diverged=stepped & batch.warning[:, :, 1].any(axis=1),
        )
        rewards = np.where(
            stepped & ~episodes.discarded, self._reward(self._scene.task, columns), np.float64(0.0)
        )
        truncations = episodes.over.copy()
        final: dict[str, Any] = {}
        if self._mode is AutoresetMode.SAME_STEP and truncations.any():
            final = final_infos(
                observations, self._infos(columns, mask=truncations), mask=truncations
            )
            self._restart(truncations)
            observations, columns = self._perceive()
        infos = final | self._infos(columns, mask=np.ones(self.num_envs, dtype=bool))
        return observations, rewards, np.zeros(self.num_envs, dtype=bool), truncations, infos

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Return a picture of every env, or None without a render mode.

        Returns:
            num_envs times (height, width, 3) uint8, or None.

        Raises:
            LQDError: `reset` was not called, or the envs were closed.
            RenderingError: There is nothing here to draw with.
        """
        if self.render_mode is None:
            return None
        batch = self._require_open()
        self._episodes.require_started("render")
        if self._renderer is None:
            width, height = self._size
            self._renderer = ArrayRenderer(self._scene.model, width=width, height=height)
        data = mujoco.MjData(self._scene.model)
        return tuple(
            self._renderer.render(batch.get_data(env, data)) for env in range(self.num_envs)
        )

    def close_extras(self, **_: Any) -> None:
        """End the threads, drop the simulations and free the OpenGL context."""
        self._batch = None
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    def _require_open(self) -> Batch:
        if self._batch is None:
            raise LQDError("expected open envs, got closed ones: make them anew")
        return self._batch

    def _simulate(self, envs: NDArray[np.intp], actions: object) -> None:
        checked = checked_actions(actions, num_envs=self.num_envs, envs=envs)
        self.batch.bind("ctrl")[envs] = self._scene.action_map.controls(checked)
        self.batch.step(ids=envs, nstep=self._scene.substeps, stage=_VEL_STAGE)

    def _start(self, envs: NDArray[np.intp], arms: _Floats, *, usual: bool) -> None:
        self._episodes.started[envs] = False
        self.batch.reset(ids=envs, stage=_NO_STAGE)
        self.batch.bind("qpos")[envs] = self._scene.start_qpos(arms)
        self.batch.forward(ids=envs, stage=_VEL_STAGE)
        sensordata = self._sensordata[envs]
        overlapping = envs[self._scene.sensors.robot_touches(sensordata)]
        if len(overlapping):
            raise overlap_error(usual=usual, place=f" in {named_envs(overlapping)}")
        self._start_sensordata[envs] = sensordata
        self._episodes.start(envs, discarded=spoils(self._scene.sensors, sensordata))

    def _restart(self, mask: _Bools) -> None:
        envs = np.flatnonzero(mask)
        if len(envs):
            self._start(envs, np.tile(self._start_arm, (len(envs), 1)), usual=True)

    @property
    def _sensordata(self) -> _Floats:
        bound: _Floats = self.batch.bind("sensordata")
        return bound

    def _infos(self, columns: Columns, *, mask: _Bools) -> dict[str, Any]:
        discarded = self._episodes.discarded
        success = self._scene.task.success(columns) & ~discarded
        return column_infos(columns, success=success, discarded=discarded, mask=mask)

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

    def _first_seed(self, seed: int | list[int | None] | None) -> int | None:
        if not isinstance(seed, list | tuple):
            return seed
        if len(seed) != self.num_envs:
            raise ResetError(
                f"expected a seed or a list of {self.num_envs} seeds, one for each env, got a list "
                f"of {len(seed)}"
            )
        return seed[0]
