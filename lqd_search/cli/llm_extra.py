"""The extra `llm`, which much of the command line does without."""

from collections.abc import Iterator
from contextlib import contextmanager

from lqd_envs import LQDError
from lqd_search.cli.install import INSTALL_ALL


@contextmanager
def llm_extra() -> Iterator[None]:
    """Import from `lqd_llm` within this.

    Raises:
        LQDError: The extra `llm` is not installed.
    """
    try:
        yield
    except ImportError as error:
        raise LQDError(
            f"Expected the packages of the extra `llm` to infer functionals, but {error.name} is "
            f"not installed; {INSTALL_ALL}."
        ) from error
