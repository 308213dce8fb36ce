"""Python's own parser and compiler, made safe to ask about code that anybody wrote."""

import ast
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

from lqd_llm.sandbox.errors import RejectedCodeError

_LONGEST_REASON = 200


def parse(text: str) -> ast.Module:
    """Parse code, whatever it is.

    Raises:
        RejectedCodeError: It is not Python, or is nested too deeply for Python's parser.
    """
    with _rejections():
        return ast.parse(text)


def compile_checked(text: str) -> None:
    """Compile code to see whether that can be done; nothing of it runs.

    Args:
        text: Code that keeps to the allowlist: some other forms take exponential time.

    Raises:
        RejectedCodeError: It cannot be compiled.
    """
    with _rejections():
        compile(text, "<functional>", "exec", dont_inherit=True)


@contextmanager
def _rejections() -> Iterator[None]:
    try:
        with warnings.catch_warnings():
            # Remarks on style must neither reach the user nor depend on their filters.
            warnings.simplefilter("ignore")
            yield
    except SyntaxError as error:
        reason = f"it is not valid Python: {error.msg}"[:_LONGEST_REASON]
        line = error.lineno if error.lineno and error.lineno > 0 else None
        raise RejectedCodeError(reason, line=line) from error
    # What Python answers to code that is nested too deeply depends on its version.
    except (MemoryError, OverflowError, RecursionError, SystemError) as error:
        raise RejectedCodeError("the code is nested too deeply; use shorter expressions") from error
    except ValueError as error:
        reason = f"it is not valid Python: {error}"[:_LONGEST_REASON]
        raise RejectedCodeError(reason) from error
