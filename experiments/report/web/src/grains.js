// SPDX-License-Identifier: GPL-3.0-or-later
// Decodes the frames of experiments/report/packings.cpp and chooses the colours of grains. The colours of structures are
// by Okabe and Ito; readers with any colour vision can distinguish them. Quantities have the colours of viridis.
import {italic, plain, sub} from "./dom.js";

export const structureNames = ["disordered", "FCC", "HCP"];
const rgb = (hex) => [16, 8, 0].map((shift) => (hex >> shift) & 255);
const classColours = [0xc9cdd3, 0x0072b2, 0xe69f00, 0x009e73].map(rgb);  // none, FCC, HCP, BCC
const crystalliteColours =
  [0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9, 0xa6761d, 0x7570b3].map(rgb);
const small = rgb(0x8f98a3);  // crystallites beyond the palette
const viridisStops =
  [0x440154, 0x46327e, 0x365c8d, 0x277f8e, 0x1fa187, 0x4ac16d, 0xa0da39, 0xfde725].map(rgb);
const unknown = 255;

const labels = {phi: [...italic("ϕ"), ...sub("local")], q6: [...italic("q"), ...sub("6")]};

// Lengths in grain diameters d. `position` has x, y, z of the grains and then of the wall grains.
export function decodeFrame(frame, grains, wallGrains) {
  const bytes = Uint8Array.from(atob(frame.data), (c) => c.charCodeAt(0));
  const all = grains + wallGrains;
  if (bytes.length !== 6 * all + (7 + frame.fields.length) * grains) {
    throw new Error(`a packing of ${bytes.length} bytes does not have the size for ${all} spheres`);
  }
  const words = new Uint16Array(bytes.buffer, 0, 3 * all + 3 * grains);  // all browsers are little-endian
  const position = Float32Array.from({length: 3 * all}, (_, n) =>
    frame.origin[n % 3] + frame.step[n % 3] * words[(n % 3) * all + Math.floor(n / 3)]);
  const measure = (k) => words.subarray(3 * all + k * grains, 3 * all + (k + 1) * grains);
  const [phi, q6] = [0, 1].map((k) => Float32Array.from(measure(k), (word) => word / 65535));
  const crystallite = measure(2);  // 0: the grain is in no crystallite
  const part = (k) => bytes.subarray(6 * all + (6 + k) * grains, 6 * all + (7 + k) * grains);
  // A field has one byte for each grain: a class, or 254 (value - low) / (high - low), or 255 if the value is unknown.
  const fields = Object.fromEntries(frame.fields.map((field, k) => [field.key, {...field, bytes: part(k + 1)}]));
  const flags = part(0);
  return {
    fields, position, phi, q6, crystallite, structure: flags.map((flag) => flag & 3),
    interior: flags.map((flag) => flag >> 2)
  };
}

// The number of grains in each crystallite, the largest first.
export function crystalliteSizes(crystallite) {
  const size = new Map();
  for (const label of crystallite) if (label > 0) size.set(label, (size.get(label) ?? 0) + 1);
  return new Map([...size].sort(([a, m], [b, n]) => n - m || a - b));
}

export function viridis(fraction) {
  const place = Math.min(1, Math.max(0, fraction)) * (viridisStops.length - 1);
  const below = Math.min(viridisStops.length - 2, Math.floor(place));
  const [from, to] = [viridisStops[below], viridisStops[below + 1]];
  return from.map((c, k) => Math.round(c + (to[k] - c) * (place - below)));
}

// How this mode shows grains. `paint` gives the colour of a grain. The colour key is either `entries`, a list of
// {colour, text}, with a `note` that says which grains are counted, or a `bar` with {label, low, high}.
export function lookOf(grains, mode) {
  if (mode === "crystallite") return ofCrystallites(grains.crystallite);
  if (mode === "phi") return ofQuantity(labels.phi, (i) => (grains.phi[i] - 0.55) / 0.19, "0.55", "0.74");
  if (mode === "q6") return ofQuantity(labels.q6, (i) => (grains.q6[i] - 0.2) / 0.4, "0.2", "0.6");
  const field = grains.fields[mode];
  if (!field) return ofClasses(grains.structure, structureNames);
  if (field.classes) return ofClasses(field.bytes, field.classes);
  const end = (value) => `${Number(value.toPrecision(3))}`;
  const share = (i) => field.bytes[i] === unknown ? null : field.bytes[i] / 254;
  const look = ofQuantity(plain(field.label), share, end(field.low), `${end(field.high)} ${field.unit}`.trim());
  if (field.bytes.some((byte) => byte !== unknown)) return look;
  return {paint: look.paint, entries: [{colour: classColours[0], text: "unknown: no checkpoint one cycle earlier"}]};
}

const ofQuantity = (label, share, low, high) => ({
  paint: (i) => share(i) === null ? classColours[0] : viridis(share(i)), bar: {label, low, high}
});

function ofCrystallites(crystallite) {
  const sizes = crystalliteSizes(crystallite);
  const colour = new Map([...sizes.keys()].map((label, rank) => [label, crystalliteColours[rank] ?? small]));
  const entries = [...sizes].slice(0, 4).map(([label, count]) =>
    ({colour: colour.get(label), text: count === 1 ? "1 grain" : `${count} grains`}));
  entries.push({colour: classColours[0], text: entries.length > 0 ? "in none" : "no crystallite"});
  return {paint: (i) => colour.get(crystallite[i]) ?? classColours[0], entries, note: "of interior grains"};
}

// The colour key counts all grains, but the percentage crystalline counts only interior grains.
function ofClasses(values, names) {
  const counts = names.map(() => 0);
  for (const value of values) ++counts[value];
  const order = [...names.keys()].slice(1).concat(0);
  const entries = order.map((s) => ({colour: classColours[s], text: `${names[s]} ${counts[s]}`}));
  return {paint: (i) => classColours[values[i]], entries, note: `of all ${values.length} grains`};
}
