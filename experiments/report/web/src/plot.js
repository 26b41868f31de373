// SPDX-License-Identifier: GPL-3.0-or-later
// One interactive plot: keeps which series and which part of the axes are visible, and redraws when
// either changes.
import {button, element, svg} from "./dom.js";
import {drawFrame, drawReferenceLines, drawSeries, drawSymbol, dress, lineClass} from "./draw.js";
import {addGestures} from "./gestures.js";
import {addReadout} from "./readout.js";
import {saveSvg} from "./save.js";
import {extentOf, makeScale} from "./scales.js";
import {plainText, writeText} from "./text.js";

const margin = {left: 66, right: 24, top: 12, bottom: 52};
let plots = 0;

export class Plot {
  constructor(host, chart, name) {
    this.host = host;
    this.chart = chart;
    this.name = name;
    this.hidden = new Set();  // indices of series
    this.view = null;         // {x: [low, high], y: [low, high]}, or all of it
    this.clipId = `plot-area-${++plots}`;
    host.replaceChildren();
    this.addToolbar();
    this.canvas = svg("svg",
      {class: "canvas", tabindex: 0, role: "img", "aria-label": this.description()}, host);
    this.addLegend();
    this.readout = addReadout(this);
    addGestures(this);
    new ResizeObserver(() => this.resize()).observe(host);
    this.resize();
  }

  visibleSeries() {
    return this.chart.series.filter((_, index) => !this.hidden.has(index));
  }

  description() {
    const {x, y, series} = this.chart;
    const names = series.map((one) => plainText(one.title)).filter(Boolean).join("; ");
    return `${this.name}: ${plainText(y.label)} against ${plainText(x.label)}. Series: ` +
      `${names || "none"}. Arrow keys read values, plus and minus zoom, 0 shows all.`;
  }

  resize() {
    const width = Math.round(this.host.clientWidth);
    if (width < 50 || width === this.width) return;
    this.width = width;
    this.height = Math.round(Math.min(430, Math.max(260, width * 0.7)));
    this.redraw();
  }

  redraw() {
    const {width, height} = this;
    const box = {
      left: margin.left, right: width - margin.right,
      top: margin.top + (this.chart.title.length > 0 ? 16 : 0), bottom: height - margin.bottom
    };
    const visible = this.visibleSeries();
    const domain = this.view ?? {
      x: extentOf(this.chart, visible, "x"), y: extentOf(this.chart, visible, "y")
    };
    this.box = box;
    this.scales = {
      x: makeScale(this.chart.x.log, domain.x, [box.left, box.right]),
      y: makeScale(this.chart.y.log, domain.y, [box.bottom, box.top])
    };
    const root = this.canvas;
    root.replaceChildren();
    root.setAttribute("viewBox", `0 0 ${width} ${height}`);
    root.setAttribute("width", width);
    root.setAttribute("height", height);
    const clip = svg("clipPath", {id: this.clipId}, root);
    svg("rect", {
      x: box.left, y: box.top, width: box.right - box.left, height: box.bottom - box.top
    }, clip);
    const area = svg("g", {"clip-path": `url(#${this.clipId})`}, root);
    drawReferenceLines(area, this.chart, this.scales, box);
    for (const one of visible) drawSeries(area, one, this.scales);
    drawFrame(root, this.chart, this.scales, box);
    if (visible.every((one) => one.points.length === 0)) {
      const note = svg("text", {
        class: "nothing", "text-anchor": "middle", x: (box.left + box.right) / 2,
        y: (box.top + box.bottom) / 2
      }, root);
      note.textContent = this.hidden.size > 0 ? "all curves are hidden" : "no data yet";
    }
    this.overlay = svg("g", {class: "overlay"}, root);
    this.readout?.moved();
  }

  // Shows this part of the axes, or everything.
  show(view) {
    this.view = view;
    this.redraw();
  }

  // Around a point in pixels; a factor below 1 zooms in.
  zoom(factor, px, py) {
    const {box, chart, scales} = this;
    px ??= (box.left + box.right) / 2;
    py ??= (box.top + box.bottom) / 2;
    const around = (scale, p, log) => scale.range().map((end) => {
      const at = scale.invert(p + (end - p) * factor);
      return log ? Math.max(at, Number.MIN_VALUE) : at;
    });
    const view = {x: around(scales.x, px, chart.x.log), y: around(scales.y, py, chart.y.log)};
    const tooClose = [view.x, view.y].some(([low, high]) =>
      !(high - low > 1e-12 * Math.max(Math.abs(low), Math.abs(high))));
    if (!tooClose) this.show(view);
  }

  addToolbar() {
    const bar = element("div", {className: "toolbar"});
    const add = (text, title, action) =>
      bar.append(button({title, "aria-label": `${title} (${this.name})`}, action, text));
    add("+", "Zoom in", () => this.zoom(0.6));
    add("−", "Zoom out", () => this.zoom(1 / 0.6));
    add("all", "Show everything", () => this.show(null));
    add("SVG", "Save as SVG", () => saveSvg(this));
    this.host.append(bar);
  }

  addLegend() {
    const legend = element("div", {className: "legend"});
    for (const group of entries(this.chart.series)) {
      const one = this.chart.series[group[0]];
      const empty = group.every((index) => this.chart.series[index].points.length === 0);
      const key = svg("svg", {class: "key", width: 26, height: 14, "aria-hidden": "true"});
      dress(key, one.colour);
      if (one.line) svg("path", {class: lineClass(one), d: "M0 7H26"}, key);
      drawSymbol(key, one.point, 13, 7);
      const entry = button({
        "aria-pressed": "true", title: "Show or hide this curve", className: empty ? "without-data" : ""
      }, () => {
        const shows = this.hidden.has(group[0]);
        for (const index of group) this.hidden[shows ? "delete" : "add"](index);
        entry.setAttribute("aria-pressed", String(shows));
        this.redraw();
      }, key, writeText(element("span"), one.title));
      legend.append(entry);
    }
    this.host.append(legend);
  }
}

// The series of each entry, that with the title first. One without a title belongs to the last
// entry before it that has its colour, or else to the first one after it.
export function entries(series) {
  const titled = [...series.keys()].filter((index) => series[index].title.length > 0);
  const groups = new Map(titled.map((index) => [index, [index]]));
  series.forEach((one, index) => {
    if (one.title.length > 0) return;
    const same = titled.filter((other) => series[other].colour === one.colour);
    const owner = same.filter((other) => other < index).at(-1) ?? same[0];
    groups.get(owner)?.push(index);
  });
  return [...groups.values()];
}

// Appends a plot for each of {name, chart}.
export function addPlots(parent, charts) {
  for (const {name, chart} of charts) {
    const host = element("div", {className: "plot"});
    parent.append(host);
    new Plot(host, chart, name);
  }
}
