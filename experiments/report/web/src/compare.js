// SPDX-License-Identifier: GPL-3.0-or-later
// Compares two variants: plots all seeds of both over the cycles, and shows a packing of each variant side by side.
import {chartsOfVariants} from "./charts.js";
import {addOptions, element, whenNear} from "./dom.js";
import {addPlots} from "./plot.js";
import {Viewer} from "./viewer.js";

// The variants of all experiments. Each variant has a colour, and runs that differ only in the seed.
function variantsOf(experiments, looks) {
  return experiments.flatMap(({experiment, runs: all}) => {
    const scales = new Set(all.map((run) => run.scale));
    const nameOf = ({variant, scale}) => scales.size > 1 ? `${variant} (${scale})` : variant;
    const variants = Map.groupBy(all.filter(({cycle}) => cycle), nameOf);
    return [...variants].map(([name, runs]) =>
      ({experiment, name, runs, colour: looks.get(experiment)(runs[0]).colour}));
  });
}

function factsOf({experiment, name, runs}) {
  const mean = (key, digits) => {
    const last = runs.map((run) => run[key].at(-1)).filter((value) => value !== null);
    if (last.length === 0) return "–";
    return (last.reduce((sum, value) => sum + value, 0) / last.length).toFixed(digits);
  };
  return `${experiment}, ${name}: ${runs.length} ${runs.length === 1 ? "run" : "runs"}; mean over the last checkpoints: ` +
    `ϕ = ${mean("phi", 4)} and ${mean("crystalline_percent", 1)} % of the interior grains crystalline`;
}

// `looks`: for each experiment, the function that gives the colour of a run's variant (variantLooks in charts.js).
export function addComparison(host, experiments, packings, looks) {
  const variants = variantsOf(experiments, looks);
  const panels = element("div", {className: "panels"});
  const [note, view] = [element("p", {className: "small"}), element("div")];
  let viewer = null;
  const sides = ["First", "Second"].map((label, k) => {
    const [select, facts] = [element("select"), element("p", {className: "small"})];
    addOptions(select, variants, ({experiment}) => experiment, ({name}) => name);
    select.value = String(Math.min(k, variants.length - 1));
    select.addEventListener("change", () => show());
    return {select, facts, part: element("div", {className: "side"}, element("label", {}, `${label} `, select), facts)};
  });
  host.append(element("div", {className: "sides"}, ...sides.map(({part}) => part)), panels, note, view);

  function show() {
    const chosen = sides.map(({select}) => variants[Number(select.value)]);
    const found = chosen.map(({runs}) => packings.find(({id}) => runs.some((run) => run.id === id)));
    sides.forEach(({facts}, k) => (facts.textContent = factsOf(chosen[k])));
    panels.replaceChildren();
    addPlots(panels, chartsOfVariants([...new Set(chosen)]));
    const without = chosen.filter((_, k) => !found[k]).map(({name}) => name);
    note.textContent = without.length === 0 ? "" : `This file has no packing of ${without.join(", ")}. ` +
      "To add packings, use the options --runs-per-experiment and --packings-mb of shearcell report.";
    view.hidden = found.every((packing) => !packing);
    viewer?.showRuns(found);
  }

  show();
  if (packings.length === 0) return;
  whenNear(view, () => {
    viewer = new Viewer(view, packings, 2);
    show();
  });
}
