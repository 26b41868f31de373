// SPDX-License-Identifier: GPL-3.0-or-later
// Zooming a plot: drag a rectangle, double-click for everything, the wheel over a plot that has the
// focus (elsewhere it scrolls the page), plus, minus and 0 on the keyboard.
import {svg} from "./dom.js";

const smallestDrag = 6;  // pixels

export function positionIn(plot, event) {
  const bounds = plot.canvas.getBoundingClientRect();
  return [
    (event.clientX - bounds.left) * plot.width / bounds.width,
    (event.clientY - bounds.top) * plot.height / bounds.height
  ];
}

export function addGestures(plot) {
  addRectangle(plot);
  plot.canvas.addEventListener("dblclick", () => plot.show(null));
  plot.canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== plot.canvas && !event.ctrlKey) return;
    event.preventDefault();
    const [x, y] = positionIn(plot, event);
    plot.zoom(1.0015 ** event.deltaY, x, y);
  }, {passive: false});
  plot.canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "+" || event.key === "=") plot.zoom(0.6);
    else if (event.key === "-") plot.zoom(1 / 0.6);
    else if (event.key === "0" || event.key === "Escape") plot.show(null);
    else return;
    event.preventDefault();
  });
}

function addRectangle(plot) {
  let start = null;
  let shape = null;
  const clamp = ([x, y]) => [
    Math.min(plot.box.right, Math.max(plot.box.left, x)),
    Math.min(plot.box.bottom, Math.max(plot.box.top, y))
  ];
  plot.canvas.addEventListener("pointerdown", (event) => {
    // A finger scrolls the page.
    if (event.pointerType === "touch" || event.button !== 0) return;
    start = clamp(positionIn(plot, event));
    plot.canvas.setPointerCapture(event.pointerId);
  });
  plot.canvas.addEventListener("pointermove", (event) => {
    if (!start) return;
    const end = clamp(positionIn(plot, event));
    shape ??= svg("rect", {class: "selection"}, plot.overlay);
    shape.setAttribute("x", Math.min(start[0], end[0]));
    shape.setAttribute("y", Math.min(start[1], end[1]));
    shape.setAttribute("width", Math.abs(end[0] - start[0]));
    shape.setAttribute("height", Math.abs(end[1] - start[1]));
  });
  const finish = (event) => {
    if (!start) return;
    const [from, to] = [start, clamp(positionIn(plot, event))];
    start = null;
    shape?.remove();
    shape = null;
    if (event.type !== "pointerup") return;
    if (Math.min(Math.abs(from[0] - to[0]), Math.abs(from[1] - to[1])) < smallestDrag) return;
    const range = (scale, a, b) => [scale.invert(a), scale.invert(b)].sort((m, n) => m - n);
    plot.show({
      x: range(plot.scales.x, from[0], to[0]), y: range(plot.scales.y, from[1], to[1])
    });
  };
  plot.canvas.addEventListener("pointerup", finish);
  plot.canvas.addEventListener("pointercancel", finish);
}
