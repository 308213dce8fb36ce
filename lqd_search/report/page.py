"""The page of a report, in which everything that it needs is contained."""

from base64 import b64encode
from collections.abc import Sequence
from hashlib import sha256
from importlib.resources import files
from typing import Any

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup
from plotly.offline import get_plotlyjs

from lqd_search.report.chosen_elites import choose_elites
from lqd_search.report.curves import curves_of
from lqd_search.report.figures import figure_rows, notes, settings_rows
from lqd_search.report.heat_maps import HeatMap, grid_map, ground_truth_map
from lqd_search.report.listings import highlighting_style, listings_of
from lqd_search.report.report_file import GENERATOR
from lqd_search.report.reported_run import ReportedRun
from lqd_search.report.rollouts import Rollout, rollouts_of, stage_of
from lqd_search.report.scene_parts import STEP

_SCRIPTS = ("curves", "heat_maps", "solids", "viewer", "player", "page")


def render_report(runs: Sequence[ReportedRun], *, rollouts: int) -> str:
    """Return an HTML page that shows runs, the same for the same runs.

    It holds its scripts, styles and data, and its Content-Security-Policy allows no others: what a
    model wrote is text in it, whatever it contains.

    Args:
        runs: One or more.
        rollouts: How many rollouts to show of each run, at most.
    """
    shown = [_rollouts(run, n=rollouts) for run in runs]
    scripts = [get_plotlyjs(), "\n".join(_text(f"{name}.js") for name in _SCRIPTS)]
    environment = Environment(autoescape=True, undefined=StrictUndefined)
    environment.policies["json.dumps_kwargs"] = {
        "sort_keys": True,
        "separators": (",", ":"),
        "allow_nan": False,
    }
    return environment.from_string(_text("page.html")).render(
        generator=GENERATOR,
        policy=_policy(scripts),
        title=_title(runs),
        labels=[run.label for run in runs],
        settings=settings_rows(runs),
        figures=figure_rows(runs),
        notes=[(run.label, notes(run)) for run in runs if notes(run)],
        functionals=listings_of(runs),
        has_rollouts=any(shown),
        style=Markup(_text("page.css") + highlighting_style()),
        scripts=[Markup(script) for script in scripts],
        data=_data(runs, shown),
    )


def _rollouts(run: ReportedRun, *, n: int) -> list[Rollout]:
    elites = choose_elites(run.archive, ground_truth=run.task.ground_truth, n=n)
    return rollouts_of(run.task, run.archive, elites=elites)


def _data(runs: Sequence[ReportedRun], shown: Sequence[list[Rollout]]) -> dict[str, Any]:
    tasks = {run.task.id: run.task for run, rollouts in zip(runs, shown, strict=True) if rollouts}
    return {
        "step": STEP,
        "curves": curves_of(runs),
        "stages": {name: stage_of(task) for name, task in tasks.items()},
        "runs": [
            {
                "label": run.label,
                "task": run.task.id,
                "maps": _maps(run),
                "measures": list(run.task.ground_truth.names),
                "rollouts": rollouts,
            }
            for run, rollouts in zip(runs, shown, strict=True)
        ],
    }


def _maps(run: ReportedRun) -> list[HeatMap]:
    grids = run.archive.grids.items()
    return [
        ground_truth_map(run.task.ground_truth, archive=run.archive),
        *(grid_map(name, grid, fields=run.archive.fields) for name, grid in grids),
    ]


def _title(runs: Sequence[ReportedRun]) -> str:
    if len(runs) > 1:
        return f"{len(runs)} runs"
    (run,) = runs
    return f"{run.config.task} · {run.config.method} · seed {run.config.seed}"


def _policy(scripts: Sequence[str]) -> str:
    """Return a policy that allows these scripts, styles and pictures of the page, and no more."""
    hashes = [b64encode(sha256(script.encode()).digest()).decode() for script in scripts]
    allowed = " ".join(f"'sha256-{digest}'" for digest in hashes)
    return (
        f"default-src 'none'; script-src {allowed}; style-src 'unsafe-inline'; "
        "img-src data: blob:; base-uri 'none'; form-action 'none'"
    )


def _text(name: str) -> str:
    return (files("lqd_search.report") / "page" / name).read_text("utf-8")
