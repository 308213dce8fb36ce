"""A figure without a display, as PNG bytes."""

import io

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

SUCCESS_COLORS = "viridis"
FAILURE_COLOR = "0.82"
_DPI = 110
_TITLE = 0.4


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure of the given size in inches, apart from pyplot's global state."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def new_panels(width: float, height: float, *, rows: int, columns: int) -> Figure:
    """Return an empty figure for panels of one kind, with room for their labels and color bars.

    Args:
        width: Of one panel with its labels, in inches.
        height: The same.
        rows: Rows of panels.
        columns: Columns of panels.
    """
    total_width, total_height = width * columns, height * rows + _TITLE
    # Fixed margins: to lay out dozens of pictures by their contents would take half of the time.
    figure = Figure(figsize=(total_width, total_height))
    figure.subplots_adjust(
        left=0.95 / total_width,
        right=1.0 - 0.4 / total_width,
        bottom=0.55 / total_height,
        top=1.0 - (_TITLE + 0.15) / total_height,
        wspace=0.42,
        hspace=0.36,
    )
    FigureCanvasAgg(figure)
    return figure


def png(figure: Figure) -> bytes:
    """Return the figure as the bytes of a PNG file."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=_DPI)
    return buffer.getvalue()
