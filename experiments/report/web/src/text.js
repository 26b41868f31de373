// SPDX-License-Identifier: GPL-3.0-or-later
// Labels are lists of [text, style]; the style is "", or the HTML element "i", "sub" or "sup".
import {element, svg} from "./dom.js";

export const plain = (text) => [[text, ""]];
export const italic = (text) => [[text, "i"]];
export const sub = (text) => [[text, "sub"]];
export const sup = (text) => [[text, "sup"]];

export function plainText(label) {
  return label.map(([text]) => text).join("").replace(/\s+/g, " ").trim();
}

// The label of an axis with its unit.
export function axisLabel({label, unit}) {
  return unit.length > 0 ? [...label, ["  [", ""], ...unit, ["]", ""]] : label;
}

const shiftEm = {sub: 0.25, sup: -0.38};

// Appends the label to an element of HTML or to a <text> of SVG, and returns that.
export function writeText(target, label) {
  if (target instanceof SVGElement) {
    writeSvgText(target, label);
    return target;
  }
  for (const [text, style] of label) {
    target.append(["i", "sub", "sup"].includes(style) ? element(style, {}, text) : text);
  }
  return target;
}

function writeSvgText(target, label) {
  let risen = 0;
  for (const [text, style] of label) {
    const span = svg("tspan", {}, target);
    span.textContent = text;
    const wanted = shiftEm[style] ?? 0;
    const size = wanted === 0 ? 1 : 0.75;
    // dy is in the span's own em, and the next span starts from there.
    if (wanted !== risen) span.setAttribute("dy", `${(wanted - risen) / size}em`);
    risen = wanted;
    if (style === "i") span.setAttribute("font-style", "italic");
    if (size !== 1) span.setAttribute("font-size", "0.75em");
  }
}
