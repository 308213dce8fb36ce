import ast
import subprocess
import sys
from pathlib import Path

import pytest

import lqd_envs
import lqd_llm
import lqd_search

ONLY_IN_THE_WORKER = ("lqd_llm.sandbox.defined_functions", "lqd_llm.sandbox.infos")
"""The modules that run code which they are given, or write themselves."""


@pytest.mark.parametrize("name", lqd_llm.__all__)
def test_every_public_name_is_there(name):
    assert getattr(lqd_llm, name) is not None


def test_other_names_are_not():
    with pytest.raises(AttributeError, match="has no attribute 'Nothing'"):
        _ = lqd_llm.Nothing


def test_importing_the_package_does_not_import_the_sdk():
    code = (
        "import sys, lqd_llm\n"
        "assert 'anthropic' not in sys.modules\n"
        "assert lqd_llm.LiveProvider.__name__ == 'LiveProvider'\n"
        "assert 'anthropic' in sys.modules"
    )

    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def runs_code(file):
    """Whether a module names what runs text as code; compiling it alone runs nothing."""
    tree = ast.parse(file.read_text())
    names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    return not names.isdisjoint({"exec", "eval", "__import__"})


def test_no_other_module_runs_code_than_those_of_the_worker():
    found = {
        ".".join([package.__name__, *file.relative_to(folder).with_suffix("").parts])
        for package in (lqd_envs, lqd_search, lqd_llm)
        for folder in [Path(package.__file__).parent]
        for file in folder.rglob("*.py")
        if runs_code(file)
    }

    assert found == set(ONLY_IN_THE_WORKER)


def test_the_process_that_steers_a_run_does_not_import_them():
    code = (
        "import sys\n"
        "import lqd_llm.sandbox, lqd_search.cli.run, lqd_search.cli.evaluator_recipe\n"
        "import lqd_search.cli.checked_functionals, lqd_search.cli.opened_sandbox\n"
        "import lqd_search.cli.sandbox_judge\n"
        "assert 'lqd_llm.sandbox.supervisor' in sys.modules\n"
        f"assert sys.modules.keys().isdisjoint({ONLY_IN_THE_WORKER!r})"
    )

    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
