import ast
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import lqd_search


@pytest.mark.parametrize("name", lqd_search.__all__)
def test_every_public_name_is_there(name):
    # Aliases of callables go by the name of what they alias, constants have none.
    assert getattr(getattr(lqd_search, name), "__name__", name) in (name, "Callable")


def test_the_three_lists_of_names_agree():
    tree = ast.parse(Path(lqd_search.__file__).read_text("utf-8"))
    imported = {
        node.module.removeprefix("lqd_search."): {alias.name for alias in node.names}
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.module.startswith("lqd_search.")
    }

    assert imported == {module: set(names) for module, names in lqd_search._HOMES.items()}
    assert sorted(set().union(*imported.values())) == sorted(lqd_search.__all__)


def test_dir_lists_the_public_names():
    assert set(lqd_search.__all__) <= set(dir(lqd_search))


def test_other_names_are_not():
    with pytest.raises(AttributeError, match="has no attribute 'Nothing'"):
        _ = lqd_search.Nothing


def test_importing_the_package_does_not_import_pyribs():
    code = "import sys, lqd_search; sys.exit('ribs' in sys.modules)"

    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize("package", ["ribs", "click"])
def test_the_command_says_what_to_install_where_a_package_is_missing(package):
    code = (
        f"import sys; sys.modules['{package}'] = None; sys.argv = ['lqd', 'run', '--help'];"
        "from lqd_search.__main__ import main; main()"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False
    )

    assert result.returncode == 2
    assert result.stderr == (
        f"lqd: Expected the packages of the extra `search`, but {package} is not installed; run "
        "`pip install '.[all]'` in a clone of lqd-envs.\n"
    )


def test_an_interrupt_during_the_imports_is_one_line_and_status_130():
    code = """
import sys

class Interrupt:
    def find_spec(self, name, *_):
        if name == "ribs":
            raise KeyboardInterrupt

sys.meta_path.insert(0, Interrupt())
sys.argv = ["lqd", "run", "--help"]
from lqd_search.__main__ import main
main()
"""
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False
    )

    assert result.returncode == 130
    assert result.stderr.strip() == "lqd: stopped"


def test_numpy_is_new_enough_to_be_told_to_write_no_pickles():
    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text("utf-8"))
    (numpy,) = [line for line in project["project"]["dependencies"] if line.startswith("numpy")]

    # Older ones take `allow_pickle` of np.savez for the name of one more column.
    assert tuple(map(int, re.fullmatch(r"numpy>=(\d+)\.(\d+)", numpy).groups())) >= (2, 2)
