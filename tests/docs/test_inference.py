"""The page on inference: its example runs."""

import re
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "inference.md"
BLOCKS = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text("utf-8"), re.DOTALL | re.MULTILINE)


def test_the_example_infers_functionals(capsys):
    assert len(BLOCKS) == 1

    exec(compile(BLOCKS[0], str(PAGE), "exec"), {})

    printed = capsys.readouterr().out
    assert "def success(infos" in printed
    assert re.search(r"\{'\w+': \d", printed)
