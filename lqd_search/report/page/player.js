"use strict";

const FRAME_SECONDS = 0.02;
const REST_SECONDS = 0.8;

// Plays the rollouts of one run at a time.
class Player {
  constructor(data) {
    this.data = data;
    this.viewer = new Viewer(document.getElementById("player-canvas"), data.step);
    this.list = document.getElementById("player-list");
    this.facts = document.getElementById("player-facts");
    this.button = document.getElementById("player-play");
    this.time = document.getElementById("player-time");
    this.clock = document.getElementById("player-clock");
    this.speed = document.getElementById("player-speed");
    this.playing = false;
    this.seconds = 0;
    this.button.addEventListener("click", () => this.play(!this.playing));
    this.time.addEventListener("input", () => {
      this.play(false);
      this.seek(Number(this.time.value) * FRAME_SECONDS);
    });
  }

  show(run) {
    this.run = run;
    this.list.replaceChildren();
    for (const control of [this.button, this.time, this.speed]) control.disabled = !run.rollouts.length;
    if (!run.rollouts.length) {
      this.clear();
      this.list.textContent = "This run has no success that could be shown.";
      return;
    }
    this.buttons = run.rollouts.map((_, i) => {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = String(i + 1);
      button.addEventListener("click", () => { this.pick(i); this.play(true); });
      return button;
    });
    this.list.append("Rollout", ...this.buttons);
    this.viewer.show(this.data.stages[run.task]);
    this.pick(0);
  }

  // Nothing of the run that was shown before is left.
  clear() {
    this.play(false);
    this.rollout = null;
    this.buttons = [];
    this.facts.replaceChildren();
    this.time.value = "0";
    this.clock.textContent = "";
    this.viewer.clear();
  }

  pick(number) {
    this.rollout = this.run.rollouts[number];
    this.buttons.forEach((button, i) => button.setAttribute("aria-pressed", String(i === number)));
    this.width = 7 * this.data.stages[this.run.task].bodies.length;
    this.last = this.rollout.poses.length / this.width - 1;
    this.time.max = String(this.last);
    showFacts(this.facts, this.run, this.rollout);
    this.seek(0);
  }

  seek(seconds) {
    this.seconds = seconds;
    this.frame = Math.min(this.last, Math.floor(seconds / FRAME_SECONDS + 1e-6));
    this.time.value = String(this.frame);
    this.clock.textContent = `${(this.frame * FRAME_SECONDS).toFixed(2)} s`;
    this.viewer.pose(this.rollout.poses, this.frame * this.width);
  }

  play(playing) {
    const begins = playing && !this.playing;
    this.playing = playing;
    this.button.textContent = playing ? "Pause" : "Play";
    if (!begins) return;
    let before = performance.now();
    const tick = (now) => {
      if (!this.playing) return;
      const next = this.seconds + (Math.max(0, now - before) / 1000) * Number(this.speed.value);
      before = now;
      this.seek(next > this.last * FRAME_SECONDS + REST_SECONDS ? 0 : next);
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }
}

function showFacts(place, run, rollout) {
  const yes = (answer) => (answer ? "yes" : "no");
  const facts = [
    ["Elite", `${rollout.elite} of ${run.label}`],
    ["Evaluation", String(rollout.evaluation)],
    ["Fitness", rollout.fitness === null ? "none" : String(rollout.fitness)],
    ["Success", `${yes(rollout.expert)} by the expert's condition, ${yes(rollout.success)} by the run's own`],
    ...run.measures.map((name, i) => [name, String(rollout.ground_truth[i])]),
    ["Solution", rollout.solution.join(", ")],
    ["As the run saw it, bit for bit", rollout.same ? "yes" : "no; other versions may have simulated it then"],
    ["Carry it out again", `lqd replay DIR --index ${rollout.elite}`, "code"],
    ["DIR", `the folder of ${run.label}`],
  ];
  place.replaceChildren(...facts.flatMap(([name, value, style]) => {
    const [term, detail] = [document.createElement("dt"), document.createElement("dd")];
    term.textContent = name;
    detail.textContent = value;
    if (style) detail.className = style;
    return [term, detail];
  }));
}
