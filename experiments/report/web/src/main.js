// SPDX-License-Identifier: GPL-3.0-or-later
// Adds plots, packings, comparisons and downloads to the page; everything else works without scripts.
import {Comparison} from "./compare.js";
import {whenNear} from "./dom.js";
import {Plot} from "./plot.js";
import {RunTable} from "./run_table.js";
import {saveText} from "./save.js";
import {addThemeSwitch} from "./theme.js";
import {Viewer} from "./viewer.js";

const data = JSON.parse(document.getElementById("report-data").textContent);

// A plot is drawn when it is scrolled near the window, or before printing.
function addPlots() {
  const waiting = new Set();
  const draw = (host) => {
    if (waiting.delete(host)) new Plot(host, data.charts[host.dataset.chart], host.dataset.chart);
  };
  for (const host of document.querySelectorAll("[data-chart]")) {
    if (!data.charts[host.dataset.chart]) continue;
    waiting.add(host);
    whenNear(host, 300, () => draw(host));
  }
  window.addEventListener("beforeprint", () => [...waiting].forEach(draw));
}

function addViewer() {
  const section = document.getElementById("packings");
  if (!section || data.packings.length === 0) return;
  section.hidden = false;
  let viewer = null;
  const open = () => (viewer ??= new Viewer(section.querySelector(".viewer"), data.packings));
  whenNear(section, 200, open);
  for (const link of document.querySelectorAll("[data-packing]")) {
    link.hidden = false;
    link.addEventListener("click", () => open().showRunCalled(link.dataset.packing));
  }
}

function addRunTables() {
  for (const host of document.querySelectorAll("[data-runs]")) {
    const known = data.experiments.find(({experiment}) => experiment === host.dataset.runs);
    new RunTable(host, known.runs);
  }
}

function addComparison() {
  const section = document.getElementById("compare");
  if (data.experiments.every(({runs}) => runs.every((run) => !run.cycle))) return;
  section.hidden = false;
  whenNear(section, 300, () =>
    new Comparison(section.querySelector(".comparison"), data.experiments, data.packings));
}

function addDownloads() {
  for (const button of document.querySelectorAll("[data-csv]")) {
    button.hidden = false;
    button.addEventListener("click", () => {
      const name = button.dataset.csv;
      saveText(`${name}.csv`, document.getElementById(`csv-${name}`).textContent, "text/csv");
    });
  }
}

// A link to a closed <details> opens it.
function openTarget() {
  const target = location.hash.length > 1 && document.getElementById(location.hash.slice(1));
  if (target instanceof HTMLDetailsElement) target.open = true;
}

const theme = document.getElementById("theme");
theme.parentElement.hidden = false;
addThemeSwitch(theme);
addPlots();
addRunTables();
addComparison();
addViewer();
addDownloads();
window.addEventListener("hashchange", openTarget);
openTarget();
