// SPDX-License-Identifier: GPL-3.0-or-later
// Downloads: a plot as SVG without a stylesheet, a table as CSV, a view as PNG.
import {element, svg} from "./dom.js";
import {writeText} from "./text.js";

const written = [
  "fill", "fill-opacity", "stroke", "stroke-width", "stroke-dasharray", "stroke-linejoin",
  "font-family", "font-size", "font-style", "font-weight", "opacity"
];

export function saveBlob(name, blob) {
  const link = element("a", {href: URL.createObjectURL(blob), download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

export function saveText(name, text, type) {
  saveBlob(name, new Blob([text], {type}));
}

// The plot as shown, in the colours for paper, with its legend below.
function plotAsSvg(plot) {
  const copy = plot.canvas.cloneNode(true);
  copy.querySelector(".overlay")?.remove();
  const stage = element("div", {className: "stage", "data-theme": "light"}, copy);
  document.body.append(stage);
  const height = plot.height + addLegend(plot, copy);
  copy.setAttribute("height", height);
  copy.setAttribute("viewBox", `0 0 ${plot.width} ${height}`);
  for (const part of copy.querySelectorAll("path, text, tspan, rect:not(clipPath *)")) {
    const style = getComputedStyle(part);
    for (const name of written) {
      const value = style.getPropertyValue(name);
      if (value && value !== "normal") part.setAttribute(name, value);
    }
  }
  for (const part of [copy, ...copy.querySelectorAll("*")]) {
    for (const name of ["class", "style", "tabindex", "role", "aria-label"]) {
      part.removeAttribute(name);
    }
  }
  stage.remove();
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  return new XMLSerializer().serializeToString(copy) + "\n";
}

function addLegend(plot, copy) {
  const entries = [...plot.host.querySelectorAll(".legend button[aria-pressed=true]")];
  const series = plot.visibleSeries().filter((one) => one.title.length > 0);
  entries.forEach((entry, row) => {
    const group = entry.querySelector("svg").cloneNode(true);
    group.setAttribute("x", 66);
    group.setAttribute("y", plot.height + 4 + 18 * row);
    const text = svg("text", {x: 100, y: plot.height + 15 + 18 * row});
    copy.append(group, writeText(text, series[row].title));
  });
  return 18 * entries.length + 8;
}

export function saveSvg(plot) {
  saveText(`${plot.name}.svg`, plotAsSvg(plot), "image/svg+xml");
}
