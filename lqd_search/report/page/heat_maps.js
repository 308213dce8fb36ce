"use strict";

const SHADES = {
  successes: "elites with a success",
  experts: "approved by the expert",
  best: "best fitness of a success",
};

const GREY = "#d5d9de";

// Draws the panels of one map; `marks` are numbered places in its space, and `pick` is told which was clicked.
function drawHeatMap(place, map, { shade, approval, marks, pick }) {
  for (const old of place.children) Plotly.purge(old);
  place.replaceChildren();
  return Promise.all(map.panels.map((panel) => {
    const panelPlace = document.createElement("div");
    panelPlace.className = panel.axes.length === 1 ? "row" : map.panels.length === 1 ? "single" : "";
    place.append(panelPlace);
    return drawPanel(panelPlace, map, panel, { shade, approval, marks, pick });
  }));
}

async function drawPanel(place, map, panel, { shade, approval, marks, pick }) {
  const layers = layersOf(map, panel, { shade, approval });
  const traces = panel.axes.length === 1 ? bars(map, layers) : pictures(map, panel, layers, shade);
  if (marks.length) traces.push(marked(marks, panel.axes));
  await Plotly.newPlot(place, traces, {
    margin: { l: 55, r: 10, t: 30, b: 42 },
    font: PLOT_FONT,
    showlegend: false,
    bargap: 0,
    barmode: "overlay",
    ...axesOf(map, panel, shade),
  }, PLOT_OPTIONS);
  place.on("plotly_click", (event) => {
    const point = event.points.find((candidate) => candidate.data.meta === "marks");
    if (point) pick(point.pointIndex);
  });
}

// Where only failures are kept a place is grey, elsewhere bright; each has its values as a text. A success
// without a fitness has the lowest color.
function layersOf(map, panel, { shade, approval }) {
  const [a, b] = panel.axes;
  const rows = b === undefined ? 1 : map.dims[b];
  const empty = () => Array.from({ length: rows }, () => new Array(map.dims[a]).fill(null));
  const layers = { bright: empty(), grey: empty(), texts: empty() };
  const lowest = Math.min(...panel.best.filter((value, k) => value !== null && panel[approval][k] > 0));
  const worst = Number.isFinite(lowest) ? lowest : 0;
  panel.place.forEach((flat, k) => {
    const [column, row] = [Math.floor(flat / rows), flat % rows];
    const approved = panel[approval][k] > 0;
    const count = panel[shade][k] || (approved ? 0 : null);
    const value = shade === "best" ? (approved ? panel.best[k] ?? worst : null) : count;
    if (value === null) layers.grey[row][column] = 1;
    else layers.bright[row][column] = value;
    layers.texts[row][column] = describe(map, panel, k, column, row);
  });
  return layers;
}

function pictures(map, panel, { bright, grey, texts }, shade) {
  const [a, b] = panel.axes;
  const common = {
    type: "heatmap", ...span("x", map.ranges[a], map.dims[a]), ...span("y", map.ranges[b], map.dims[b]),
    hovertext: texts, hovertemplate: "%{hovertext}<extra></extra>", hoverongaps: false,
  };
  return [
    { ...common, z: grey, colorscale: [[0, GREY], [1, GREY]], showscale: false },
    {
      ...common, z: bright, colorscale: "Viridis",
      showscale: bright.some((line) => line.some((value) => value !== null)),
      ...(shade === "best" ? {} : { zmin: 0, zmax: Math.max(...panel[shade], 1) }),
      colorbar: { thickness: 10, title: { text: SHADES[shade], side: "right", font: { size: 11 } } },
    },
  ];
}

// One dimension is easier to read as heights than as colors.
function bars(map, { bright, grey, texts }) {
  const common = {
    type: "bar", ...span("x", map.ranges[0], map.dims[0]), width: (map.ranges[0][1] - map.ranges[0][0]) / map.dims[0],
    hovertext: texts[0], hovertemplate: "%{hovertext}<extra></extra>",
  };
  const top = Math.max(...bright[0].filter((value) => value !== null).map(Math.abs), 0) || 1;
  return [
    { ...common, y: grey[0].map((value) => value && 0.04 * top), marker: { color: GREY, line: { width: 0 } } },
    // One of no height could not be pointed at.
    { ...common, y: bright[0].map((value) => (value === 0 ? 0.04 * top : value)), marker: { color: RUN_COLORS[0], line: { width: 0 } } },
  ];
}

function axesOf(map, panel, shade) {
  const [a, b] = panel.axes;
  const axis = (i) => ({ title: { text: plainText(map.axes[i]), standoff: 5 }, range: map.ranges[i], showgrid: false, zeroline: false });
  return { xaxis: axis(a), yaxis: b === undefined ? { title: { text: SHADES[shade], standoff: 5 } } : axis(b) };
}

function span(axis, [low, high], cells) {
  const width = (high - low) / cells;
  return { [axis + "0"]: low + width / 2, ["d" + axis]: width };
}

function marked(marks, [a, b]) {
  return {
    type: "scatter", mode: "markers+text", meta: "marks", cliponaxis: false,
    x: marks.map((measures) => measures[a]),
    y: marks.map((measures) => (b === undefined ? 0 : measures[b])),
    text: marks.map((_, i) => String(i + 1)),
    textfont: { size: 9, color: "#fff" },
    marker: { size: 14, color: "#b3303a", line: { color: "#fff", width: 1 } },
    hovertemplate: "rollout %{text}: click to see it<extra></extra>",
  };
}

function describe(map, panel, k, column, row) {
  const cell = [column, row];
  const lines = panel.axes.map((axis, i) => {
    const [low, high] = map.ranges[axis];
    const width = (high - low) / map.dims[axis];
    const [from, to] = [low + width * cell[i], low + width * (cell[i] + 1)].map((x) => x.toPrecision(4));
    return `${plainText(map.axes[axis])}: ${from} to ${to}`;
  });
  const best = panel.best[k] === null ? "no fitness" : `fitness ${panel.best[k]}`;
  return [
    ...lines,
    `elites: ${panel.filled[k]}, successes: ${panel.successes[k]}, by the expert: ${panel.experts[k]}`,
    `the best: elite ${panel.elite[k]}, evaluation ${panel.evaluation[k]}, ${best}`,
  ].join("<br>");
}
