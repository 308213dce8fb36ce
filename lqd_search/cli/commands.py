"""The commands of `lqd`, each imported when it is called."""

from importlib import import_module

import click

from lqd_envs import LQDError
from lqd_search.cli.install import INSTALL_ALL

COMMANDS = {
    "run": "Search for many motions that do a task.",
    "infer": "Ask a language model for the functionals of a task.",
    "show": "Show a run's figures.",
    "replay": "Carry out a motion of a run again.",
    "adapt": "Find the motions of a run that solve a task instance.",
    "report": "Write an HTML report of runs.",
    "doctor": "Say what this machine has, and try the sandbox.",
}
"""What each command does, by its name; it is `<name>_command` in the module of the same name."""


class Commands(click.Group):
    """The commands; what one of them imports, which may take seconds, the others do without."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002
        """Return the names of the commands."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002
        """Return a command; None: there is none of that name.

        Raises:
            LQDError: A package that it needs is not installed.
        """
        if cmd_name not in COMMANDS:
            return None
        try:
            module = import_module(f"lqd_search.cli.{cmd_name}")
        except ModuleNotFoundError as error:
            package = (error.name or "").partition(".")[0]
            raise LQDError(
                f"Expected the packages of the extra `search`, but {package} is not installed; "
                f"{INSTALL_ALL}."
            ) from error
        command: click.Command = getattr(module, f"{cmd_name}_command")
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        """Write the list of commands."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))
