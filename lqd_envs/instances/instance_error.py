"""The error of task instances."""

from lqd_envs.errors import LQDError


class InstanceError(LQDError, ValueError):
    """A task instance, or a part of one, that cannot be."""
