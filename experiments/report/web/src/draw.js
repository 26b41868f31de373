// SPDX-License-Identifier: GPL-3.0-or-later
// Draws a chart into an SVG element: frame with mirrored ticks, error bars, lines, symbols.
import {
  area, line, symbol, symbolCircle, symbolDiamond, symbolSquare, symbolTriangle
} from "d3-shape";
import {svg} from "./dom.js";
import {ticksOf} from "./scales.js";
import {axisLabel, writeText} from "./text.js";

// gnuplot's point types: even ones are open.
const shapes = {
  2: symbolSquare, 3: symbolCircle, 4: symbolTriangle, 5: symbolTriangle, 6: symbolDiamond
};

// Makes dark colours visible on a dark page.
function onDark(colour) {
  const channels = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
  const light = (0.3 * channels[0] + 0.59 * channels[1] + 0.11 * channels[2]) / 255;
  const mix = Math.max(0, 0.62 - light) * 1.15;
  return `rgb(${channels.map((c) => Math.round(c + (235 - c) * mix)).join(" ")})`;
}

export function dress(element, colour) {
  const known = /^#[0-9a-f]{6}$/i.test(colour) ? colour : "#888888";
  element.classList.add("series");
  element.style.setProperty("--on-light", known);
  element.style.setProperty("--on-dark", onDark(known));
}

export function lineClass(one) {
  return ["line", one.dashed && "dashed", one.thin && "thin"].filter(Boolean).join(" ");
}

// One symbol of the plot or of the legend.
export function drawSymbol(parent, point, x, y) {
  if (point === 0) return;
  const kind = Math.floor(point / 2);
  svg("path", {
    class: point % 2 === 0 ? "symbol open" : "symbol",
    d: symbol(shapes[kind] ?? symbolCircle, 34)(),
    transform: `translate(${x} ${y})${kind === 5 ? " rotate(180)" : ""}`
  }, parent);
}

export function drawFrame(root, chart, scales, box) {
  const frame = svg("g", {class: "axes"}, root);
  const {left, right, top, bottom} = box;
  const x = ticksOf(scales.x, chart.x.log, Math.max(3, Math.round((right - left) / 85)), chart.x.whole);
  const y = ticksOf(scales.y, chart.y.log, Math.max(3, Math.round((bottom - top) / 55)));
  const tick = (length) => (at) => {
    const p = scales.x(at);
    svg("path", {d: `M${p} ${bottom}v${-length}M${p} ${top}v${length}`}, frame);
  };
  const rung = (length) => (at) => {
    const p = scales.y(at);
    svg("path", {d: `M${left} ${p}h${length}M${right} ${p}h${-length}`}, frame);
  };
  x.minor.forEach(tick(3));
  y.minor.forEach(rung(3));
  for (const {at, text} of x.major) {
    tick(6)(at);
    writeText(
      svg("text", {x: scales.x(at), y: bottom + 18, "text-anchor": "middle"}, frame), text);
  }
  for (const {at, text} of y.major) {
    rung(6)(at);
    writeText(
      svg("text", {x: left - 7, y: scales.y(at) + 4, "text-anchor": "end"}, frame), text);
  }
  svg("rect", {x: left, y: top, width: right - left, height: bottom - top, fill: "none"}, frame);
  const middle = (attributes, text) =>
    writeText(svg("text", {"text-anchor": "middle", ...attributes}, root), text);
  middle({class: "label", x: (left + right) / 2, y: bottom + 40}, axisLabel(chart.x));
  middle({class: "label", transform: `translate(15 ${(top + bottom) / 2}) rotate(-90)`},
    axisLabel(chart.y));
  middle({class: "title", x: root.viewBox.baseVal.width / 2, y: top - 9}, chart.title);
}

export function drawReferenceLines(root, chart, scales, box) {
  for (const {at, vertical, stub, colour} of chart.lines) {
    const d = vertical
      ? `M${scales.x(at)} ${box.bottom}V${stub ? box.bottom - 0.06 * (box.bottom - box.top) : box.top}`
      : `M${box.left} ${scales.y(at)}H${box.right}`;
    dress(svg("path", {class: stub ? "reference stub" : "reference", d}, root), colour);
  }
}

function errorBars(points, scales) {
  let path = "";
  for (const [x, y, xError, yError] of points) {
    const [px, py] = [scales.x(x), scales.y(y)];
    if (yError) {
      const [low, high] = [scales.y(y - yError), scales.y(y + yError)];
      if (Number.isFinite(low + high)) path += `M${px - 3} ${low}h6m-3 0V${high}m-3 0h6`;
    }
    if (xError) {
      const [low, high] = [scales.x(x - xError), scales.x(x + xError)];
      if (Number.isFinite(low + high)) path += `M${low} ${py - 3}v6m0 -3H${high}m0 -3v6`;
    }
  }
  return path;
}

// So that the symbols and bars of a long curve stay apart; the line has all points.
const apart = 7;  // pixels

function marked(points, scales, joined) {
  if (!joined || points.length < 2) return points;
  const wide = Math.abs(scales.x(points.at(-1)[0]) - scales.x(points[0][0]));
  const fit = Math.max(2, wide / apart);
  const every = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].find((n) => points.length / n <= fit) ?? 1000;
  return points.filter((_, index) => index % every === 0);
}

export function drawSeries(root, one, scales) {
  const group = svg("g", {}, root);
  dress(group, one.colour);
  const drawn = one.points.filter(([x, y]) => Number.isFinite(scales.x(x) + scales.y(y)));
  const marks = marked(drawn, scales, one.line);
  const bars = one.band ? "" : errorBars(marks, scales);
  if (one.band && drawn.length > 1) {
    const shape = area((p) => scales.x(p[0]), (p) => scales.y(p[1] - (p[3] ?? 0)),
      (p) => scales.y(p[1] + (p[3] ?? 0)));
    svg("path", {class: "band", d: shape(drawn)}, group);
  }
  if (bars) svg("path", {class: "bars", d: bars}, group);
  if (one.line && drawn.length > 1) {
    const path = line((p) => scales.x(p[0]), (p) => scales.y(p[1]));
    svg("path", {class: lineClass(one), d: path(drawn)}, group);
  }
  for (const [x, y] of marks) drawSymbol(group, one.point, scales.x(x), scales.y(y));
}
