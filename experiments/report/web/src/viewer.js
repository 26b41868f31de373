// SPDX-License-Identifier: GPL-3.0-or-later
// The packing viewer: run, checkpoint, colours, clip plane.
import {coloursOf, keyOf, viridis} from "./colours.js";
import {controls} from "./controls.js";
import {crystalliteSizes, decodeFrame, structureNames} from "./frames.js";
import {saveBlob} from "./save.js";
import {PackingScene} from "./scene.js";
import {italic, plain, sub, writeHtmlText} from "./text.js";
import {onThemeChange, pageColours} from "./theme.js";

const axes = {none: -1, x: 0, y: 1, z: 2};

export class Viewer {
  constructor(section, packings) {
    this.packings = packings;
    section.querySelector(".viewer").innerHTML = controls;
    this.part = (name) => section.querySelector(`[data-part="${name}"]`);
    this.canvas = this.part("canvas");
    this.frame = null;
    this.readout = this.part("grain");
    try {
      this.scene = new PackingScene(this.canvas);
    } catch {
      this.part("trouble").hidden = false;
      this.part("stage").hidden = true;
      return;
    }
    this.fillRuns();
    this.connect();
    this.showRun(0);
    new ResizeObserver(() => this.scene.fit()).observe(this.canvas);
    onThemeChange(() => this.scene.setColours(pageColours()));
    this.scene.setColours(pageColours());
  }

  fillRuns() {
    const groups = new Map();
    this.packings.forEach((packing, index) => {
      if (!groups.has(packing.experiment)) {
        const group = document.createElement("optgroup");
        group.label = packing.experiment;
        groups.set(packing.experiment, group);
        this.part("run").append(group);
      }
      const option = document.createElement("option");
      option.value = String(index);
      option.textContent = packing.label;
      groups.get(packing.experiment).append(option);
    });
  }

  connect() {
    const on = (name, event, action) => this.part(name).addEventListener(event, action);
    on("run", "change", () => this.showRun(Number(this.part("run").value)));
    on("cycle", "input", () => this.showFrame(Number(this.part("cycle").value)));
    on("play", "click", () => this.play(!this.playing));
    on("colour", "change", () => this.recolour());
    on("disordered", "change", () => this.resize());
    on("walls", "change", () => this.resize());
    on("box", "change", () => {
      this.scene.frameLines.visible = this.part("box").checked;
      this.scene.draw();
    });
    for (const name of ["cut-axis", "cut-at", "cut-side"]) on(name, "input", () => this.cut());
    on("reset", "click", () => this.scene.resetView());
    on("save", "click", () => this.savePicture());
    this.canvas.addEventListener("pointermove", (event) => this.point(event));
    this.canvas.addEventListener("pointerdown", (event) => this.point(event));
    this.canvas.addEventListener("pointerleave", () => this.tell(-1));
    this.canvas.addEventListener("keydown", (event) => this.key(event));
  }

  showRun(index) {
    this.play(false);
    this.packing = this.packings[index];
    this.part("run").value = String(index);
    const slider = this.part("cycle");
    slider.max = String(this.packing.frames.length - 1);
    slider.disabled = this.packing.frames.length < 2;
    this.part("play").disabled = slider.disabled;
    this.scene.cell = null;
    this.showFrame(this.packing.frames.length - 1);
  }

  showRunCalled(id) {
    const index = this.packings.findIndex((packing) => packing.id === id);
    if (index >= 0 && this.scene) this.showRun(index);
  }

  showFrame(index) {
    const {grains, wall_grains: wallGrains, frames} = this.packing;
    const stored = frames[index];
    const hadCell = Boolean(this.scene.cell);
    this.stored = stored;
    this.frame = decodeFrame(stored, grains, wallGrains);
    this.scene.spheres.setPositions(this.frame.position);
    this.scene.setCell(stored.cell, hadCell);
    this.part("cycle").value = String(index);
    this.part("cycle").setAttribute("aria-valuetext", stored.name);
    this.part("cycle-text").textContent = stored.name;
    const facts = [plain(`N = ${grains}`), ...stored.facts];
    this.part("facts").replaceChildren(...facts.map((fact) => {
      const one = document.createElement("span");
      writeHtmlText(one, fact);
      return one;
    }));
    this.part("checkpoint").textContent = stored.sha256.slice(0, 12);
    this.part("checkpoint").title = stored.sha256;
    this.resize();
    this.recolour();
    this.cut();
    this.tell(-1);
  }

