"""What callers hand to the environments, checked."""

import reprlib
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from lqd_envs.action import ACTION_DIM
from lqd_envs.errors import LQDError
from lqd_envs.scene import Scene
from lqd_envs.scenes.panda import ARM_JOINTS
from lqd_envs.scenes.workspace import MAX_PICTURE

ARM_DIM = len(ARM_JOINTS)
_SHOWN_ENVS = 5


class ResetError(LQDError, ValueError):
    """Options of `reset` that cannot be used."""


def checked_action(action: object) -> NDArray[np.float64]:
    """Return one env's action, (8,) float64.

    Raises:
        LQDError: It has another shape or is not finite.
    """
    checked = _numbers(action)
    if checked.shape != (ACTION_DIM,) or not np.isfinite(checked).all():
        raise LQDError(
            f"expected an action of {ACTION_DIM} finite numbers in [-1, 1], got {action!r}"
        )
    return checked


def checked_actions(
    actions: object, *, num_envs: int, envs: NDArray[np.intp]
) -> NDArray[np.float64]:
    """Return the actions of the envs that are stepped.

    Args:
        actions: (num_envs, 8), a row for each env.
        num_envs: Number of envs.
        envs: (n,) the envs that are stepped; the other rows are not looked at.

    Returns:
        (n, 8) float64.

    Raises:
        LQDError: They have another shape, or a row is not finite.
    """
    checked = _numbers(actions)
    if checked.shape != (num_envs, ACTION_DIM):
        raise LQDError(
            f"expected actions of shape {(num_envs, ACTION_DIM)}, one row for each env, got "
            f"{_described(actions)}"
        )
    rows = checked[envs]
    bad = envs[~np.isfinite(rows).all(axis=1)]
    if len(bad):
        raise LQDError(
            f"expected actions of finite numbers in [-1, 1], got {checked[bad[0]].tolist()} for "
            f"{named_envs(bad)}"
        )
    return rows


def require_known_options(options: dict[str, Any], *, known: tuple[str, ...]) -> None:
    """Raise `ResetError` where `options` has any key but the known ones."""
    unknown = sorted(map(repr, set(options) - set(known)))
    if unknown:
        noun = "option" if len(known) == 1 else "options"
        raise ResetError(
            f"expected the {noun} {' and '.join(map(repr, known))} at most, got "
            f"{', '.join(unknown)}"
        )


def checked_arm(arm: object, *, scene: Scene) -> NDArray[np.float64]:
    """Return one env's option `arm`, (7,) float64, rad.

    Raises:
        ResetError: It has another shape, is not finite, or is outside the joint limits.
    """
    checked = _numbers(arm)
    if checked.shape != (ARM_DIM,) or not np.isfinite(checked).all():
        raise ResetError(
            f"expected the option 'arm' to be {ARM_DIM} finite joint positions in rad, got {arm!r}"
        )
    _require_within_limits(checked[None], scene=scene, places=("",))
    return checked


def checked_arms(
    arm: object, *, scene: Scene, num_envs: int, envs: NDArray[np.intp]
) -> NDArray[np.float64]:
    """Return the option `arm` of the envs that are reset.

    Args:
        arm: (7,) for all envs, or (num_envs, 7), a row for each; rad.
        scene: The task's scene.
        num_envs: Number of envs.
        envs: (n,) the envs that are reset; the other rows are not looked at.

    Returns:
        (n, 7) float64.

    Raises:
        ResetError: It has another shape, or a row is not finite or outside the joint limits.
    """
    checked = _numbers(arm)
    if checked.shape not in {(ARM_DIM,), (num_envs, ARM_DIM)}:
        raise ResetError(
            f"expected the option 'arm' to be {ARM_DIM} finite joint positions in rad, or "
            f"{num_envs} rows of them, one for each env, got {_described(arm)}"
        )
    arms = np.broadcast_to(checked, (num_envs, ARM_DIM))[envs]
    bad = envs[~np.isfinite(arms).all(axis=1)]
    if len(bad):
        raise ResetError(
            f"expected the option 'arm' to be finite joint positions in rad, got "
            f"{arms[envs == bad[0]][0].tolist()} for {named_envs(bad)}"
        )
    _require_within_limits(arms, scene=scene, places=[f" of env {env}" for env in envs])
    return arms


