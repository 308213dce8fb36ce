"""A finished and an unfinished run, and a way to call `lqd`."""

import pytest
from click.testing import CliRunner

from lqd_search.cli.main import lqd, main
from lqd_search.cli.progress import RunProgress
from lqd_search.runs import run_recorder

RUN = (
    *("run", "LQD/Faucet-v0", "--evaluations", "320", "--batch-size", "16"),
    *("--seed", "1", "--threads", "1"),
)
GENERATIONS_BEFORE_IT_IS_STOPPED = 3


@pytest.fixture(autouse=True)
def no_heat_maps(monkeypatch):
    """Leave heat maps out of runs that a test makes: to draw them takes longer than the rest.

    The run of the fixture `run`, which is made before, has them.
    """
    monkeypatch.setattr(run_recorder, "draw_heat_map", lambda *_, **__: b"a picture")


@pytest.fixture(scope="session")
def run(tmp_path_factory):
    """Return the folder of a finished run with its pictures and what it printed."""
    folder = tmp_path_factory.mktemp("runs") / "one"
    arguments = [*RUN, "--out", str(folder)]
    result = CliRunner().invoke(lqd, arguments, catch_exceptions=False)
    assert result.exit_code == 0
    return folder, result.output


@pytest.fixture
def run_again():
    """Return what `lqd` was called with for that run, without its folder."""
    return RUN


@pytest.fixture(scope="session")
def stopped(tmp_path_factory):
    """Return the folder of the same run, stopped after three generations, and what it printed."""
    folder = tmp_path_factory.mktemp("runs") / "stopped"
    arguments = [*RUN, "--out", str(folder)]

    def stop(_, metrics):
        if metrics.generation == GENERATIONS_BEFORE_IT_IS_STOPPED:
            raise KeyboardInterrupt

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(RunProgress, "show", stop)
        result = CliRunner().invoke(lqd, arguments, catch_exceptions=False)
    assert result.exit_code == 130
    return folder, result.output


@pytest.fixture
def call(capsys):
    """Run the command as a shell would; return exit status, standard output and standard error."""

    def run_main(*arguments: object) -> tuple[int, str, str]:
        status = 0
        try:
            main([str(argument) for argument in arguments])
        except SystemExit as stop:
            status = int(stop.code or 0)
        output = capsys.readouterr()
        return status, output.out, output.err

    return run_main
