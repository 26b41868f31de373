// SPDX-License-Identifier: GPL-3.0-or-later
// Shows the values of the point under the pointer, or of the one selected by the arrow keys.
import {element, svg} from "./dom.js";
import {dress} from "./draw.js";
import {positionIn} from "./gestures.js";
import {formatOn} from "./scales.js";
import {writeText} from "./text.js";

const reach = 28;  // pixels

export function addReadout(plot) {
  const note = element("div", {className: "readout", role: "status", hidden: true});
  plot.host.append(note);
  let current = null;  // {one, index}

  const inside = ([x, y]) => x >= plot.box.left - 1 && x <= plot.box.right + 1 &&
    y >= plot.box.top - 1 && y <= plot.box.bottom + 1;
  const place = ({one, index}) => [
    plot.scales.x(one.points[index][0]), plot.scales.y(one.points[index][1])
  ];

  function nearest(px, py) {
    let best = null;
    let least = reach * reach;
    for (const one of plot.visibleSeries()) {
      for (let index = 0; index < one.points.length; ++index) {
        const at = place({one, index});
        const distance = (at[0] - px) ** 2 + (at[1] - py) ** 2;
        if (distance < least && inside(at)) {
          least = distance;
          best = {one, index};
        }
      }
    }
    return best;
  }

  function quantity(label, scale, value, error) {
    const line = writeText(element("div"), label);
    const spread = error ? ` ± ${formatOn(scale, error)}` : "";
    line.append(` = ${formatOn(scale, value)}${spread}`);
    return line;
  }

  function show(found) {
    current = found;
    plot.overlay.querySelector(".marker")?.remove();
    note.hidden = !found;
    if (!found) return;
    const at = place(found);
    const marker = svg("circle", {class: "marker", cx: at[0], cy: at[1], r: 7}, plot.overlay);
    dress(marker, found.one.colour);
    const title = writeText(element("strong"), found.one.name ?? found.one.title);
    const [x, y, xError, yError] = found.one.points[found.index];
    note.replaceChildren(title, quantity(plot.chart.x.label, plot.scales.x, x - found.one.shift, xError),
      quantity(plot.chart.y.label, plot.scales.y, y, yError));
    const bounds = plot.canvas.getBoundingClientRect();
    const host = plot.host.getBoundingClientRect();
    const left = bounds.left - host.left + at[0] * bounds.width / plot.width;
    const top = bounds.top - host.top + at[1] * bounds.height / plot.height;
    const toTheLeft = left + note.offsetWidth + 16 > host.width;
    note.style.left = `${Math.max(0, toTheLeft ? left - note.offsetWidth - 12 : left + 12)}px`;
    note.style.top = `${Math.max(0, top - note.offsetHeight - 8)}px`;
  }

  function step(along, across) {
    const series = plot.visibleSeries().filter((one) => one.points.length > 0);
    if (series.length === 0) return;
    if (!current) {
      show({one: series[0], index: 0});
      return;
    }
    const at = Math.max(0, series.indexOf(current.one));
    const one = series[(at + across + series.length) % series.length];
    const index = Math.min(one.points.length - 1, current.index + along);
    show({one, index: Math.max(0, index)});
  }

  plot.canvas.addEventListener("pointermove", (event) => show(nearest(...positionIn(plot, event))));
  plot.canvas.addEventListener("pointerdown", (event) => show(nearest(...positionIn(plot, event))));
  plot.canvas.addEventListener("pointerleave", () => show(null));
  plot.canvas.addEventListener("blur", () => show(null));
  plot.canvas.addEventListener("keydown", (event) => {
    const moves = {
      ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1],
      Home: [-1e9, 0], End: [1e9, 0]
    };
    if (!(event.key in moves)) return;
    event.preventDefault();
    step(...moves[event.key]);
  });

  return {
    moved() {
      const kept = current && plot.visibleSeries().includes(current.one) &&
        inside(place(current));
      show(kept ? current : null);
    }
  };
}
