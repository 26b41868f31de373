// SPDX-License-Identifier: GPL-3.0-or-later
// The viewer of packings shows one packing, or two packings side by side with one set of controls. Its elements come
// from the templates viewer-parts and pane-parts (page.html), and are found by `data-part`.
import {addOptions, coloursOf, element, extentOf, plain, save, written} from "./dom.js";
import {crystalliteSizes, decodeFrame, lookOf, valueOf, viridis} from "./grains.js";
import {Plot} from "./plot.js";
import {PackingScene} from "./scene.js";

const wallColour = [107, 116, 128];
const looks = ["colour", "profile", "disordered", "walls", "box", "cut-axis", "cut-at", "cut-side"];

function partsIn(host, template) {
  host.append(document.getElementById(template).content.cloneNode(true));
  return (name) => host.querySelector(`[data-part="${name}"]`);
}

// The position of the clip plane, and the grains that it hides. `side`: 1 or -1, the side on which grains are hidden.
function cutOf({axis, at, side}, {width, depth, bottom, top}) {
  const ends = {x: [-1, width + 1], y: [bottom - 1, top + 1], z: [-0.5, depth + 0.5]}[axis];
  if (!ends) return {place: null, hides: () => false};
  const place = ends[0] + (ends[1] - ends[0]) * at;
  const k = "xyz".indexOf(axis);
  return {place, hides: (centre) => side * centre[k] > side * place};
}

