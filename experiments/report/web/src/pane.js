// SPDX-License-Identifier: GPL-3.0-or-later
// One packing: its picture, the key of its colours, its values.
import {coloursOf, lookOf, viridis} from "./colours.js";
import {pane as markup} from "./controls.js";
import {element} from "./dom.js";
import {crystalliteSizes, decodeFrame, structureNames} from "./frames.js";
import {drawProfile} from "./profile.js";
import {PackingScene} from "./scene.js";
import {italic, plain, sub, writeText} from "./text.js";

const axes = {none: -1, x: 0, y: 1, z: 2};

export class Pane {
  // Throws if the browser has no WebGL 2. `turned` is called when the reader turns or zooms it.
  constructor(host, turned) {
    this.host = element("div", {className: "pane", innerHTML: markup});
    this.part = (name) => this.host.querySelector(`[data-part="${name}"]`);
    this.canvas = this.part("canvas");
    this.scene = new PackingScene(this.canvas, turned);
    host.append(this.host);
    this.canvas.addEventListener("pointermove", (event) => this.point(event));
    this.canvas.addEventListener("pointerdown", (event) => this.point(event));
    this.canvas.addEventListener("pointerleave", () => this.tell(-1));
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.scene.fit()).observe(this.canvas);
  }

  show(packing) {
    this.packing = packing;
    this.scene.cell = null;
  }

  // The one at this cycle, or the last one before it.
  frameAt(cycle) {
    const later = this.packing.frames.findIndex((frame) => frame.cycle > cycle);
    return later < 0 ? this.packing.frames.length - 1 : Math.max(0, later - 1);
  }

  showFrame(index, choices) {
    const {grains, wall_grains: wallGrains, frames} = this.packing;
    const stored = frames[index];
    const hadCell = Boolean(this.scene.cell);
    this.stored = stored;
    this.frame = decodeFrame(stored, grains, wallGrains);
    this.scene.spheres.setPositions(this.frame.position);
    this.scene.setCell(stored.cell, hadCell);
    const facts = [plain(stored.name), plain(`N = ${grains}`), ...stored.facts];
    this.part("facts").replaceChildren(...facts.map((fact) => writeText(element("span"), fact)));
    this.part("checkpoint").textContent = stored.sha256.slice(0, 12);
    this.part("checkpoint").title = stored.sha256;
    this.apply(choices);
    this.tell(-1);
  }

  // choices: {colour, profile, disordered, walls, box, axis, at, otherSide}
  apply(choices) {
    const look = lookOf(this.frame, choices.colour);
    this.scene.spheres.setColours(
      coloursOf(look.paint, this.packing.grains, this.frame.position.length / 3));
    this.showKey(look);
    drawProfile(this.part("profile-line"), this.packing.frames, this.stored, choices.profile);
    this.resize(choices);
    this.scene.frameLines.visible = choices.box;
    this.scene.setCut(axes[choices.axis], this.placeOfCut(choices), choices.otherSide ? -1 : 1);
    this.scene.draw();
  }

  placeOfCut({axis, at}) {
    const {width, depth, bottom, top} = this.stored.cell;
    const [low, high] =
      [[-1, width + 1], [bottom - 1, top + 1], [-0.5, depth + 0.5]][axes[axis]] ?? [0, 1];
    return low + (high - low) * at;
  }

  resize({disordered, walls}) {
    const {grains} = this.packing;
    const small = {full: 0.5, small: 0.17, hidden: 0}[disordered];
    const wall = walls ? 0.5 : 0;
    const {position} = this.frame;
    this.radii = new Float32Array(position.length / 3);
    for (let i = grains; i < this.radii.length; ++i) {
      // Side walls extend beyond the moving wall; that part is not shown.
      const y = position[3 * i + 1];
      this.radii[i] = y > this.stored.cell.bottom - 1 && y < this.stored.cell.top + 1 ? wall : 0;
    }
    for (let i = 0; i < grains; ++i) {
      this.radii[i] = this.frame.structure[i] === 0 ? small : 0.5;
    }
    this.scene.spheres.setRadii(this.radii);
  }

  key(event) {
    const turns = {
      ArrowLeft: [0.12, 0], ArrowRight: [-0.12, 0], ArrowUp: [0, -0.12], ArrowDown: [0, 0.12]
    };
    if (event.key in turns) this.scene.turn(...turns[event.key]);
    else if (event.key === "+" || event.key === "=") this.scene.nearer(1.2);
    else if (event.key === "-") this.scene.nearer(1 / 1.2);
    else if (event.key === "0") this.scene.resetView();
    else return;
    event.preventDefault();
  }

  point(event) {
    if (!this.frame || (event.buttons !== 0 && event.type === "pointermove")) return;
    const bounds = this.canvas.getBoundingClientRect();
    this.tell(this.scene.pick(event.clientX - bounds.left, event.clientY - bounds.top,
      this.frame.position, this.radii));
  }

  tell(i) {
    const readout = this.part("grain");
    if (i < 0) {
      readout.textContent = "Point at a grain to read its values.";
      return;
    }
    const {frame} = this;
    const place = [0, 1, 2].map((axis) => frame.position[3 * i + axis].toFixed(2)).join(", ");
    if (i >= this.packing.grains) {
      readout.textContent = `wall grain at (${place}) d`;
      return;
    }
    const label = frame.crystallite[i];
    const size = label > 0 ? crystalliteSizes(frame.crystallite).size.get(label) : 0;
    readout.replaceChildren();
    const where = `${size > 0 ? `in a crystallite of ${size}` : "in no crystallite"}` +
      `${frame.interior[i] ? "" : ", near a wall"}, at (${place}) d`;
    writeText(readout, [
      ...plain(`grain ${i}: ${structureNames[frame.structure[i]]}, `),
      ...italic("ϕ"), ...sub("local"), ...plain(` = ${frame.phiLocal[i].toFixed(4)}, `),
      ...italic("q"), ...sub("6"), ...plain(` = ${frame.q6[i].toFixed(4)}, ${where}`)
    ]);
  }

  showKey({entries, bar}) {
    const key = this.part("key");
    key.replaceChildren();
    if (bar) {
      const label = writeText(element("span", {className: "of"}), bar.label);
      const strip = element("span", {className: "strip"});
      const stops = [0, 0.25, 0.5, 0.75, 1].map((t) => `rgb(${viridis(t).join(" ")})`);
      strip.style.background = `linear-gradient(to right, ${stops.join(", ")})`;
      key.append(label, ` ${bar.low} `, strip, ` ${bar.high}`);
      return;
    }
    for (const {colour, text} of entries) {
      const dot = element("i");
      dot.style.background = colour;
      key.append(element("span", {className: "entry"}, dot, text));
    }
  }
}
