// SPDX-License-Identifier: GPL-3.0-or-later
// Decodes what experiments/report/packings.cpp packed: 16-bit positions and measures of each grain,
// little-endian, one array after the other.

export const structureNames = ["disordered", "FCC", "HCP"];

// Lengths in grain diameters d. `position` has x, y, z of the grains and then of the wall grains.
export function decodeFrame(frame, grains, wallGrains) {
  const bytes = Uint8Array.from(atob(frame.data), (c) => c.charCodeAt(0));
  const all = grains + wallGrains;
  if (bytes.length !== 6 * all + (7 + frame.fields.length) * grains) {
    throw new Error(`a packing of ${bytes.length} bytes is not one of ${all} spheres`);
  }
  const view = new DataView(bytes.buffer);
  let at = 0;
  const words = (count, convert) => {
    const values = new Float32Array(count);
    for (let i = 0; i < count; ++i, at += 2) values[i] = convert(view.getUint16(at, true));
    return values;
  };
  const position = new Float32Array(3 * all);
  for (let axis = 0; axis < 3; ++axis) {
    for (let i = 0; i < all; ++i, at += 2) {
      position[3 * i + axis] =
        frame.origin[axis] + frame.step[axis] * view.getUint16(at, true);
    }
  }
  const phiLocal = words(grains, (word) => word / 65535);
  const q6 = words(grains, (word) => word / 65535);
  const crystallite = words(grains, (word) => word);  // 0 for none
  const flags = bytes.subarray(at, at + grains);
  // A byte a grain: a class, or 254 times its share of the range; 255 for unknown.
  const fields = Object.fromEntries(frame.fields.map((field, k) => {
    const from = at + (k + 1) * grains;
    return [field.key, {...field, bytes: bytes.subarray(from, from + grains)}];
  }));
  return {
    fields,
    position, phiLocal, q6, crystallite,
    structure: flags.map((flag) => flag & 3),
    interior: flags.map((flag) => flag >> 2)
  };
}

// Size of each crystallite by its number, and its rank: 0 for the largest.
export function crystalliteSizes(crystallite) {
  const size = new Map();
  for (const label of crystallite) if (label > 0) size.set(label, (size.get(label) ?? 0) + 1);
  const rank = new Map([...size.keys()]
    .sort((a, b) => size.get(b) - size.get(a) || a - b).map((label, place) => [label, place]));
  return {size, rank};
}
