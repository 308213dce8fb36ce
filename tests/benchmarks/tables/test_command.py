"""How commands of benchmarks end."""

import pytest

from benchmarks.tables.command import stopped


@pytest.mark.parametrize(
    ("runs", "sentence"),
    [
        (1, "stopped; all is kept: go on with `judge runs/0`\n"),
        (240, "stopped; all is kept: the same command goes on\n"),
    ],
)
def test_who_stops_is_told_how_to_go_on_in_one_line(capsys, runs, sentence):
    with pytest.raises(SystemExit) as end:
        stopped("all is kept", again=" ".join(["judge", *(f"runs/{n}" for n in range(runs))]))

    assert end.value.code == 130
    assert capsys.readouterr().err == sentence
