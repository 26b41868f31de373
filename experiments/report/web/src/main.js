// SPDX-License-Identifier: GPL-3.0-or-later
// Adds plots, packings, comparisons and downloads to the page. All other parts of the page work without scripts.
import {variantLooks} from "./charts.js";
import {addComparison} from "./compare.js";
import {addThemeSwitch, save, whenNear} from "./dom.js";
import {Plot} from "./plot.js";
import {RunTable} from "./runs.js";
import {showPacking, Viewer} from "./viewer.js";

const data = JSON.parse(document.getElementById("report-data").textContent);

// A plot is drawn when it comes near the visible part of the page, or before the page is printed.
function addPlots() {
  const waiting = new Set();
  const draw = (host) => {
    if (waiting.delete(host)) new Plot(host, data.charts[host.dataset.chart], host.dataset.chart);
  };
  for (const host of document.querySelectorAll("[data-chart]")) {
    waiting.add(host);
    whenNear(host, () => draw(host));
  }
  window.addEventListener("beforeprint", () => [...waiting].forEach(draw));
}

function addViewer() {
  if (data.packings.length === 0) return;
  const section = document.getElementById("packings");
  section.hidden = false;
  let viewer = null;
  const open = () => (viewer ??= new Viewer(section.querySelector(".viewer"), data.packings, 1));
  whenNear(section, open);
  for (const link of document.querySelectorAll("[data-packing]")) {
    link.hidden = false;
    link.addEventListener("click", () =>
      open().showRuns([data.packings.find(({id}) => id === link.dataset.packing)]));
  }
}

// Shows the most crystalline final state at the top of the page.
function addOpening() {
  if (data.packings.length === 0) return;
  const host = document.getElementById("opening");
  const end = ({frames}) => frames.at(-1).crystalline;
  const best = data.packings.reduce((one, other) => end(other) > end(one) ? other : one);
  host.hidden = false;
  showPacking(host.querySelector(".packing"), best);
  host.querySelector("[data-part=name]").textContent = `${best.experiment}: ${best.label}`;
}

const looks = new Map(data.experiments.map((one) => [one.experiment, variantLooks(one, Object.entries(data.charts)
  .filter(([id]) => id.startsWith(`${one.experiment}.`)).map(([, chart]) => chart))]));
const theme = document.getElementById("theme");
theme.parentElement.hidden = false;
addThemeSwitch(theme);
addOpening();
addPlots();
addViewer();
for (const host of document.querySelectorAll("[data-runs]")) {
  new RunTable(host, data.experiments.find(({experiment}) => experiment === host.dataset.runs), looks.get(host.dataset.runs));
}
if (data.experiments.some(({runs}) => runs.some((run) => run.cycle))) {
  const section = document.getElementById("compare");
  section.hidden = false;
  whenNear(section, () =>
    addComparison(section.querySelector(".comparison"), data.experiments, data.packings, looks));
}
for (const button of document.querySelectorAll("[data-csv]")) {
  button.hidden = false;
  button.addEventListener("click", () => {
    const name = button.dataset.csv;
    save(`${name}.csv`, new Blob([document.getElementById(`csv-${name}`).textContent], {type: "text/csv"}));
  });
}

// A link to a closed <details> opens it.
function openTarget() {
  const target = location.hash.length > 1 && document.getElementById(location.hash.slice(1));
  if (target instanceof HTMLDetailsElement) target.open = true;
}
window.addEventListener("hashchange", openTarget);
openTarget();

// All parts have been added, so the messages that plots need JavaScript are removed.
for (const sentence of document.querySelectorAll(".unscripted")) sentence.remove();
