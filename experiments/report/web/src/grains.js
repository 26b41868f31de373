// SPDX-License-Identifier: GPL-3.0-or-later
// Decodes the frames of experiments/report/packings.cpp and chooses the colours of grains. The colours of structures are
// by Okabe and Ito; readers with any colour vision can distinguish them. Quantities have the colours of viridis.
import {italic, plain, sub} from "./dom.js";

const rgb = (hex) => [16, 8, 0].map((shift) => (hex >> shift) & 255);
const classColours = [0xc9cdd3, 0x0072b2, 0xe69f00, 0x009e73].map(rgb);  // none, FCC, HCP, BCC
const crystalliteColours =
  [0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9, 0xa6761d, 0x7570b3].map(rgb);
const small = rgb(0x8f98a3);  // crystallites beyond the palette
const viridisStops =
  [0x440154, 0x46327e, 0x365c8d, 0x277f8e, 0x1fa187, 0x4ac16d, 0xa0da39, 0xfde725].map(rgb);
const labels = {phi_local: [...italic("ϕ"), ...sub("local")], q6: [...italic("q"), ...sub("6")]};

// Lengths in grain diameters d. `position` has x, y, z of the grains and then of the wall grains. `numbers` of a field
// are described in packings.hpp.
export function decodeFrame(frame, grains, wallGrains) {
  const bytes = Uint8Array.from(atob(frame.data), (c) => c.charCodeAt(0));
  const all = grains + wallGrains;
  let read = 0;
  const next = (count, wide) => {
    const part = bytes.slice(read, read += wide ? 2 * count : count);
    return wide ? new Uint16Array(part.buffer) : part;  // all browsers are little-endian
  };
  const words = next(3 * all, true);
  const position = Float32Array.from({length: 3 * all}, (_, n) =>
    frame.origin[n % 3] + frame.step[n % 3] * words[(n % 3) * all + Math.floor(n / 3)]);
  const fields = Object.fromEntries(frame.fields.map((field) =>
    [field.key, {...field, numbers: next(grains, field.exact_to > 0)}]));
  if (read !== bytes.length) {
    throw new Error(`a packing of ${bytes.length} bytes does not have the size for ${all} spheres`);
  }
  const {structure, crystallite} = fields;
  const interior = structure.numbers.map((flag) => flag >> 2);
  structure.numbers = structure.numbers.map((flag) => flag & 3);
  return {fields, position, interior, structure: structure.numbers, crystallite: crystallite.numbers};  // 0: in none
}

// The value of a grain, if the field has 16 bits; else the place of the value between the ends of the colours.
export function valueOf({exact_to: exact, numbers}, i) {
  const most = exact ? 65534 : 254;
  return numbers[i] > most ? null : numbers[i] / most * (exact || 1);
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
  const field = grains.fields[mode];
  const {label, unit, low, high, classes, numbers} = field;
  if (classes) return ofClasses(numbers, classes);
  const end = (value) => `${Number(value.toPrecision(3))}`;
  const place = (value) => field.exact_to && value !== null ? (value - low) / (high - low) : value;
  const look = ofQuantity(labels[mode] ?? plain(label), (i) => place(valueOf(field, i)), end(low),
    `${end(high)} ${unit}`.trim());
  if (numbers.some((_, i) => valueOf(field, i) !== null)) return look;
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
