"""The options that say which language model is asked, and how."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import click

from lqd_envs import LQDError
from lqd_search.cli.llm_extra import llm_extra

if TYPE_CHECKING:
    from lqd_llm import ModelOptions, Provider

Mode: TypeAlias = Literal["replay", "record", "live"]
"""Whether recordings answer, or a model, or a model whose answers become recordings."""

REPLAY, RECORD, LIVE = MODES = ("replay", "record", "live")

# As in lqd_llm, which takes a while to import and need not be installed.
EFFORTS = ("low", "medium", "high", "xhigh", "max")
_MODEL = "claude-opus-5-5"
_MAX_TOKENS = 20_000
MOST_TOKENS = 21_333
_RECORDINGS = Path("recordings")


@dataclass(frozen=True)
class LLMOptions:
    """Which language model is asked, and how.

    Attributes:
        mode: One of `MODES`.
        recordings: Folder of own recordings: `replay` reads it besides those that ship, `record`
            writes it. None: those that ship alone, or the folder `recordings`.
        model: Name of the model.
        effort: One of `EFFORTS`, or None for the model's own default.
        max_tokens: Most tokens of a reply, at most `MOST_TOKENS`.
        given: Which of `model`, `effort` and `max_tokens` the user has chosen, by these names.
    """

    mode: Mode = "replay"
    recordings: Path | None = None
    model: str = _MODEL
    effort: str | None = None
    max_tokens: int = _MAX_TOKENS
    given: tuple[str, ...] = ()

    @property
    def asks_a_model(self) -> bool:
        """Whether a model is asked, which uses the network and costs money."""
        return self.mode != REPLAY

    def model_options(self) -> "ModelOptions":
        """Return what the model is asked with.

        Raises:
            LQDError: The extra `llm` is not installed, or a value is out of range.
        """
        with llm_extra():
            from lqd_llm import ModelOptions
        effort: Any = self.effort
        return ModelOptions(model=self.model, effort=effort, max_tokens=self.max_tokens)

    @contextmanager
    def provider(self, *, transcript: Path | None = None) -> "Iterator[Provider]":
        """Open what answers, and close it in the end.

        Args:
            transcript: Folder in which every answer is kept as soon as it comes, before it becomes
                a recording; answers that are there already are used.

        Raises:
            LQDError: The extra `llm` is not installed, an option would not be heeded, the folder of
                recordings is not there, or the credentials cannot be loaded.
        """
        self._check()
        with llm_extra():
            from lqd_llm import KeepingProvider
        folders = [transcript] if transcript else []
        if self.mode == RECORD:
            folders.append(self.recordings or _RECORDINGS)
        with self._answering() as provider:
            if folders:
                yield KeepingProvider(provider, folder=folders[0], copies=folders[1:])
            else:
                yield provider

    @contextmanager
    def _answering(self) -> "Iterator[Provider]":
        if self.mode == REPLAY:
            with llm_extra():
                from lqd_llm import ReplayProvider
            yield ReplayProvider(self.recordings)
            return
        with llm_extra():
            from lqd_llm import LiveProvider
        with LiveProvider() as live:
            yield live

    def asked(self) -> dict[str, Any]:
        """Return what decides the answers, as JSON can hold it."""
        return {"mode": self.mode, "model": self.model, "effort": self.effort}

    def _check(self) -> None:
        if self.mode == REPLAY:
            self._refuse_unheeded()
        if self.recordings is None:
            return
        if self.mode == LIVE:
            raise LQDError(
                "Expected --recordings with --llm replay or --llm record only, but got it with "
                "--llm live, which neither reads nor writes any; leave it out."
            )
        if self.mode == REPLAY:
            _check_folder(self.recordings)

    def _refuse_unheeded(self) -> None:
        # Own recordings are looked up by model and effort; those that ship answer whatever these.
        heeded = () if self.recordings is None else ("model", "effort")
        given = [f"--{n.replace('_', '-')}" for n in self.given if n not in heeded]
        if given:
            raise LQDError(
                f"Expected {', '.join(given)} with --llm record or --llm live only, but got it "
                "with --llm replay, which asks no model; leave it out."
            )


def _check_folder(recordings: Path) -> None:
    try:
        problem = "" if recordings.is_dir() else "there is none"
    except OSError as error:
        problem = f"that cannot be looked up ({error.strerror or error})"
    if problem:
        raise LQDError(
            f"Expected a folder of recordings at {recordings}, but {problem}; take recordings with "
            "`--llm record`, or leave --recordings out."
        )


_OPTIONS = (
    click.option(
        "--llm",
        type=click.Choice(MODES),
        default=REPLAY,
        show_default=True,
        help="What answers the prompts: replay, recordings of a language model; record, a model "
        "through the Anthropic API, whose answers become recordings; live, such a model.",
    ),
    click.option(
        "--recordings",
        metavar="DIR",
        type=click.Path(path_type=Path, file_okay=False),
        help="Folder of your own recordings: replay reads it besides those that ship, record "
        "writes it.  [default for record: recordings]",
    ),
    click.option(
        "--instruction", help="What to do, in one sentence, instead of the task's own instruction."
    ),
    click.option(
        "--sample",
        type=click.IntRange(min=0),
        default=0,
        show_default=True,
        help="Which of several inferences of the same task; 0 to 4 are recorded.",
    ),
    click.option(
        "--model", default=_MODEL, show_default=True, help="Language model that is asked."
    ),
    click.option(
        "--effort",
        type=click.Choice(EFFORTS),
        help="How much effort the model shall put into its replies.  [default: the model's own]",
    ),
    click.option(
        "--max-tokens",
        type=click.IntRange(min=1, max=MOST_TOKENS),
        default=_MAX_TOKENS,
        show_default=True,
        help="Most tokens of a reply, those spent on thinking included.",
    ),
)

# What the command is not handed one by one.
_OF_A_MODEL = ("model", "effort", "max_tokens")
_BUNDLED = ("recordings", *_OF_A_MODEL)


def llm_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options to a command.

    It is handed an `LLMOptions` as `llm`, and `instruction` and `sample`.
    """

    @wraps(command)
    def bundled(*arguments: Any, llm: Mode, **options: Any) -> Any:
        bundle = {name: options.pop(name) for name in _BUNDLED}
        return command(*arguments, llm=LLMOptions(llm, given=_given(), **bundle), **options)

    for option in reversed(_OPTIONS):
        bundled = option(bundled)
    return bundled


def _given() -> tuple[str, ...]:
    context, source = click.get_current_context(), click.core.ParameterSource.COMMANDLINE
    return tuple(name for name in _OF_A_MODEL if context.get_parameter_source(name) is source)
