"use strict";

// Where a part of the page fails, the page says so; tests read what was drawn from its root.
function report(part, error) {
  const place = document.getElementById("failure");
  place.hidden = false;
  place.append(`The ${part} could not be drawn: ${error.message || error} `);
  document.documentElement.dataset.failed = part;
}

function drawn(part) {
  const root = document.documentElement.dataset;
  root.drawn = `${root.drawn || ""} ${part}`.trim();
}

function selection(name, entries, choose) {
  const label = document.createElement("label");
  const select = document.createElement("select");
  entries.forEach(([value, text]) => select.append(new Option(text, value)));
  select.addEventListener("change", () => choose(select.value));
  label.append(`${name} `, select);
  return [label, select];
}

class Maps {
  constructor(data, pick) {
    this.data = data;
    this.pick = pick;
    this.bar = document.getElementById("maps-bar");
    this.list = document.getElementById("maps-list");
    const [runs] = selection("Run", data.runs.map((run, i) => [i, run.label]), (i) => this.show(Number(i)));
    const [shades, shade] = selection("Color", Object.entries(SHADES), (value) => { this.chosen = value; return this.draw(); });
    this.shade = shade;
    this.bar.append(...(data.runs.length > 1 ? [runs] : []), shades);
  }

  show(run) {
    this.run = this.data.runs[run];
    this.list.replaceChildren(mapButtons(this.run.maps, (i) => this.open(i)));
    return this.open(0);
  }

  open(number) {
    this.map = this.run.maps[number];
    this.list.querySelectorAll("button").forEach((button) => {
      button.setAttribute("aria-pressed", String(Number(button.dataset.map) === number));
    });
    document.getElementById("maps-name").textContent = this.map.name;
    document.getElementById("maps-title").textContent = this.map.title;
    return this.draw();
  }

  draw() {
    const truth = this.map === this.run.maps[0];
    // Where a place is one cell, its count says little.
    const usual = truth ? "experts" : this.map.dims.length > 2 ? "successes" : "best";
    this.shade.value = this.chosen || usual;
    return drawHeatMap(document.getElementById("maps-panels"), this.map, {
      shade: this.shade.value,
      approval: truth ? "experts" : "successes",
      marks: truth ? this.run.rollouts.map((rollout) => rollout.ground_truth) : [],
      pick: (i) => this.pick(this.data.runs.indexOf(this.run), i),
    });
  }
}

// The descriptors' names have two parts, a moment and a quantity: they make a table, as the mesh does.
function mapButtons(maps, open) {
  const button = (map, number, text) => {
    const made = document.createElement("button");
    made.type = "button";
    made.dataset.map = number;
    made.textContent = text;
    made.title = map.title;
    made.addEventListener("click", () => open(number));
    return made;
  };
  const table = document.createElement("table");
  const row = (...cells) => cells.reduce((line, cell) => { line.insertCell().append(cell); return line; }, table.insertRow());
  row("", button(maps[0], 0, `ground truth: ${maps[0].filled}`));
  const moments = new Map();
  const quantities = [];
  maps.slice(1).forEach((map, i) => {
    const [moment, quantity] = map.name.split(/\.(.*)/s).concat("").slice(0, 2);
    if (!quantities.includes(quantity)) quantities.push(quantity);
    if (!moments.has(moment)) moments.set(moment, new Map());
    moments.get(moment).set(quantity, [map, i + 1]);
  });
  if (quantities.some((quantity) => quantity)) row("", ...quantities);
  for (const [moment, cells] of moments) {
    row(moment, ...quantities.map((quantity) => {
      const cell = cells.get(quantity);
      return cell ? button(...cell, `${cell[0].successes} of ${cell[0].filled}`) : "";
    }));
  }
  if (maps.length > 1) table.createCaption().textContent = "Successes of filled cells in each grid; choose one to see it.";
  return table;
}

function startPlayer(data) {
  const player = new Player(data);
  const bar = document.getElementById("player-bar");
  const first = data.runs.findIndex((run) => run.rollouts.length);
  const [runs, select] = selection("Run", data.runs.map((run, i) => [i, run.label]), (i) => player.show(data.runs[i]));
  select.value = String(first);
  if (data.runs.length > 1) bar.append(runs);
  player.show(data.runs[first]);
  player.play(false);
  player.select = select;
  return player;
}

async function drawPage() {
  const data = JSON.parse(document.getElementById("data").textContent);
  let player = null;
  const pick = (run, number) => {
    if (!player) return;
    player.select.value = String(run);
    player.show(data.runs[run]);
    player.pick(number);
    player.play(true);
    document.getElementById("rollouts").scrollIntoView({ behavior: "smooth" });
  };
  const parts = {
    curves: () => drawCurves(document.getElementById("curves-plot"), data.curves, data.runs.map((run) => run.label)),
    maps: () => new Maps(data, pick).show(0),
    rollouts: () => { if (document.getElementById("player-canvas")) player = startPlayer(data); },
  };
  for (const [part, draw] of Object.entries(parts)) {
    try {
      await draw();
      drawn(part);
    } catch (error) {
      report(part, error);
    }
  }
  document.documentElement.dataset.done = "yes";
}

drawPage();
