// SPDX-License-Identifier: GPL-3.0-or-later
// A measure of layers against their height, drawn over the right side of a packing.
import {extent} from "d3-array";

const names = {
  phi: ["volume fraction", ""], pressure: ["pressure", " kPa"],
  coordination: ["contacts per grain", ""], crystalline: ["crystalline", " %"]
};
const [width, height, margin] = [120, 260, 26];

// The same range for all packings of a run, so that they can be compared.
function rangeOf(frames, key) {
  const [low, high] = extent(frames.flatMap((frame) => frame.profiles[key]));
  return high > low ? [low, high] : [low - 1, low + 1];
}

export function drawProfile(svg, frames, frame, key) {
  svg.toggleAttribute("hidden", !(key in names));
  if (!(key in names)) return;
  const [name, unit] = names[key];
  const [low, high] = rangeOf(frames, key);
  const top = frame.profiles.height.length;
  const points = frame.profiles[key].flatMap((value, layer) => value === null ? [] : [[
    margin + (width - 2 * margin) * (value - low) / (high - low),
    height - margin - (height - 2 * margin) * frame.profiles.height[layer] / top
  ]]);
  const end = (value) => `${Number(value.toPrecision(3))}`;
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  svg.setAttribute("aria-label", `${name} against height, ${end(low)} to ${end(high)}${unit}`);
  svg.innerHTML = `<rect x="${margin}" y="${margin}" width="${width - 2 * margin}" height="${height - 2 * margin}"/>
<polyline points="${points.map((point) => point.map((c) => c.toFixed(1)).join()).join(" ")}"/>
<text x="${margin}" y="${height - 12}">${end(low)}</text>
<text x="${width - margin}" y="${height - 12}" text-anchor="end">${end(high)}${unit}</text>
<text x="${width / 2}" y="${margin - 8}" text-anchor="middle">${name}</text>
<text x="${margin - 4}" y="${height - margin}" text-anchor="end">0</text>
<text x="${margin - 4}" y="${margin + 8}" text-anchor="end">${top} d</text>`;
}
