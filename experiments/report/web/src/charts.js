// SPDX-License-Identifier: GPL-3.0-or-later
// Charts of runs, in the form of analysis/chart.hpp. A run is {id, kind, scale, variant, seed, cycle: [...],
// phi: [...], ...}, with an array over the checkpoints for each measure (traces_of in experiments/report/page.cpp).
import {italic, plain} from "./dom.js";

const labels = {
  phi: {label: [...plain("volume fraction "), ...italic("ϕ")]},
  crystalline_percent: {label: plain("percentage crystalline"), unit: plain("%"), low: 0},
  cycle: {label: [...plain("shear cycle "), ...italic("n")], whole: true}
};
const colours = [
  "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#7a5195", "#6b4c2a"
];
const points = [7, 5, 9, 11, 13, 6, 4, 8, 10, 12];
const grey = {colour: "#8f98a3", point: 0, dashed: false};

// The k-th style of a colour. A colour has twenty styles: ten markers with a solid line, then ten with a dashed line.
const styleOf = (colour, k) => ({
  colour, point: points[k % points.length], dashed: Math.floor(k / points.length) % 2 === 1
});

// Reads the values of a curve: "walls=rough;pressure_Pa=954" becomes {walls: "rough", pressure_Pa: "954"}.
const valuesOf = (text) => Object.fromEntries(text.split(";").map((pair) => pair.trim().split("="))
  .filter(([key, value]) => key && value !== undefined));

// Returns a function that gives {colour, k} for a run. The colour is the colour of the run's variant in the figures of
// the experiment, so that a variant has one colour on the whole page. A variant without a curve gets a colour that no
// other variant has, if one is left. k is the number of earlier variants with the same colour.
export function variantLooks({columns, rows, runs}, charts) {
  const curves = charts.flatMap(({series}) => series).filter(({of}) => of)
    .map(({of, colour}) => ({values: Object.entries(valuesOf(of)), colour}))
    .filter(({values}) => values.length > 0).sort((a, b) => b.values.length - a.values.length);
  const valueOf = (row, key) => row[columns.findIndex((one) => one.key === key)] ?? null;
  const same = (value, text) => value !== null && (String(value) === text || (text !== "" && value === Number(text)));
  const stated = (k) => curves.find(({values}) => values.every(([key, text]) => same(valueOf(rows[k], key), text)))?.colour;
  const looks = new Map(runs.map((run, k) => [run.variant, {colour: stated(k), k: 0}]));
  const used = new Set([...looks.values()].map(({colour}) => colour));
  const free = colours.filter((colour) => !used.has(colour));
  [...looks.values()].filter(({colour}) => !colour)
    .forEach((look, k) => (look.colour = (free.length > 0 ? free : colours)[k % (free.length || colours.length)]));
  const count = new Map();
  for (const look of looks.values()) {
    look.k = count.get(look.colour) ?? 0;
    count.set(look.colour, look.k + 1);
  }
  return ({variant}) => looks.get(variant);
}

// The checkpoints of a stiffening have no cycles, so they are numbered.
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

// The run in the colour of its variant, and the other runs of the variant in grey behind it.
export const chartsOfRun = (run, others, colour) => overCycles(() => [
  ...others.map((one, k) => ({run: one, style: grey, title: k === 0 ? "other seeds" : ""})),
  {run, style: styleOf(colour, 0), title: `seed ${run.seed}`}
]);

// All seeds of one or two variants. Each variant has its colour, and each seed has its own marker. If both variants
// have the same colour, the second variant uses markers that the first variant does not use.
export const chartsOfVariants = (variants) => overCycles(() => variants.flatMap(({runs, colour}, v) => {
  const first = v > 0 && colour === variants[0].colour ? variants[0].runs.length : 0;
  return runs.map((run, k) =>
    ({run, style: styleOf(colour, first + k), title: `${["first", "second"][v]}, seed ${run.seed}`}));
}));

// One measure against another. If the runs have both measures at each checkpoint, each run is a curve; otherwise each
// run is one point, for the end of the run. `rows`: {run, value(key)}. Each variant has its colour. Variants with the
// same colour have different markers.
export function chartOfMeasures(rows, x, y, lookOf) {
  const line = rows.every(({run}) => !run.cycle || (run[x] && run[y]));
  const titled = new Set();
  return chartOf(x, y, rows.map(({run, value}) => {
    const {colour, k} = lookOf(run);
    const title = titled.has(run.variant) ? "" : run.variant;
    titled.add(run.variant);
    const points = line ? overCheckpoints(run, x, y) : [[value(x), value(y)]];
    return {run, line, title, style: styleOf(colour, k), points};
  }));
}
