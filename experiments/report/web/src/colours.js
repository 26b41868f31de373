// SPDX-License-Identifier: GPL-3.0-or-later
// Colours of grains: structures by the colour-blind safe palette of Okabe and Ito, quantities by
// viridis.
import {crystalliteSizes, structureNames} from "./frames.js";
import {italic, plain, sub} from "./text.js";

const rgb = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));

const classColours = ["#c9cdd3", "#0072b2", "#e69f00", "#009e73"];  // none, FCC, HCP, BCC
const crystalliteColours = [
  "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#a6761d", "#7570b3"
];
const plainColour = "#c9cdd3";
const small = "#8f98a3";  // crystallites beyond the palette
const wall = "#6b7480";

const viridisStops = ["#440154", "#46327e", "#365c8d", "#277f8e", "#1fa187", "#4ac16d", "#a0da39",
  "#fde725"].map(rgb);

export function viridis(fraction) {
  const place = Math.min(1, Math.max(0, fraction)) * (viridisStops.length - 1);
  const below = Math.min(viridisStops.length - 2, Math.floor(place));
  const t = place - below;
  return viridisStops[below].map((c, i) => Math.round(c + (viridisStops[below + 1][i] - c) * t));
}

const quantities = {
  phi: {label: [...italic("ϕ"), ...sub("local")], low: 0.55, high: 0.74, values: "phiLocal"},
  q6: {label: [...italic("q"), ...sub("6")], low: 0.2, high: 0.6, values: "q6"}
};

const fieldLabels = {
  pressure: plain("pressure"), contacts: plain("contacts"), overlap: plain("largest overlap"),
  displacement: plain("displacement in a cycle"),
  d2min: [...italic("D"), ...sub("min"), ...plain("², a cycle")]
};
const unknown = 255;

// How this mode shows grains: `paint` gives the colour of a grain. Its key is [{colour, text}] in
// `entries`, or a `bar` with {label, low, high}.
export function lookOf(grains, mode) {
  if (mode in quantities) {
    const {low, high, values} = quantities[mode];
    const paint = (i) => viridis((grains[values][i] - low) / (high - low));
    return {paint, bar: quantities[mode]};
  }
  if (mode === "crystallite") return ofCrystallites(grains.crystallite);
  const field = grains.fields[mode];
  if (!field) return ofClasses(grains.structure, structureNames);
  return field.classes ? ofClasses(field.bytes, field.classes) : ofField(field, fieldLabels[mode]);
}

function ofCrystallites(crystallite) {
  const {size, rank} = crystalliteSizes(crystallite);
  const palette = crystalliteColours.map(rgb);
  const [none, rest] = [rgb(plainColour), rgb(small)];
  const entries = [...rank].slice(0, 4).map(([label, place]) => ({
    colour: crystalliteColours[place], text: size.get(label) === 1 ? "1 grain" : `${size.get(label)} grains`
  }));
  entries.push({colour: plainColour, text: entries.length > 0 ? "in none" : "no crystallite"});
  const paint = (i) => {
    const label = crystallite[i];
    return label === 0 ? none : palette[rank.get(label)] ?? rest;
  };
  return {paint, entries};
}

function ofClasses(values, names) {
  const classes = classColours.map(rgb);
  const counts = names.map(() => 0);
  for (const value of values) ++counts[value];
  const order = [...names.keys()].slice(1).concat(0);
  const entries = order.map((s) => ({colour: classColours[s], text: `${names[s]} ${counts[s]}`}));
  return {paint: (i) => classes[values[i]], entries};
}

function ofField({bytes, unit, low, high}, label) {
  const none = rgb(plainColour);
  const paint = (i) => bytes[i] === unknown ? none : viridis(bytes[i] / 254);
  if (bytes.every((byte) => byte === unknown)) {
    return {paint, entries: [{colour: plainColour, text: "no checkpoint a cycle before"}]};
  }
  const end = (value) => `${Number(value.toPrecision(3))}`;
  return {paint, bar: {label, low: end(low), high: end(high) + (unit ? ` ${unit}` : "")}};
}

// Three bytes a sphere: `count` grains, then the wall grains.
export function coloursOf(paint, count, total) {
  const colours = new Uint8Array(3 * total);
  for (let i = 0; i < count; ++i) colours.set(paint(i), 3 * i);
  const of = rgb(wall);
  for (let i = count; i < total; ++i) colours.set(of, 3 * i);
  return colours;
}
