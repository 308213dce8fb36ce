"""The file that a worker's interpreter runs: it finds the worker's modules, and nothing else.

The packages that hold them are made known by their folders alone, so that none of their
`__init__` files run: those import what a worker has no use for. NumPy is taken from where the host
found it.
"""

import importlib
import json
import sys
from types import ModuleType


def main() -> None:
    """Become the worker, or the probe, that the arguments ask for."""
    package, folder, libraries, part, order = sys.argv[1:]
    know_package(package, folder=folder, libraries=libraries)
    importlib.import_module(f"{package}.{part}").main(json.loads(order))


def know_package(package: str, *, folder: str, libraries: str) -> None:
    """Make a package's modules importable without running its `__init__`.

    Args:
        package: Its full name.
        folder: Where its modules are.
        libraries: Folder in which NumPy is.
    """
    sys.path.append(libraries)
    names = package.split(".")
    for depth in range(1, len(names) + 1):
        module = ModuleType(".".join(names[:depth]))
        module.__path__ = [folder] if depth == len(names) else []
        sys.modules[module.__name__] = module


if __name__ == "__main__":
    main()
