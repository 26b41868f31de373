// SPDX-License-Identifier: GPL-3.0-or-later
// Shows the chart descriptions of analysis/chart.hpp with Plotly.
import Plotly from "plotly.js-basic-dist-min";
import {coloursOf, element, extentOf, plain, save} from "./dom.js";

const symbols = ["square", "circle", "triangle-up", "triangle-down", "diamond"];  // gnuplot's point types 4 to 13
const font = {family: '"Helvetica Neue", Helvetica, Arial, "Liberation Sans", sans-serif', size: 13};

// Plotly interprets a label as markup, so the text is escaped.
const markup = (label) => label.map(([text, style]) => {
  const safe = text.replaceAll("&", "&amp;").replaceAll("<", "&lt;");
  return style ? `<${style}>${safe}</${style}>` : safe;
}).join("");
const plainText = (label) => label.map(([text]) => text).join("").replace(/\s+/g, " ").trim();
const withUnit = ({label, unit}) => unit.length > 0 ? [...label, ["  [", ""], ...unit, ["]", ""]] : label;
const digits = (value) => String(Number(value.toPrecision(6))).replace("-", "−");

// Makes dark colours visible on a dark page.
function onDark(colour) {
  const channels = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
  const light = (0.3 * channels[0] + 0.59 * channels[1] + 0.11 * channels[2]) / 255;
  const mix = Math.max(0, 0.62 - light) * 1.15;
  return `rgb(${channels.map((c) => Math.round(c + (235 - c) * mix)).join()})`;
}

// The legend entry of one series may show and hide other series too. Returns the index of the series whose entry shows
// and hides series `index`. This is the series itself if it has a title. Otherwise it is the last titled series of the
// same colour before the series, or else the first one after it.
function ownerOf(series, index) {
  const fits = (one, at) => one.title.length > 0 && (at === index || one.colour === series[index].colour);
  const before = series.slice(0, index + 1).findLastIndex(fits);
  return before >= 0 ? before : series.findIndex(fits);
}

function valuesAt(chart, one, [x, y, xError, yError]) {
  const line = ({label}, value, error) =>
    `${markup(label)} = ${digits(value)}${error ? ` ± ${digits(error)}` : ""}`;
  return `<b>${markup(one.name ?? one.title)}</b><br>` +
    `${line(chart.x, x - one.shift, xError)}<br>${line(chart.y, y, yError)}`;
}

// Long entries of the legend are broken into lines at spaces, to fit the width of the plot.
const lettersIn = (width) => Math.max(12, Math.floor((width - 60) / 7.4));
const broken = (label, letters) => plainText(label).length <= letters ? markup(label)
  : markup(label).replace(new RegExp(`((?:<[^>]*>|[^<]){12,${letters}}) `, "g"), "$1<br>");

function tracesOf(chart, width, dark) {
  return chart.series.flatMap((one, index) => {
    const color = dark ? onDark(one.colour) : one.colour;
    // The legend of Plotly leaves out a series without points, so an empty series gets one null point.
    const points = one.points.length > 0 ? one.points : [[null, null, null, null]];
    const [x, y, xError, yError] = [0, 1, 2, 3].map((k) => points.map((point) => point[k]));
    const legendgroup = String(ownerOf(chart.series, index));
    const bars = (array, hidden) =>
      ({array, color, thickness: 1, width: 3, visible: !hidden && array.some((error) => error)});
    const modes = [one.line && "lines", one.point > 0 && "markers"].filter(Boolean);
    const shown = {
      type: "scatter", x, y, mode: modes.join("+") || "none", name: broken(one.title, lettersIn(width)), legendgroup,
      showlegend: one.title.length > 0, cliponaxis: one.line,
      line: {color, width: one.thin ? 0.7 : 1.4, dash: one.dashed ? "5px,4px" : "solid"},
      marker: {
        color, size: one.large ? 13 : 7, line: {color, width: 1.2}, maxdisplayed: one.line ? 60 : 0,
        symbol: (symbols[Math.floor(one.point / 2) - 2] ?? "circle") + (one.point % 2 ? "" : "-open")
      },
      error_x: bars(xError, one.band), error_y: bars(yError, one.band),
      text: one.points.map((point) => valuesAt(chart, one, point)), hoverinfo: "text"
    };
    if (!one.band) return [shown];
    const edge = (sign) => y.map((value, k) => value + sign * (yError[k] ?? 0));
    return [{
      type: "scatter", x: [...x, ...x.toReversed()], y: [...edge(1), ...edge(-1).toReversed()],
      mode: "none", fill: "toself", fillcolor: color, opacity: 0.2, legendgroup, showlegend: false,
      hoverinfo: "skip"
    }, shown];
  });
}

