// SPDX-License-Identifier: GPL-3.0-or-later
// Two variants side by side: every seed over the cycles on common axes, and a packing of each.
import {mean} from "d3-array";
import {addOptions, element, whenNear} from "./dom.js";
import {addPlots} from "./plot.js";
import {chartsOfVariant, commonRange} from "./traces.js";
import {Viewer} from "./viewer.js";

// Runs that differ in their seed alone.
function variantsOf(experiments) {
  const variants = new Map();
  for (const {experiment, runs} of experiments) {
    const scales = new Set(runs.map((run) => run.scale));
    for (const run of runs) {
      const name = scales.size > 1 ? `${run.variant} (${run.scale || "base"})` : run.variant;
      const key = JSON.stringify([experiment, run.scale, run.variant]);
      if (!variants.has(key)) variants.set(key, {experiment, name, runs: []});
      variants.get(key).runs.push(run);
    }
  }
  return [...variants.values()].filter(({runs}) => runs.some((run) => run.cycle));
}

function factsOf({runs}) {
  const last = (key) => runs.map((run) => run[key]?.at(-1)).filter((value) => value != null);
  const text = [`${runs.length} ${runs.length === 1 ? "run" : "runs"}`];
  if (last("phi").length > 0) {
    text.push(`mean of the last ϕ ${mean(last("phi")).toFixed(4)}`,
      `mean of the last percentage ${mean(last("percent")).toFixed(1)} %`);
  }
  return text.join(", ");
}

export class Comparison {
  constructor(host, experiments, packings) {
    this.variants = variantsOf(experiments);
    this.packings = packings;
    const sides = element("div", {className: "sides"});
    this.sides = ["Left", "Right"].map((label, k) => this.addSide(sides, label, k));
    this.note = element("p", {className: "small"});
    this.view = element("div");
    host.append(sides, this.note, this.view);
    this.viewer = null;
    if (packings.length > 0) {
      whenNear(this.view, 200, () => {
        this.viewer = new Viewer(this.view, packings, 2);
        this.showPackings();
      });
    }
    this.show();
  }

  addSide(parent, label, k) {
    const select = element("select");
    addOptions(select, this.variants, ({experiment}) => experiment, ({name}) => name);
    select.value = String(Math.min(k, this.variants.length - 1));
    select.addEventListener("change", () => this.show());
    const facts = element("p", {className: "small"});
    const panels = element("div");
    const choice = element("label", {}, `${label} `, select);
    parent.append(element("div", {className: "side"}, choice, facts, panels));
    return {select, facts, panels};
  }

  chosen() {
    return this.sides.map(({select}) => this.variants[Number(select.value)]);
  }

  show() {
    const chosen = this.chosen();
    const range = commonRange(chosen.flatMap(({runs}) => runs));
    this.sides.forEach(({facts, panels}, k) => {
      facts.textContent = `${chosen[k].experiment}, ${chosen[k].name}: ${factsOf(chosen[k])}`;
      panels.replaceChildren();
      addPlots(panels, chartsOfVariant(chosen[k].runs, chosen[k].name, range));
    });
    this.showPackings();
  }

  showPackings() {
    const found = this.chosen().map(({runs}) =>
      this.packings.find((packing) => runs.some((run) => run.id === packing.id)));
    const without = this.chosen().filter((_, k) => !found[k]).map(({name}) => name);
    this.note.textContent = without.length > 0
      ? `No packing of ${without.join(", ")} is in this file; --runs-per-experiment and ` +
        "--packings-mb of shearcell report add more." : "";
    this.view.hidden = found.every((packing) => !packing);
    this.viewer?.showRuns(found);
  }
}
