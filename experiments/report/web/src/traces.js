// SPDX-License-Identifier: GPL-3.0-or-later
// Charts of runs over their cycles, as experiments/report/report_data.cpp gives them: {cycle, phi,
// percent, seed, variant, kind, ...}.
import {extent} from "d3-array";
import {italic, plain} from "./text.js";

const quantities = [
  {key: "phi", name: "phi", axis: {label: [...plain("volume fraction "), ...italic("ϕ")], unit: []}},
  {key: "percent", name: "crystalline",
    axis: {label: plain("percentage crystalline"), unit: plain("%"), low: 0}}
];

const colours = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];
const grey = "#8f98a3";

const pointsOf = (run, key) => (run.cycle ?? [])
  .map((cycle, index) => [cycle, run[key][index]])
  .filter(([, value]) => value !== null);

const seriesOf = (run, key, title, colour, point) => ({
  title, name: plain(`seed ${run.seed}`), colour, point, line: true, dashed: false, band: false,
  shift: 0, points: pointsOf(run, key)
});

// The checkpoints of a stiffening are counted, and have no cycles.
const abscissa = (run) => run.kind === "stiffen" ? plain("state of the stiffening")
  : [...plain("shear cycle "), ...italic("n")];

const chartOf = (quantity, label, series, range = {}) => ({
  x: {label, unit: [], log: false, whole: true, ...range.cycle},
  y: {unit: [], log: false, whole: false, ...quantity.axis, ...range[quantity.key]},
  title: [], series, lines: []
});

// A chart of each quantity: [{name, chart}].
const chartsOf = (name, label, seriesFor, range) => quantities.map((quantity) => ({
  name: `${quantity.name}-${name}`, chart: chartOf(quantity, label, seriesFor(quantity.key), range)
}));

// One run, and behind it the others of its variant.
export function chartsOfRun(run, others) {
  return chartsOf(run.id.slice(0, 8), abscissa(run), (key) => [
    ...others.map((one, index) => seriesOf(one, key, index === 0 ? plain("other seeds") : [], grey, 0)),
    seriesOf(run, key, plain(`seed ${run.seed}`), colours[0], 7)
  ]);
}

// All seeds of a variant, on axes that `range` holds together.
export function chartsOfVariant(runs, name, range) {
  return chartsOf(name, abscissa(runs[0]), (key) => runs.map((run, index) =>
    seriesOf(run, key, plain(`seed ${run.seed}`), colours[index % colours.length], 0)), range);
}

// The ends of the axes that show all of these runs, with a little room.
export function commonRange(runs) {
  const range = {};
  const add = (key, values) => {
    if (values.length === 0) return;
    const [low, high] = extent(values);
    const room = 0.04 * (high - low) || 0.05 * Math.abs(high) || 1;
    range[key] = {low: low - room, high: high + room};
  };
  add("cycle", runs.flatMap((run) => run.cycle ?? []));
  for (const {key} of quantities) {
    add(key, runs.flatMap((run) => pointsOf(run, key).map(([, value]) => value)));
  }
  if (range.percent) range.percent.low = 0;
  return range;
}