function axisOf(axis, values, color) {
  const {log, whole, low, high, clip} = axis;
  const [least, most] = extentOf(values);
  return {
    title: {text: markup(withUnit(axis)), standoff: 8}, type: log ? "log" : "linear", color,
    ...(clip && {range: log ? [Math.log10(low), Math.log10(high)] : [low, high]}),
    ...(!log && {autorangeoptions: {include: [low, high].filter(Number.isFinite)}}),
    rangemode: low === 0 && least >= 0 ? "tozero" : "normal",
    ...(whole && most - least < 9 && {tick0: 0, dtick: 1}),
    exponentformat: "power", minexponent: 4, nticks: 7, ticks: "inside", minor: {ticks: "inside", ticklen: 2},
    showline: true, mirror: "ticks", zeroline: false, showgrid: false, automargin: true
  };
}

function layoutOf(chart, width, color) {
  const [left, right] = [62, 14];
  const titles = chart.series.map(({title}) => plainText(title)).filter(Boolean);
  const letters = Math.max(0, ...titles.map((title) => title.length));
  const entry = 7.4 * Math.min(letters, lettersIn(width));
  // In Plotly the legend is as wide as the frame of the plot.
  const rows = Math.ceil(titles.length / Math.max(1, Math.floor((width - left - right) / (entry + 45))));
  const key = 20 * rows * Math.ceil(letters / lettersIn(width)) + 6;
  const points = chart.series.flatMap((one) => one.points);
  const flat = chart.lines.filter(({vertical}) => !vertical).map(({at}) => at);
  const shape = ({at, vertical, stub, colour}) => ({
    type: "line", layer: "below", line: {color: colour, width: stub ? 2 : 1, dash: stub ? "solid" : "dash"},
    ...(vertical ? {x0: at, x1: at, yref: "paper", y0: 0, y1: stub ? 0.06 : 1}
      : {y0: at, y1: at, xref: "paper", x0: 0, x1: 1})
  });
  const height = Math.round(Math.min(430, Math.max(310, width * 0.7))) + key;
  return {
    width, height, font: {...font, color}, modebar: {bgcolor: "rgba(0,0,0,0)", color: "#8a8f98", activecolor: color}, paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
    margin: {l: left, r: right, t: chart.title.length > 0 ? 52 : 30, b: 44 + key}, hovermode: "closest",
    title: {text: markup(chart.title), font: {size: 13}, y: 1, yref: "container", yanchor: "top", pad: {t: 8}},
    legend: {orientation: "h", xref: "container", yref: "container", y: 0, yanchor: "bottom", x: 0, entrywidth: entry,
      traceorder: "normal", tracegroupgap: 0, maxheight: 1},
    xaxis: axisOf(chart.x, points.map(([x]) => x), color),
    yaxis: axisOf(chart.y, [...points.map((point) => point[1]), ...flat], color),
    shapes: chart.lines.map(shape), uirevision: "kept",
    dragmode: window.matchMedia("(pointer: coarse)").matches ? false : "zoom",  // on a touch screen, a finger scrolls the page
    annotations: points.length > 0 && !chart.empty ? [] : [{
      text: broken(plain(chart.empty ?? "no data yet"), lettersIn(width - left - right)), xref: "paper", yref: "paper", x: 0.5, y: 0.5, showarrow: false
    }]
  };
}

export class Plot {
  constructor(host, chart, name) {
    this.name = name;
    this.canvas = element("div", {className: "canvas", tabIndex: 0, role: "group"});
    this.status = element("div", {className: "visually-hidden", role: "status"});
    host.replaceChildren(this.canvas, this.status);
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    window.addEventListener("themechange", () => this.draw());
    this.fits = () => Math.floor(host.getBoundingClientRect().width);
    new ResizeObserver(() => this.width === this.fits() || this.draw()).observe(host);
    this.show(chart);
  }

