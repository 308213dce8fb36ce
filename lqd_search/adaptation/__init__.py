"""Using an archive on an occasion that nobody named beforehand: which motions solve an instance."""

from lqd_search.adaptation.archive_view import ArchiveView
from lqd_search.adaptation.attempts import AdaptationError, Attempts, solving, try_motions
from lqd_search.adaptation.instance_replay import replay_in
from lqd_search.adaptation.selectors import SELECTORS, NamedSelector, Selector
from lqd_search.runs.replay import Replay, ReplayError

__all__ = [
    "SELECTORS",
    "AdaptationError",
    "ArchiveView",
    "Attempts",
    "NamedSelector",
    "Replay",
    "ReplayError",
    "Selector",
    "replay_in",
    "solving",
    "try_motions",
]
