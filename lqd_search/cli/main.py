"""The command group `lqd` and its way of failing."""

import sys
from collections.abc import Sequence

import click

from lqd_envs import LQDError
from lqd_search.cli.commands import Commands

_BAD_INPUT = 2
_INTERRUPTED = 130


@click.group(
    cls=Commands,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
@click.version_option(package_name="lqd-envs")
def lqd() -> None:
    """Language-driven quality-diversity: from one sentence to many motions that do it.

    The exit status is 0; 1 if nothing is found or something differs, as a command's help says; 2 if
    what is asked cannot be done, which one sentence explains; 130 if it is stopped.
    """


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command; bad input is one sentence on standard error and exit status 2.

    Args:
        arguments: What stands after `lqd`; the process's own arguments by default.
    """
    try:
        lqd(arguments, prog_name="lqd", standalone_mode=False)
    except LQDError as error:
        click.echo(f"lqd: {error}", err=True)
        sys.exit(_BAD_INPUT)
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except (click.Abort, KeyboardInterrupt):
        click.echo("lqd: stopped", err=True)
        sys.exit(_INTERRUPTED)
