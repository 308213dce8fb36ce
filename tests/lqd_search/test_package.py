import subprocess
import sys

import pytest

import lqd_search


@pytest.mark.parametrize("name", lqd_search.__all__)
def test_every_public_name_is_there(name):
    assert getattr(lqd_search, name).__name__ == name or name == "Competition"


def test_other_names_are_not():
    with pytest.raises(AttributeError, match="has no attribute 'Nothing'"):
        _ = lqd_search.Nothing


def test_importing_the_package_does_not_import_pyribs():
    code = "import sys, lqd_search; sys.exit('ribs' in sys.modules)"

    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_the_command_says_what_to_install_where_pyribs_is_missing():
    code = (
        "import sys; sys.modules['ribs'] = None; sys.argv = ['lqd', '--help'];"
        "from lqd_search.__main__ import main; main()"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False
    )

    assert result.returncode == 2
    assert result.stderr == (
        "lqd: Expected the packages of the extra `search`, but ribs is not installed; run "
        "`pip install 'lqd-envs[all]'`.\n"
    )