  recolour() {
    const mode = this.part("colour").value;
    this.scene.spheres.setColours(coloursOf(this.frame, this.packing.grains, mode));
    this.showKey(keyOf(this.frame, mode));
    this.scene.draw();
  }

  resize() {
    const {grains} = this.packing;
    const disordered = {full: 0.5, small: 0.17, hidden: 0}[this.part("disordered").value];
    const wall = this.part("walls").checked ? 0.5 : 0;
    const {position} = this.frame;
    this.radii = new Float32Array(position.length / 3);
    for (let i = grains; i < this.radii.length; ++i) {
      // Side walls extend beyond the moving wall; that part is not shown.
      const y = position[3 * i + 1];
      this.radii[i] = y > this.stored.cell.bottom - 1 && y < this.stored.cell.top + 1 ? wall : 0;
    }
    for (let i = 0; i < grains; ++i) {
      this.radii[i] = this.frame.structure[i] === 0 ? disordered : 0.5;
    }
    this.scene.spheres.setRadii(this.radii);
    this.scene.draw();
  }

  cut() {
    const axis = axes[this.part("cut-axis").value];
    const {width, depth, bottom, top} = this.stored.cell;
    const range = [[-1, width + 1], [bottom - 1, top + 1], [-0.5, depth + 0.5]][axis] ?? [0, 1];
    const at = range[0] + (range[1] - range[0]) * Number(this.part("cut-at").value) / 1000;
    for (const name of ["cut-at", "cut-side"]) this.part(name).disabled = axis < 0;
    this.part("cut-text").textContent =
      axis < 0 ? "" : `${"xyz"[axis]} = ${at.toFixed(1)} d`;
    this.scene.setCut(axis, at, this.part("cut-side").checked ? -1 : 1);
  }

  play(wanted) {
    clearInterval(this.timer);
    this.playing = wanted;
    this.part("play").textContent = wanted ? "Pause" : "Play";
    if (!wanted) return;
    this.timer = setInterval(() => {
      const next = Number(this.part("cycle").value) + 1;
      this.showFrame(next < this.packing.frames.length ? next : 0);
    }, 350);
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
    if (event.buttons !== 0 && event.type === "pointermove") return;
    const bounds = this.canvas.getBoundingClientRect();
    this.tell(this.scene.pick(event.clientX - bounds.left, event.clientY - bounds.top,
      this.frame.position, this.radii));
  }

  tell(i) {
    if (i < 0) {
      this.readout.textContent = "Point at a grain to read its values.";
      return;
    }
    const {frame} = this;
    const place = [0, 1, 2].map((axis) => frame.position[3 * i + axis].toFixed(2)).join(", ");
    if (i >= this.packing.grains) {
      this.readout.textContent = `wall grain at (${place}) d`;
      return;
    }
    const label = frame.crystallite[i];
    const size = label > 0 ? crystalliteSizes(frame.crystallite).size.get(label) : 0;
    this.readout.replaceChildren();
    const where = `${size > 0 ? `in a crystallite of ${size}` : "in no crystallite"}` +
      `${frame.interior[i] ? "" : ", near a wall"}, at (${place}) d`;
    writeHtmlText(this.readout, [
      ...plain(`grain ${i}: ${structureNames[frame.structure[i]]}, `),
      ...italic("ϕ"), ...sub("local"), ...plain(` = ${frame.phiLocal[i].toFixed(4)}, `),
      ...italic("q"), ...sub("6"), ...plain(` = ${frame.q6[i].toFixed(4)}, ${where}`)
    ]);
  }

  showKey({entries, bar}) {
    const key = this.part("key");
    key.replaceChildren();
    if (bar) {
      const label = document.createElement("span");
      label.className = "of";
      writeHtmlText(label, bar.label);
      const strip = document.createElement("span");
      strip.className = "strip";
      const stops = [0, 0.25, 0.5, 0.75, 1].map((t) => `rgb(${viridis(t).join(" ")})`);
      strip.style.background = `linear-gradient(to right, ${stops.join(", ")})`;
      key.append(label, ` ${bar.low} `, strip, ` ${bar.high}`);
      return;
    }
    for (const {colour, text} of entries) {
      const entry = document.createElement("span");
      entry.className = "entry";
      const dot = document.createElement("i");
      dot.style.background = colour;
      entry.append(dot, text);
      key.append(entry);
    }
  }

  savePicture() {
    this.scene.drawNow();  // what was drawn is lost once the browser has shown it
    this.canvas.toBlob((blob) => saveBlob(`${this.packing.id.slice(0, 8)}.png`, blob));
  }
}
