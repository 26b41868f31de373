// SPDX-License-Identifier: GPL-3.0-or-later
// Labels are lists of [text, style]; the style is "", or the HTML element "i", "sub" or "sup".

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

// Fills an SVG text element.
export function writeSvgText(element, label) {
  let risen = 0;
  for (const [text, style] of label) {
    const span = document.createElementNS("http://www.w3.org/2000/svg", "tspan");
    span.textContent = text;
    const wanted = shiftEm[style] ?? 0;
    const size = wanted === 0 ? 1 : 0.75;
    // dy is in the span's own em, and the next span starts from there.
    if (wanted !== risen) span.setAttribute("dy", `${(wanted - risen) / size}em`);
    risen = wanted;
    if (style === "i") span.setAttribute("font-style", "italic");
    if (size !== 1) span.setAttribute("font-size", "0.75em");
    element.append(span);
  }
}

// Appends to an HTML element.
export function writeHtmlText(element, label) {
  for (const [text, style] of label) {
    if (!["i", "sub", "sup"].includes(style)) {
      element.append(text);
      continue;
    }
    const inner = document.createElement(style);
    inner.textContent = text;
    element.append(inner);
  }
}