// Shows one packing: the picture, the colour key and the values.
class Pane {
  // Throws if the browser has no WebGL 2. `turned` is called when the reader turns or zooms the view.
  constructor(parent, turned) {
    this.host = element("div", {className: "pane"});
    parent.append(this.host);
    this.part = partsIn(this.host, "pane-parts");
    this.canvas = this.part("canvas");
    this.scene = new PackingScene(this.canvas, turned);
    this.canvas.addEventListener("pointermove", (event) => event.buttons === 0 && this.point(event));
    this.canvas.addEventListener("pointerdown", (event) => this.point(event));
    this.canvas.addEventListener("pointerleave", () => this.tell(-1));
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.scene.fit()).observe(this.canvas);
  }

  show(packing) {
    this.packing = packing;
    this.stored = null;
  }

  // Shows the checkpoint at this cycle, or the last checkpoint before the cycle.
  showCycle(cycle, choices) {
    const {grains, wall_grains: wallGrains, frames} = this.packing;
    const stored = frames.findLast((frame) => frame.cycle <= cycle) ?? frames[0];
    this.scene.setCell(stored.cell, this.stored !== null);
    this.stored = stored;
    this.frame = decodeFrame(stored, grains, wallGrains);
    const facts = [plain(stored.name), plain(`N = ${grains}`), ...stored.facts];
    this.part("facts").replaceChildren(...facts.map((fact) => element("span", {}, ...written(fact))));
    this.part("checkpoint").textContent = stored.sha256.slice(0, 12);
    this.part("checkpoint").title = stored.sha256;
    this.apply(choices);
    this.tell(-1);
  }

  apply(choices) {
    const {frame, stored, packing: {grains}} = this;
    const look = lookOf(frame, choices.colour);
    const {hides} = cutOf(choices, stored.cell);
    const count = frame.position.length / 3;
    const [spheres, colours] = [new Float32Array(4 * count), new Uint8Array(3 * count)];
    for (let i = 0; i < count; ++i) {
      const place = frame.position.subarray(3 * i, 3 * i + 3);
      // The side walls extend beyond the moving wall. Their outer parts are not shown.
      const walled = choices.walls && place[1] > stored.cell.bottom - 1 && place[1] < stored.cell.top + 1;
      const radius = i >= grains ? 0.5 * walled : frame.structure[i] === 0 ? choices.disordered : 0.5;
      spheres.set([...place, hides(place) ? 0 : radius], 4 * i);
      colours.set(i < grains ? look.paint(i) : wallColour, 3 * i);
    }
    this.scene.frameLines.visible = choices.box;
    this.scene.setSpheres(spheres, colours);
    this.showKey(look);
    this.showProfile(choices.profile, choices.profileName);
  }

  showKey({entries, note, bar}) {
    const css = (colour) => `rgb(${colour.join()})`;
    const coloured = (className, background) => element("i", {className, style: `background: ${background}`});
    if (bar) {
      const stops = [0, 0.25, 0.5, 0.75, 1].map((t) => css(viridis(t)));
      this.part("key").replaceChildren(element("span", {}, ...written(bar.label)),
        element("span", {}, bar.low, coloured("strip", `linear-gradient(to right, ${stops.join()})`), bar.high));
      return;
    }
    this.part("key").replaceChildren(...entries.map(({colour, text}) =>
      element("span", {}, coloured("dot", css(colour)), text)), element("span", {}, note));
  }

  // Plots the height of layers against a measure. The measure has the same range for all checkpoints of the run.
  showProfile(key, name) {
    const host = this.part("profile-plot");
    const {height} = this.stored.profiles;
    const values = key === "none" ? [] : this.packing.frames.flatMap(({profiles}) => profiles[key]).filter(Number.isFinite);
    host.hidden = values.length === 0;
    if (host.hidden) return;
    const [low, high] = extentOf(values);
    const chart = {
      x: {label: plain(name), unit: [], low, high},
      y: {label: plain("height"), unit: plain("d"), low: 0, high: null}, title: [], lines: [],
      series: [{
        title: [], name: [], colour: "#d55e00", point: 7, line: true, shift: 0,
        points: this.stored.profiles[key].map((value, layer) => [value, height[layer]]).filter(([x]) => x !== null)
      }]
    };
    if (this.profile) this.profile.show(chart);
    else this.profile = new Plot(host, chart, "profile");
  }

  key(event) {
    const turns = {ArrowLeft: [0.12, 0], ArrowRight: [-0.12, 0], ArrowUp: [0, 0.12], ArrowDown: [0, -0.12]};
    if (event.key in turns) this.scene.turn(...turns[event.key]);
    else if (event.key === "+" || event.key === "=") this.scene.nearer(1.2);
    else if (event.key === "-") this.scene.nearer(1 / 1.2);
    else if (event.key === "0") this.scene.resetView();
    else return;
    event.preventDefault();
  }

  point(event) {
    const bounds = this.canvas.getBoundingClientRect();
    if (this.frame) this.tell(this.scene.pick(event.clientX - bounds.left, event.clientY - bounds.top));
  }

  tell(i) {
    const {frame, packing} = this;
    const readout = this.part("grain");
    readout.textContent = "Point at a grain to read its values.";
    if (i < 0) return;
    const place = `at (${[0, 1, 2].map((axis) => frame.position[3 * i + axis].toFixed(2)).join(", ")}) d`;
    readout.textContent = `wall grain ${place}`;
    if (i >= packing.grains) return;
    const {structure, phi_local: phi, q6} = frame.fields;
    const size = crystalliteSizes(frame.crystallite).get(frame.crystallite[i]);
    readout.replaceChildren(...written([
      [`grain ${i}: ${structure.classes[frame.structure[i]]}, `, ""], ["ϕ", "i"], ["local", "sub"],
      [` = ${valueOf(phi, i).toFixed(4)}, `, ""], ["q", "i"], ["6", "sub"], [` = ${valueOf(q6, i).toFixed(4)}, ` +
        `${size ? `in a crystallite of ${size}` : "in no crystallite"}` +
        `${frame.interior[i] ? "" : ", near a wall"}, ${place}`, ""]
    ]));
  }
}

// Shows the last checkpoint of a packing, without controls. If the browser has no WebGL 2, nothing is shown.
export function showPacking(host, packing) {
  const last = packing.frames.at(-1);
  try {
    const pane = new Pane(host, () => {});
    const colour = () => pane.scene.setColours(coloursOf(pane.part("stage")));
    window.addEventListener("themechange", colour);
    colour();
    pane.show(packing);
    // If there are crystallites, disordered grains are drawn small, so that they do not hide the crystallites.
    pane.showCycle(last.cycle, {
      colour: "structure", profile: "none", disordered: last.crystalline > 5 ? 0.17 : 0.5, walls: true, box: true, axis: "none"
    });
  } catch {
    host.hidden = true;
  }
}

