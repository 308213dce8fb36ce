"""Pages, as text and in a browser."""

import json
import re
from base64 import b64encode
from dataclasses import replace
from hashlib import sha256
from html.parser import HTMLParser

import matplotlib.image
import numpy as np
import pytest

from lqd_search.archives.grid_spec import GridSpec
from lqd_search.report import render_report, write_report
from lqd_search.runs.stored_archive import StoredArchive, StoredGrid

HOSTILE = (
    "</script><script>window.stolen = 1</script><!-- --> ]]> \" ' ` "
    '<img src=x onerror="window.stolen = 2"> <a href="https://example.org">here</a> '
    "%{x} $x$ {{ 7 * 7 }} &lt;b&gt; \u2028"
)


class Markup(HTMLParser):
    """What a page's markup has: tags with their attributes, and its scripts' types and texts."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.scripts = [], []
        self._script, self._type = False, None
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        self._script, self._type = tag == "script", dict(attributes).get("type")

    def handle_endtag(self, _):
        self._script = False

    def handle_data(self, text):
        if self._script:
            self.scripts.append((self._type, text))


def rendered(*runs, rollouts=2):
    return render_report(runs, rollouts=rollouts)


def data_of(page):
    found = re.search(r'<script id="data" type="application/json">(.*?)</script>', page)
    return json.loads(found[1])


def test_the_page_refers_to_nothing_outside_of_it(new_run):
    markup = Markup(rendered(new_run(), rollouts=0))

    places = [a[n] for _, a in markup.tags for n in ("src", "href", "action") if n in a]
    assert places
    assert all(place.startswith("#") for place in places)
    assert not {tag for tag, _ in markup.tags} & {"link", "iframe", "object", "embed", "base"}
    (policy,) = [a["content"] for _, a in markup.tags if "Policy" in a.get("http-equiv", "")]
    assert policy.startswith("default-src 'none'; script-src 'sha256-")
    assert "http" not in policy
    assert "unsafe-eval" not in policy


def test_the_policy_allows_the_scripts_as_they_stand_in_the_page(new_run):
    markup = Markup(rendered(new_run(), rollouts=1))

    (policy,) = [a["content"] for _, a in markup.tags if "Policy" in a.get("http-equiv", "")]
    allowed = re.search(r"script-src ([^;]*)", policy)[1].split()
    executed = [text for kind, text in markup.scripts if kind is None]
    hashes = [b64encode(sha256(text.encode()).digest()).decode() for text in executed]
    assert allowed == [f"'sha256-{one}'" for one in hashes]
    assert len(executed) == 2


def test_what_a_model_wrote_never_becomes_markup(new_run):
    plain, hostile = (
        Markup(rendered(new_run(text, text=text), rollouts=0)) for text in ("plain", HOSTILE)
    )

    assert [tag for tag, _ in plain.tags if tag != "span"] == [
        tag for tag, _ in hostile.tags if tag != "span"
    ]
    assert len(plain.scripts) == len(hostile.scripts) == 3


def test_the_same_runs_give_the_same_page(new_run):
    runs = new_run("one"), new_run("two")

    assert rendered(*runs) == rendered(*runs)


def test_the_page_has_every_run_s_figures_side_by_side(new_run):
    page = rendered(new_run("one"), new_run("two"), rollouts=0)

    assert re.search(r"distinct elites</th><td>3</td><td>3</td>", page)
    assert re.search(r'task</th><td colspan="2">LQD/Faucet-v0</td>', page)
    assert re.search(r"found when exploring flat</th><td>3 \(kept\)</td>", page)
    assert [line["run"] for line in data_of(page)["curves"][0]["lines"]] == [0, 1]


def test_the_page_of_a_large_archive_is_small(new_run, archive):
    rng = np.random.default_rng(0)
    n, rows = 60_000, rng.integers(len(archive), size=60_000)
    spec = GridSpec(dims=(100, 100), ranges=((-1.0, 1.0),) * 2)
    cells = np.arange(spec.cells)
    grids = {
        f"h{i % 4}.g{i // 4}": StoredGrid(
            spec, cells, rng.integers(n, size=len(cells)), np.zeros((len(cells), 2))
        )
        for i in range(16)
    }
    fields = {name: column[rows] for name, column in archive.fields.items()}
    large = StoredArchive(fields | {"objective": rng.random(n)}, grids)

    page = rendered(new_run(archive=large), rollouts=12)

    assert len(page) < 15e6


def test_the_archive_of_a_run_that_found_nothing_has_a_page(new_run, archive):
    fields = {name: column[:0] for name, column in archive.fields.items()}

    page = rendered(new_run(archive=StoredArchive(fields, {})))

    data = data_of(page)
    assert data["runs"][0]["rollouts"] == []
    assert 'id="player-canvas"' not in page
    assert "0 of 100 cells" in data["runs"][0]["maps"][0]["title"]


@pytest.fixture(scope="module")
def seen(new_run, look_at, tmp_path_factory):
    """Return a report of two runs as a browser shows it."""
    path = tmp_path_factory.mktemp("report") / "report.html"
    write_report(path, rendered(new_run("one"), new_run("two"), rollouts=3))
    with look_at(path) as page:
        yield page


def assert_calm(page):
    """Check that nothing failed, and that nothing was asked for but what the page holds."""
    assert page.complaints == []
    assert [url for url in page.requests if not url.startswith(("file:", "data:", "blob:"))] == []
    assert page.run("document.getElementById('failure').hidden")


def test_a_browser_draws_every_part(seen, tmp_path):
    state = seen.run("({ ...document.documentElement.dataset })")
    seen.picture(tmp_path / "page.png")

    assert state == {"drawn": "curves maps rollouts", "done": "yes"}
    assert seen.run("document.querySelectorAll('#curves-plot .subplot').length") == 6
    assert seen.run("document.querySelectorAll('#curves-plot .scatterlayer .trace').length") == 12
    assert matplotlib.image.imread(tmp_path / "page.png").std() > 0.05
    assert_calm(seen)


def test_a_browser_draws_every_grid_along_its_axes(seen):
    panels = {}
    for number in range(seen.run("document.querySelectorAll('#maps-list button').length")):
        seen.run(f"document.querySelectorAll('#maps-list button')[{number}].click()")
        seen.run(SETTLED)
        name = seen.run("document.getElementById('maps-name').textContent")
        panels[name] = seen.run("document.querySelectorAll('#maps-panels .subplot').length")

    assert panels == {
        "ground truth": 1,
        "start.row": 1,
        "start.place": 1,
        "end.place": 3,
        "end.pose": 10,
    }
    assert_calm(seen)


# Plotly may draw what is pending in the next frames.
SETTLED = """new Promise((resolve) => {
    const wait = (n) => (n ? requestAnimationFrame(() => wait(n - 1)) : resolve());
    wait(5);
})"""
LOOK = "document.getElementById('player-canvas').toDataURL()"
SEEK = """{
    const time = document.getElementById("player-time");
    time.value = 75;
    time.dispatchEvent(new Event("input"));
}"""
DRAG = """{
    const canvas = document.getElementById("player-canvas");
    canvas.setPointerCapture = () => {};
    for (const [kind, x] of [["pointerdown", 0], ["pointermove", 90], ["pointerup", 90]])
        canvas.dispatchEvent(new PointerEvent(kind, { clientX: x, clientY: 0, pointerId: 1 }));
}"""
WHEEL = """document.getElementById("player-canvas").dispatchEvent(
    new WheelEvent("wheel", { deltaY: 300, cancelable: true })
)"""
SECOND = "document.querySelectorAll('#player-list button')[1].click()"
PLAYED = """new Promise((resolve) => {
    const [clock, button] = ["clock", "play"].map((n) => document.getElementById(`player-${n}`));
    const watch = new MutationObserver(() => {
        if (clock.textContent < "0.1") return;
        watch.disconnect();
        resolve(button.textContent);
    });
    watch.observe(clock, { childList: true });
})"""
PLAY = "document.getElementById('player-play').click()"


PLACE = """(() => {
    const panel = document.querySelector("#maps-panels > div");
    panel.scrollIntoView({ behavior: "instant" });
    const { xaxis, yaxis } = panel._fullLayout;
    const { x0, dx, y0, dy, z } = panel.data[1];
    const row = z.findIndex((line) => line.some((value) => value !== null));
    const column = z[row].findIndex((value) => value !== null);
    const { left, top } = panel.getBoundingClientRect();
    return [
        left + xaxis._offset + xaxis.l2p(x0 + column * dx),
        top + yaxis._offset + yaxis.l2p(y0 + row * dy),
    ];
})()"""
HOVERED = """new Promise((resolve) => {
    const look = () => {
        const label = document.querySelector("#maps-panels .hovertext");
        label ? resolve(label.textContent) : requestAnimationFrame(look);
    };
    look();
})"""


LAYERS = """
(() => {
  const map = { dims: [4], ranges: [[0, 1]], axes: ["x"] };
  const panel = {
    axes: [0], place: [0, 1, 2, 3], best: [0.5, null, -9, 0.25], filled: [1, 1, 1, 1],
    successes: [1, 1, 0, 1], experts: [1, 1, 0, 1], elite: [0, 1, 2, 3], evaluation: [0, 1, 2, 3],
  };
  const { bright, grey } = layersOf(map, panel, { shade: "best", approval: "successes" });
  return [bright[0], grey[0]];
})()
"""


def test_a_success_without_a_fitness_is_no_failure(seen):
    bright, grey = seen.run(LAYERS)

    assert bright == [0.5, 0.25, None, 0.25]
    assert grey == [None, None, 1, None]


def test_pointing_at_a_place_shows_its_values(seen):
    seen.run("document.querySelectorAll('#maps-list button')[2].click()")
    seen.run(SETTLED)

    seen.point(*seen.run(PLACE))
    shown = seen.run(HOVERED)

    assert re.search(
        r"measure 0: \S+ to \S+measure 1: \S+ to \S+elites: 1, successes: 1, by the expert: 1"
        r"the best: elite \d+, evaluation \d+, fitness 0\.\d+",
        shown,
    )


def test_a_rollout_plays_and_can_be_turned(seen):
    pictures = [seen.run(LOOK)]
    for change in (SEEK, DRAG, WHEEL, SECOND):
        seen.run(change)
        if change == SECOND:
            assert seen.run(PLAYED) == "Pause"
            seen.run(PLAY)
        pictures.append(seen.run(LOOK))
    stopped = seen.run("document.getElementById('player-clock').textContent")
    seen.run(SETTLED)

    assert len(set(pictures)) == len(pictures)
    assert seen.run("document.getElementById('player-clock').textContent") == stopped
    assert_calm(seen)


SHOWN = """(() => {
    const part = (name) => document.getElementById(`player-${name}`);
    return {
        disabled: ["play", "time", "speed"].map((name) => part(name).disabled),
        texts: ["list", "facts", "clock"].map((name) => part(name).textContent),
        picture: part("canvas").toDataURL(),
    };
})()"""
CHOOSE = """{
    const select = document.querySelector("#player-bar select");
    select.value = "%d";
    select.dispatchEvent(new Event("change"));
}"""


@pytest.mark.slow
def test_of_a_run_without_rollouts_nothing_is_shown_and_nothing_plays(
    new_run, archive, look_at, tmp_path
):
    nothing = {**archive.fields, **dict.fromkeys(("success", "expert"), np.zeros(24, bool))}
    none = new_run("none", archive=StoredArchive(nothing, archive.grids))
    write_report(tmp_path / "report.html", rendered(new_run("one"), none, rollouts=2))

    with look_at(tmp_path / "report.html") as page:
        shown = [page.run(SHOWN)]
        for run in (1, 0):
            # The second time the button is disabled.
            page.run(PLAY)
            page.run(CHOOSE % run)
            page.run(SETTLED)
            shown.append(page.run(SHOWN))
        page.run("document.querySelector('#player-list button').click()")
        assert page.run(PLAYED) == "Pause"
        assert_calm(page)

    one, none, again = shown
    assert one["disabled"] == again["disabled"] == [False] * 3
    assert none["disabled"] == [True] * 3
    assert none["texts"] == ["This run has no success that could be shown.", "", ""]
    assert none["picture"] != one["picture"]
    assert again["texts"][:2] == one["texts"][:2]


def test_the_command_that_carries_a_rollout_out_names_no_folder_that_is_none(seen):
    facts = seen.run("document.getElementById('player-facts').textContent")

    assert re.search(r"Carry it out againlqd replay DIR --index \d+DIRthe folder of one$", facts)


def test_a_browser_shows_hostile_texts_as_texts(new_run, archive, look_at, tmp_path):
    grids = {f"{HOSTILE}.{HOSTILE}": archive.grids["end.place"]}
    hostile = new_run(HOSTILE, text=HOSTILE, archive=replace(archive, grids=grids))
    write_report(tmp_path / "report.html", rendered(hostile, new_run(), rollouts=1))

    with look_at(tmp_path / "report.html") as page:
        page.run("document.querySelectorAll('#maps-list button')[1].click()")
        page.run(SETTLED)
        assert page.run("window.stolen === undefined")
        assert page.run("document.querySelector('[onerror], a[href^=http]') === null")
        legend = page.run("document.querySelector('#curves-plot .legendtext').textContent")
        shown = page.run("document.getElementById('functionals').textContent")
        assert_calm(page)

    words = " ".join(HOSTILE.split())
    assert " ".join(legend.split()) == words
    assert words in " ".join(shown.split())
