"use strict";

// Plotly reads a little markup in texts; names are shown as they are.
function plainText(text) {
  return String(text).replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
}

const PLOT_OPTIONS = { displaylogo: false, responsive: true, modeBarButtonsToRemove: ["lasso2d", "select2d"] };
const PLOT_FONT = { family: "system-ui, sans-serif", size: 12, color: "#1d232b" };
const RUN_COLORS = [
  "#0b5cad", "#d1632b", "#2a8a4a", "#8a4fb0", "#b3303a", "#167d8c", "#8c6a1a", "#c2458a", "#56616d", "#6f7f15",
];
const RUN_DASHES = ["solid", "dash", "dot", "dashdot"];

function drawCurves(place, curves, labels) {
  const columns = 2;
  const rows = Math.ceil(curves.length / columns);
  const traces = [];
  const layout = {
    grid: { rows, columns, pattern: "independent", xgap: 0.12, ygap: 0.28 },
    margin: { l: 55, r: 15, t: 30, b: 45 },
    font: PLOT_FONT,
    showlegend: labels.length > 1,
    legend: { orientation: "h", y: -0.08 },
    annotations: [],
    hovermode: "closest",
  };
  const named = new Set();
  curves.forEach((curve, i) => {
    const suffix = i === 0 ? "" : String(i + 1);
    for (const line of curve.lines) {
      traces.push({
        x: line.x, y: line.y, xaxis: "x" + suffix, yaxis: "y" + suffix,
        mode: "lines+markers", marker: { size: 4 },
        line: {
          color: RUN_COLORS[line.run % RUN_COLORS.length],
          dash: RUN_DASHES[Math.floor(line.run / RUN_COLORS.length) % RUN_DASHES.length],
        },
        name: plainText(labels[line.run]), legendgroup: String(line.run),
        showlegend: !named.has(line.run),
      });
      named.add(line.run);
    }
    layout["xaxis" + suffix] = { rangemode: "tozero", title: { text: i < curves.length - columns ? "" : "evaluations" } };
    layout["yaxis" + suffix] = { rangemode: "tozero" };
    layout.annotations.push({
      text: plainText(curve.title), showarrow: false, xref: "x" + suffix + " domain", yref: "y" + suffix + " domain",
      x: 0, y: 1.02, xanchor: "left", yanchor: "bottom", font: { size: 13 },
    });
  });
  return Plotly.newPlot(place, traces, layout, PLOT_OPTIONS);
}