export class Viewer {
  constructor(host, packings, count) {
    this.packings = packings;
    this.part = partsIn(host, "viewer-parts");
    this.panes = [];
    try {
      for (let k = 0; k < count; ++k) {
        this.panes.push(new Pane(this.part("panes"), () => this.follow(this.panes[k])));
      }
    } catch {
      this.part("trouble").hidden = false;
      this.part("panes").hidden = true;
      this.panes = [];
      return;
    }
    this.part("run").parentElement.hidden = count > 1;
    addOptions(this.part("run"), packings, ({experiment}) => experiment, ({label}) => label);
    // All packings of a page have the same fields.
    const colours = this.part("colour");
    for (const {key, label} of packings[0].frames[0].fields) {
      if (!colours.querySelector(`[value="${key}"]`)) colours.append(new Option(label, key));
    }
    const on = (name, event, action) => this.part(name).addEventListener(event, action);
    on("run", "change", () => this.showRuns([packings[Number(this.part("run").value)]]));
    on("cycle", "input", () => this.showFrame(Number(this.part("cycle").value)));
    on("play", "click", () => this.play(!this.timer));
    for (const name of looks) on(name, "input", () => this.apply());
    on("reset", "click", () => this.shown().forEach((pane) => pane.scene.resetView()));
    on("save", "click", () => this.shown().forEach((pane) => {
      pane.scene.drawNow();  // needed because the browser discards a picture after showing it
      pane.canvas.toBlob((blob) => save(`${pane.packing.id.slice(0, 8)}.png`, blob));
    }));
    const recolour = () => this.panes.forEach((pane) => pane.scene.setColours(coloursOf(pane.part("stage"))));
    window.addEventListener("themechange", recolour);
    recolour();
    if (count === 1) this.showRuns([packings[0]]);
  }

  shown() {
    return this.panes.filter((pane) => !pane.host.hidden);
  }

  // Shows one packing in each pane. A pane without a packing is hidden.
  showRuns(packings) {
    this.play(false);
    this.panes.forEach((pane, k) => {
      pane.host.hidden = !packings[k];
      if (packings[k]) pane.show(packings[k]);
    });
    const all = packings.filter(Boolean);
    if (this.panes.length === 0 || all.length === 0) return;
    this.part("run").value = String(this.packings.indexOf(all[0]));
    this.cycles = [...new Set(all.flatMap((one) => one.frames.map((frame) => frame.cycle)))].sort((a, b) => a - b);
    const slider = this.part("cycle");
    slider.max = String(this.cycles.length - 1);
    slider.disabled = this.part("play").disabled = this.cycles.length < 2;
    this.showFrame(this.cycles.length - 1);
  }

  showFrame(index) {
    const shown = this.shown();
    for (const pane of shown) pane.showCycle(this.cycles[index], this.choices());
    const name = shown.length > 1 ? `cycle ${this.cycles[index]}` : shown[0].stored.name;
    this.part("cycle").value = String(index);
    this.part("cycle").setAttribute("aria-valuetext", name);
    this.part("cycle-text").textContent = name;
    this.tellCut();
  }

  choices() {
    const value = (name) => this.part(name).value;
    return {
      colour: value("colour"), profile: value("profile"),
      profileName: this.part("profile").selectedOptions[0].textContent, disordered: Number(value("disordered")),
      walls: this.part("walls").checked, box: this.part("box").checked, axis: value("cut-axis"),
      at: Number(value("cut-at")) / 1000, side: this.part("cut-side").checked ? -1 : 1
    };
  }

  apply() {
    for (const pane of this.shown()) pane.apply(this.choices());
    this.tellCut();
  }

  tellCut() {
    const choices = this.choices();
    const {place} = cutOf(choices, this.shown()[0].stored.cell);
    for (const name of ["cut-at", "cut-side"]) this.part(name).disabled = place === null;
    this.part("cut-text").textContent = place === null ? "" : `${choices.axis} = ${place.toFixed(1)} d`;
  }

  // Turns the other pane to the same view.
  follow(from) {
    for (const pane of this.shown()) if (pane !== from && pane.stored) pane.scene.lookAs(from.scene);
  }

  play(wanted) {
    clearInterval(this.timer);
    this.part("play").textContent = wanted ? "Pause" : "Play";
    this.timer = wanted && setInterval(() =>
      this.showFrame((Number(this.part("cycle").value) + 1) % this.cycles.length), 350);
  }
}
