"""Loading what Python and NumPy would load later, while files can still be opened.

This file runs in the worker.
"""

import importlib
import importlib.util
import unicodedata  # noqa: F401 (reading "\N{...}" in a source needs it)

import numpy as np

# NumPy imports these when they are first needed, and newer Pythons the last.
_LATE = (
    *("numpy._core._dtype", "numpy._core._dtype_ctypes", "numpy._core._exceptions"),
    *("numpy._core._internal", "numpy._core._methods", "numpy._core.arrayprint"),
    *("numpy._core.einsumfunc", "numpy._core.fromnumeric", "numpy._core.function_base"),
    *("numpy.exceptions", "numpy.lib", "numpy.linalg", "numpy.linalg._linalg", "numpy.ma"),
    "_pylong",
)


def warm_up() -> None:
    """Import late modules, and use linear algebra once."""
    for name in _LATE:
        # Which of them there are depends on the versions of NumPy and Python.
        if importlib.util.find_spec(name) is not None:
            importlib.import_module(name)
    square = np.array([[2.0, 1.0], [1.0, 3.0]])
    np.linalg.inv(square)
    np.linalg.eigh(square)
    np.linalg.svd(square)
    np.linalg.norm(square.mean(axis=0))
    str(square)