def checked_mask(mask: object, *, num_envs: int) -> NDArray[np.bool_]:
    """Return the option `reset_mask`, (num_envs,) bool with one True at least.

    Raises:
        ResetError: It is no (num_envs,) array of bools, or picks none.
    """
    if not isinstance(mask, np.ndarray) or mask.dtype != np.bool_ or mask.shape != (num_envs,):
        kind = f"{mask.dtype} " if isinstance(mask, np.ndarray) else ""
        raise ResetError(
            f"expected the option 'reset_mask' to be a NumPy array of {num_envs} bools, got "
            f"{kind}{_described(mask)}"
        )
    if not mask.any():
        raise ResetError(
            "expected the option 'reset_mask' to pick one env at least, got False for every env: "
            "leave the option out to reset them all"
        )
    return mask


def checked_size(width: int, height: int) -> tuple[int, int]:
    """Return the size of a picture, in pixels.

    Raises:
        LQDError: The scenes cannot be drawn in that size.
    """
    if not (0 < width <= MAX_PICTURE[0] and 0 < height <= MAX_PICTURE[1]):
        raise LQDError(
            f"expected pictures of at most {MAX_PICTURE[0]} x {MAX_PICTURE[1]} pixels, got "
            f"{width} x {height}"
        )
    return width, height


def checked_count(num_envs: int) -> int:
    """Return the number of envs, or raise `LQDError` where it is no whole number from 1 on."""
    if not isinstance(num_envs, int | np.integer) or num_envs < 1:
        raise LQDError(f"expected num_envs to be a whole number of at least 1, got {num_envs!r}")
    return int(num_envs)


def checked_limit(max_episode_steps: int | None) -> int | None:
    """Return the length of an episode, None without a limit.

    Raises:
        LQDError: It is no whole number from 1 on, nor None or -1.
    """
    if max_episode_steps is None or max_episode_steps == -1:
        return None
    if not isinstance(max_episode_steps, int | np.integer) or max_episode_steps < 1:
        raise LQDError(
            "expected max_episode_steps to be a whole number of at least 1, or None or -1 for no "
            f"limit, got {max_episode_steps!r}"
        )
    return int(max_episode_steps)


def checked_mode(mode: AutoresetMode | str) -> AutoresetMode:
    """Return an autoreset mode from itself or its value.

    Raises:
        LQDError: There is no such mode; the message names those there are.
    """
    known = {known.value: known for known in AutoresetMode}
    if isinstance(mode, AutoresetMode):
        return mode
    if mode not in known:
        raise LQDError(f"expected autoreset_mode to be one of {', '.join(known)}, got {mode!r}")
    return known[mode]


def overlap_error(place: str = "") -> ResetError:
    """Return the error for a start at which the robot is inside something.

    Args:
        place: Of which envs, such as ` in env 3`; nothing for a single env.
    """
    return ResetError(
        "expected a start at which the robot touches nothing, got an arm configuration with the "
        f"robot inside the table or the object{place}: start further away"
    )


def named_envs(envs: NDArray[np.intp]) -> str:
    """Return `env 3`, or `envs 3, 4` and so on for up to five of them."""
    names = ", ".join(str(env) for env in envs[:_SHOWN_ENVS])
    more = len(envs) - _SHOWN_ENVS
    return f"{'env' if len(envs) == 1 else 'envs'} {names}" + (f" and {more} more" * (more > 0))


def _require_within_limits(
    arms: NDArray[np.float64], *, scene: Scene, places: list[str] | tuple[str, ...]
) -> None:
    limits = np.array([scene.model.joint(name).range for name in ARM_JOINTS])
    outside = np.argwhere((arms < limits[:, 0]) | (arms > limits[:, 1]))
    if len(outside):
        row, joint = outside[0]
        raise ResetError(
            f"expected arm joint {joint + 1}{places[row]} within [{limits[joint, 0]:.4f}, "
            f"{limits[joint, 1]:.4f}] rad, got {arms[row, joint]:.4f}"
        )


def _described(value: object) -> str:
    if isinstance(value, np.ndarray):
        return f"array of shape {value.shape}"
    return reprlib.repr(value)


def _numbers(value: object) -> NDArray[np.float64]:
    """Return the value as an array, or an array of no shape that fits where it is none."""
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        return np.empty(0)
