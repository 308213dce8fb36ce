"""Pictures of a run, drawn with matplotlib without a display."""

from lqd_search.pictures.curves import draw_curves
from lqd_search.pictures.ground_truth import draw_ground_truth
from lqd_search.pictures.heat_map import draw_heat_map

__all__ = ["draw_curves", "draw_ground_truth", "draw_heat_map"]
