"""The entry point of `lqd` and of `python -m lqd_search`."""

import sys

from lqd_search.cli.install import INSTALL_ALL


def main() -> None:
    """Run the `lqd` command, or say what it needs."""
    try:
        _run()
    except KeyboardInterrupt:
        # While it imports; from then on the command says this itself.
        sys.stderr.write("lqd: stopped\n")
        sys.exit(130)


def _run() -> None:
    try:
        from lqd_search.cli.main import main as run
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        sys.stderr.write(
            f"lqd: Expected the packages of the extra `search`, but {package} is not installed; "
            f"{INSTALL_ALL}.\n"
        )
        sys.exit(2)
    run()


if __name__ == "__main__":
    main()
