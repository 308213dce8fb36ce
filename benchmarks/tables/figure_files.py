"""A figure as the contents of files."""

import io
from collections.abc import Mapping

from matplotlib import rc_context
from matplotlib.figure import Figure

from lqd_search.pictures.figure import png


def figure_files(name: str, figure: Figure) -> Mapping[str, bytes]:
    """Return a figure as PNG and as SVG, by file name; the same figure gives the same bytes.

    Args:
        name: What the files are called, without their endings.
        figure: The figure.
    """
    return {f"{name}.png": png(figure), f"{name}.svg": _svg(figure)}


def _svg(figure: Figure) -> bytes:
    buffer = io.BytesIO()
    # Otherwise the ids in it are random, and the date stands in it.
    with rc_context({"svg.hashsalt": "lqd"}):
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    return buffer.getvalue()