  show(chart) {
    this.chart = chart;
    this.at = null;  // the point that the arrow keys read: {curve, point}
    const names = chart.series.map(({title}) => plainText(title)).filter(Boolean).join("; ");
    this.canvas.setAttribute("aria-label", `${this.name}: ${plainText(chart.y.label)} against ` +
      `${plainText(chart.x.label)}. Series: ${names || "none"}. Arrow keys read values, plus and minus ` +
      "zoom, 0 shows all.");
    this.draw();
  }

  draw() {
    this.width = this.fits();
    if (this.width < 50) return;
    const {background, ink} = coloursOf(document.body);
    const saving = {
      name: "Save as SVG", title: "Save as SVG", icon: Plotly.Icons.camera, click: () => this.saveSvg()
    };
    Plotly.react(this.canvas, tracesOf(this.chart, this.width, background[0] < 128),
      layoutOf(this.chart, this.width, `rgb(${ink.join()})`), {
        displaylogo: false, displayModeBar: true, doubleClick: "reset",
        modeBarButtons: [["zoomIn2d", "zoomOut2d", "resetScale2d", saving]]
      }).then(() => this.nameEntries());
  }

  // Makes each legend entry a button that the keyboard can reach.
  nameEntries() {
    for (const entry of this.canvas.querySelectorAll(".legendtoggle")) {
      const name = entry.parentElement.querySelector(".legendtext").textContent;
      for (const [key, value] of Object.entries({tabindex: 0, role: "button", "aria-label": `Show or hide ${name}`})) {
        entry.setAttribute(key, value);
      }
    }
  }

  // Saves the plot as it is shown, but in the colours for paper.
  saveSvg() {
    const {data, layout} = this.canvas;
    const onPaper = layoutOf(this.chart, this.width, "#1a1a1a");
    for (const axis of ["xaxis", "yaxis"]) onPaper[axis].range = layout[axis].range;
    Plotly.toImage({
      data: tracesOf(this.chart, this.width, false).map((trace, k) => ({...trace, visible: data[k].visible})), layout: onPaper
    }, {format: "svg", width: onPaper.width, height: onPaper.height}).then((url) => {
      // On a logarithmic axis, Plotly writes powers of ten in a larger font than other labels.
      const text = decodeURIComponent(url.slice(url.indexOf(",") + 1));
      const even = text.replaceAll(`font-size: ${1.25 * font.size}px`, `font-size: ${font.size}px`);
      save(`${this.name}.svg`, new Blob([even], {type: "image/svg+xml"}));
    });
  }

  key(event) {
    if (event.key === "Enter" && event.target.matches(".legendtoggle")) {
      for (const type of ["mousedown", "mouseup"]) event.target.dispatchEvent(new MouseEvent(type, {bubbles: true}));
    }
    if (event.target !== this.canvas || event.ctrlKey || event.metaKey || event.altKey) return;
    const buttons = {"+": "in", "=": "in", "-": "out", "0": "reset", "Escape": "reset"};
    const moves = {
      ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1],
      Home: [-Infinity, 0], End: [Infinity, 0]
    };
    if (event.key in buttons) this.canvas.querySelector(`[data-val="${buttons[event.key]}"]`).click();
    else if (event.key in moves) this.step(...moves[event.key]);
    else return;
    event.preventDefault();
  }

  step(along, across) {
    const curves = this.canvas.data.flatMap(({hoverinfo, visible, text}, curve) =>
      hoverinfo === "text" && visible !== "legendonly" && text.length > 0 ? [curve] : []);
    if (curves.length === 0) return;
    const place = Math.max(0, curves.indexOf(this.at?.curve));
    const curve = curves[(place + across + curves.length) % curves.length];
    const {text} = this.canvas.data[curve];
    const point = this.at ? Math.min(text.length - 1, Math.max(0, this.at.point + along)) : 0;
    this.at = {curve, point};
    Plotly.Fx.hover(this.canvas, [{curveNumber: curve, pointNumber: point}]);
    this.status.textContent = element("p", {innerHTML: text[point].replaceAll("<br>", ", ")}).textContent;
  }
}

// Appends a plot for each chart. `charts`: a list of {name, chart}.
export function addPlots(parent, charts) {
  for (const {name, chart} of charts) {
    const host = element("div", {className: "plot"});
    parent.append(host);
    new Plot(host, chart, name);
  }
}
