"""What callers hand to the environments, checked."""

import reprlib
from collections.abc import Mapping, Sequence
from typing import Any, TypeGuard

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from lqd_envs.action import ACTION_DIM
from lqd_envs.errors import LQDError
from lqd_envs.scenes.workspace import MAX_PICTURE

_SHOWN_ENVS = 5


class ResetError(LQDError, ValueError):
    """Options of `reset` that cannot be used."""


def checked_action(action: object) -> NDArray[np.float64]:
    """Return one env's action, (8,) float64.

    Raises:
        LQDError: It has another shape or is not finite.
    """
    checked = numbers_in(action)
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
    checked = numbers_in(actions)
    if checked.shape != (num_envs, ACTION_DIM):
        raise LQDError(
            f"expected actions of shape {(num_envs, ACTION_DIM)}, one row for each env, got "
            f"{described(actions)}"
        )
    rows = checked[envs]
    bad = envs[~np.isfinite(rows).all(axis=1)]
    if len(bad):
        raise LQDError(
            f"expected actions of finite numbers in [-1, 1], got {checked[bad[0]].tolist()} for "
            f"{named_envs(bad)}"
        )
    return rows


def checked_options(options: object, *, known: tuple[str, ...]) -> dict[str, Any]:
    """Return the options of `reset`, none of them for None.

    Raises:
        ResetError: They are no dictionary, or have any key but the known ones.
    """
    if options is None:
        return {}
    if not isinstance(options, Mapping):
        raise ResetError(
            f"expected options as a dictionary or None, got {described(options)}: write them as "
            "{name: value}"
        )
    unknown = sorted(map(repr, set(options) - set(known)))
    if unknown:
        noun = "option" if len(known) == 1 else "options"
        raise ResetError(
            f"expected the {noun} {' and '.join(map(repr, known))} at most, got "
            f"{', '.join(unknown)}"
        )
    return dict(options)


def checked_mask(mask: object, *, num_envs: int) -> NDArray[np.bool_]:
    """Return the option `reset_mask`, (num_envs,) bool with one True at least.

    Raises:
        ResetError: It is no (num_envs,) array of bools, or picks none.
    """
    if not isinstance(mask, np.ndarray) or mask.dtype != np.bool_ or mask.shape != (num_envs,):
        raise ResetError(
            f"expected the option 'reset_mask' to be a NumPy array of {num_envs} bools, got "
            f"{described(mask)}"
        )
    if not mask.any():
        raise ResetError(
            "expected the option 'reset_mask' to pick one env at least, got False for every env: "
            "leave the option out to reset them all"
        )
    return mask


def checked_size(width: object, height: object) -> tuple[int, int]:
    """Return the size of a picture, in pixels.

    Raises:
        LQDError: The sides are no whole numbers, or the scenes cannot be drawn in that size.
    """
    if not (_is_whole(width) and _is_whole(height)):
        raise LQDError(
            f"expected width and height to be whole numbers of pixels, got {width!r} and {height!r}"
        )
    if not (0 < width <= MAX_PICTURE[0] and 0 < height <= MAX_PICTURE[1]):
        raise LQDError(
            f"expected pictures of 1 x 1 to {MAX_PICTURE[0]} x {MAX_PICTURE[1]} pixels, got "
            f"{width} x {height}"
        )
    return int(width), int(height)


def checked_render_mode(mode: object, *, known: Sequence[str]) -> str | None:
    """Return a render mode, or raise `LQDError` where it is neither known nor None."""
    if mode is None or (isinstance(mode, str) and mode in known):
        return mode
    raise LQDError(f"expected render_mode to be one of {list(known)} or None, got {mode!r}")


def checked_count(num_envs: object) -> int:
    """Return the number of envs, or raise `LQDError` where it is no whole number from 1 on."""
    return _whole(num_envs, name="num_envs", least=1)


def checked_threads(threads: object) -> int:
    """Return the number of threads, or raise `LQDError` where it is no whole number from 0 on."""
    return _whole(threads, name="threads", least=0)


def checked_limit(max_episode_steps: object) -> int | None:
    """Return the length of an episode, None without a limit.

    Raises:
        LQDError: It is no whole number from 1 on, nor None or -1.
    """
    if max_episode_steps is None or max_episode_steps == -1:
        return None
    no_limit = ", or None or -1 for no limit"
    return _whole(max_episode_steps, name="max_episode_steps", least=1, or_else=no_limit)


def checked_mode(mode: AutoresetMode | str) -> AutoresetMode:
    """Return an autoreset mode from itself or its value.

    Raises:
        LQDError: There is no such mode; the message names those there are.
    """
    known = {known.value: known for known in AutoresetMode}
    if isinstance(mode, AutoresetMode):
        return mode
    if not isinstance(mode, str) or mode not in known:
        raise LQDError(f"expected autoreset_mode to be one of {', '.join(known)}, got {mode!r}")
    return known[mode]


def named_envs(envs: NDArray[np.intp]) -> str:
    """Return `env 3`, or `envs 3, 4` and so on for up to five of them."""
    names = ", ".join(str(env) for env in envs[:_SHOWN_ENVS])
    more = len(envs) - _SHOWN_ENVS
    return f"{'env' if len(envs) == 1 else 'envs'} {names}" + (f" and {more} more" * (more > 0))


def described(value: object) -> str:
    """Return what a value is in a few words: an array by its type and shape."""
    if isinstance(value, np.ndarray):
        return f"{value.dtype} array of shape {value.shape}"
    return reprlib.repr(value)


def numbers_in(value: object) -> NDArray[np.float64]:
    """Return a value as an array, or an array of no shape that fits where it is none."""
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        return np.empty(0)


def _whole(value: object, *, name: str, least: int, or_else: str = "") -> int:
    if not _is_whole(value) or value < least:
        raise LQDError(
            f"expected {name} to be a whole number of at least {least}{or_else}, got {value!r}"
        )
    return int(value)


def _is_whole(value: object) -> TypeGuard[int | np.integer[Any]]:
    return isinstance(value, int | np.integer) and not isinstance(value, bool)
