// SPDX-License-Identifier: GPL-3.0-or-later
// Chart descriptions of runs: {id, kind, scale, variant, seed, cycle: [...], phi: [...], ...}, with an
// array over the checkpoints for each measure (traces_of in experiments/report/page.cpp).
import {italic, plain} from "./dom.js";

const labels = {
  phi: {label: [...plain("volume fraction "), ...italic("ϕ")]},
  crystalline_percent: {label: plain("percentage crystalline"), unit: plain("%"), low: 0},
  cycle: {label: [...plain("shear cycle "), ...italic("n")], whole: true}
};
const colours = [
  "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a5195", "#6b4c2a"
];
const points = [7, 5, 9, 11, 13, 6, 4, 8, 10, 12];
const grey = {colour: "#8f98a3", point: 0, dashed: false};

// Of one colour there are twenty styles: ten markers with a solid line, then with a dashed one.
const styleOf = (colour, point) => ({
  colour: colours[colour % colours.length], point: points[point % points.length],
  dashed: Math.floor(point / points.length) % 2 === 1
});

// The checkpoints of a stiffening are counted, and have no cycles.
const axisOf = (key, runs) => ({
  label: plain(key.replaceAll("_", " ")), unit: [], log: false, low: null, high: null, ...labels[key],
  ...(key === "cycle" && runs.every(({kind}) => kind === "stiffen") && {label: plain("state of the stiffening")})
});

// `list`: {run, points, style, title, line}.
const chartOf = (x, y, list) => ({
  x: axisOf(x, list.map(({run}) => run)), y: axisOf(y, list.map(({run}) => run)), title: [], lines: [],
  series: list.map((one) => ({
    title: plain(one.title).filter(([text]) => text), name: plain(`${one.run.variant}, seed ${one.run.seed}`),
    ...one.style, line: one.line, band: false, shift: 0,
    points: one.points.filter(([a, b]) => Number.isFinite(a) && Number.isFinite(b))
  }))
});

const overCheckpoints = (run, x, y) => (run[x] ?? []).map((value, k) => [value, run[y][k]]);

const overCycles = (listFor) => ["phi", "crystalline_percent"].map((key) => ({
  name: key, chart: chartOf("cycle", key,
    listFor().map((one) => ({...one, points: overCheckpoints(one.run, "cycle", key), line: true})))
}));

// One run, and behind it the others of its variant.
export const chartsOfRun = (run, others) => overCycles(() => [
  ...others.map((one, k) => ({run: one, style: grey, title: k === 0 ? "other seeds" : ""})),
  {run, style: styleOf(0, 0), title: `seed ${run.seed}`}
]);

// Every seed of one or two variants: a colour for each variant, a marker for each seed.
export const chartsOfVariants = (variants) => overCycles(() => variants.flatMap(({runs}, v) =>
  runs.map((run, k) => ({run, style: styleOf(v, k), title: `${["first", "second"][v]}, seed ${run.seed}`}))));

// One measure against another: over the checkpoints of each run where they have both, else at the ends
// of the runs. `rows`: {run, value(key)}. A colour for each variant, another marker from the ninth on.
export function chartOfMeasures(rows, x, y) {
  const line = rows.every(({run}) => !run.cycle || (run[x] && run[y]));
  const variants = [...Map.groupBy(rows, ({run}) => run.variant)];
  return chartOf(x, y, variants.flatMap(([variant, own], v) =>
    own.map(({run, value}, k) => ({
      run, line, title: k === 0 ? variant : "", style: styleOf(v, Math.floor(v / colours.length)),
      points: line ? overCheckpoints(run, x, y) : [[value(x), value(y)]]
    }))));
}
