"""The arm configuration that an episode starts from, as callers hand it in."""

import numpy as np
from numpy.typing import NDArray

from lqd_envs.errors import LQDError
from lqd_envs.inputs import ResetError, described, named_envs, numbers_in
from lqd_envs.scene import Scene
from lqd_envs.scenes.panda import ARM_JOINTS, HOME

ARM_DIM = len(ARM_JOINTS)


def checked_start_arm(arm: object, *, scene: Scene) -> NDArray[np.float64]:
    """Return the argument `start_arm`, (7,) float64, rad: the usual start for None.

    Raises:
        LQDError: It has another shape, is not finite, or is outside the joint limits.
    """
    checked = numbers_in(HOME if arm is None else arm)
    if checked.shape != (ARM_DIM,) or not np.isfinite(checked).all():
        raise LQDError(
            f"expected start_arm to be {ARM_DIM} finite joint positions in rad, or None, got "
            f"{described(arm)}"
        )
    _require_within_limits(checked[None], scene=scene, places=[" of start_arm"], error=LQDError)
    return checked.copy()


def checked_arm(arm: object, *, scene: Scene) -> NDArray[np.float64]:
    """Return one env's option `arm`, (7,) float64, rad.

    Raises:
        ResetError: It has another shape, is not finite, or is outside the joint limits.
    """
    checked = numbers_in(arm)
    if checked.shape != (ARM_DIM,) or not np.isfinite(checked).all():
        raise ResetError(
            f"expected the option 'arm' to be {ARM_DIM} finite joint positions in rad, got {arm!r}"
        )
    _require_within_limits(checked[None], scene=scene, places=[""], error=ResetError)
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
    checked = numbers_in(arm)
    if checked.shape not in {(ARM_DIM,), (num_envs, ARM_DIM)}:
        raise ResetError(
            f"expected the option 'arm' to be {ARM_DIM} finite joint positions in rad, or "
            f"{num_envs} rows of them, one for each env, got {described(arm)}"
        )
    arms = np.broadcast_to(checked, (num_envs, ARM_DIM))[envs]
    bad = envs[~np.isfinite(arms).all(axis=1)]
    if len(bad):
        raise ResetError(
            f"expected the option 'arm' to be finite joint positions in rad, got "
            f"{arms[envs == bad[0]][0].tolist()} for {named_envs(bad)}"
        )
    places = [f" of env {env}" for env in envs]
    _require_within_limits(arms, scene=scene, places=places, error=ResetError)
    return arms


def overlap_error(*, usual: bool, place: str = "") -> ResetError:
    """Return the error for a start at which the robot is inside something.

    Args:
        usual: Whether it is where every episode starts, and not what the option `arm` asks.
        place: Of which envs, such as ` in env 3`; nothing for a single env.
    """
    whose, remedy = "an arm configuration", "start further away"
    if usual:
        whose = "the usual one"
        remedy = "give another as the argument `start_arm`, or to a reset as the option `arm`"
    return ResetError(
        f"expected a start at which the robot touches nothing, got {whose} with its hand, its "
        "fingers or link 6 or 7 inside the table, the object or an obstacle, or another link "
        f"inside an obstacle{place}: {remedy}"
    )


def _require_within_limits(
    arms: NDArray[np.float64], *, scene: Scene, places: list[str], error: type[LQDError]
) -> None:
    limits = np.array([scene.model.joint(name).range for name in ARM_JOINTS])
    outside = np.argwhere((arms < limits[:, 0]) | (arms > limits[:, 1]))
    if len(outside):
        row, joint = outside[0]
        raise error(
            f"expected arm joint {joint + 1}{places[row]} within [{limits[joint, 0]:.4f}, "
            f"{limits[joint, 1]:.4f}] rad, got {arms[row, joint]:.4f}"
        )
