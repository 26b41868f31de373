// SPDX-License-Identifier: GPL-3.0-or-later
// Adds plots, packings, comparisons and downloads to the page; everything else works without scripts.
import {Comparison} from "./compare.js";
import {Plot} from "./plot.js";
import {RunTable} from "./run_table.js";
import {saveText} from "./save.js";
import {addThemeSwitch} from "./theme.js";
import {Viewer} from "./viewer.js";

const data = JSON.parse(document.getElementById("report-data").textContent);

// A plot is drawn when it is scrolled near the window, or before printing.
function addPlots() {
  const waiting = new Map();
  for (const host of document.querySelectorAll("[data-chart]")) {
    const chart = data.charts[host.dataset.chart];
    if (chart) waiting.set(host, () => new Plot(host, chart, host.dataset.chart));
  }
  const draw = (host) => {
    const make = waiting.get(host);
    waiting.delete(host);
    if (make) make();
  };
  const watcher = new IntersectionObserver((entries) => {
    for (const {isIntersecting, target} of entries) {
      if (!isIntersecting) continue;
      watcher.unobserve(target);
      draw(target);
    }
  }, {rootMargin: "300px"});
  for (const host of waiting.keys()) watcher.observe(host);
  window.addEventListener("beforeprint", () => [...waiting.keys()].forEach(draw));
}

function addViewer() {
  const section = document.getElementById("packings");
  if (!section || data.packings.length === 0) return;
  section.hidden = false;
  let viewer = null;
  const open = () => (viewer ??= new Viewer(section.querySelector(".viewer"), data.packings));
  const watcher = new IntersectionObserver((entries) => {
    if (!entries.some((entry) => entry.isIntersecting)) return;
    watcher.disconnect();
    open();
  }, {rootMargin: "200px"});
  watcher.observe(section);
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
  const watcher = new IntersectionObserver((entries) => {
    if (!entries.some((entry) => entry.isIntersecting)) return;
    watcher.disconnect();
    new Comparison(section.querySelector(".comparison"), data.experiments, data.packings);
  }, {rootMargin: "300px"});
  watcher.observe(section);
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
