// SPDX-License-Identifier: GPL-3.0-or-later
// The packing viewer: one packing or two side by side, with one set of controls for both.
import {controls} from "./controls.js";
import {addOptions} from "./dom.js";
import {Pane} from "./pane.js";
import {saveBlob} from "./save.js";
import {onThemeChange, pageColours} from "./theme.js";

const looks = ["colour", "profile", "disordered", "walls", "box", "cut-axis", "cut-at", "cut-side"];

export class Viewer {
  constructor(host, packings, count = 1) {
    this.packings = packings;
    host.innerHTML = controls;
    this.part = (name) => host.querySelector(`[data-part="${name}"]`);
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
    this.connect();
    onThemeChange(() => this.setColours());
    this.setColours();
    if (count === 1) this.showRuns([packings[0]]);
  }

  connect() {
    const on = (name, event, action) => this.part(name).addEventListener(event, action);
    on("run", "change", () => this.showRuns([this.packings[Number(this.part("run").value)]]));
    on("cycle", "input", () => this.showFrame(Number(this.part("cycle").value)));
    on("play", "click", () => this.play(!this.playing));
    for (const name of looks) on(name, "input", () => this.apply());
    on("reset", "click", () => this.shown().forEach((pane) => pane.scene.resetView()));
    on("save", "click", () => this.shown().forEach((pane) => this.savePicture(pane)));
  }

  shown() {
    return this.panes.filter((pane) => !pane.host.hidden);
  }

  setColours() {
    for (const pane of this.panes) pane.scene.setColours(pageColours(pane.part("stage")));
  }

  // One packing for each pane; a pane without one is not shown.
  showRuns(packings) {
    if (this.panes.length === 0) return;
    this.play(false);
    this.panes.forEach((pane, k) => {
      pane.host.hidden = !packings[k];
      if (packings[k]) pane.show(packings[k]);
    });
    const all = packings.filter(Boolean);
    if (all.length === 0) return;
    this.part("run").value = String(this.packings.indexOf(all[0]));
    this.cycles = [...new Set(all.flatMap((one) => one.frames.map((frame) => frame.cycle)))]
      .sort((a, b) => a - b);
    const slider = this.part("cycle");
    slider.max = String(this.cycles.length - 1);
    slider.disabled = this.cycles.length < 2;
    this.part("play").disabled = slider.disabled;
    this.showFrame(this.cycles.length - 1);
  }

  showRunCalled(id) {
    const packing = this.packings.find((one) => one.id === id);
    if (packing) this.showRuns([packing]);
  }

  showFrame(index) {
    const choices = this.choices();
    const shown = this.shown();
    for (const pane of shown) pane.showFrame(pane.frameAt(this.cycles[index]), choices);
    const name = shown.length > 1 ? `cycle ${this.cycles[index]}` : shown[0].stored.name;
    this.part("cycle").value = String(index);
    this.part("cycle").setAttribute("aria-valuetext", name);
    this.part("cycle-text").textContent = name;
    this.tellCut();
  }

  choices() {
    return {
      colour: this.part("colour").value, profile: this.part("profile").value, disordered: this.part("disordered").value,
      walls: this.part("walls").checked, box: this.part("box").checked,
      axis: this.part("cut-axis").value, at: Number(this.part("cut-at").value) / 1000,
      otherSide: this.part("cut-side").checked
    };
  }

  apply() {
    for (const pane of this.shown()) pane.apply(this.choices());
    this.tellCut();
  }

  tellCut() {
    const choices = this.choices();
    const none = choices.axis === "none";
    for (const name of ["cut-at", "cut-side"]) this.part(name).disabled = none;
    this.part("cut-text").textContent =
      none ? "" : `${choices.axis} = ${this.shown()[0].placeOfCut(choices).toFixed(1)} d`;
  }

  // The other pane is seen from the same side.
  follow(from) {
    for (const pane of this.shown()) if (pane !== from) pane.scene.lookAs(from.scene);
  }

  play(wanted) {
    clearInterval(this.timer);
    this.playing = wanted;
    this.part("play").textContent = wanted ? "Pause" : "Play";
    if (!wanted) return;
    this.timer = setInterval(() => {
      const next = Number(this.part("cycle").value) + 1;
      this.showFrame(next < this.cycles.length ? next : 0);
    }, 350);
  }

  savePicture(pane) {
    pane.scene.drawNow();  // what was drawn is lost once the browser has shown it
    pane.canvas.toBlob((blob) => saveBlob(`${pane.packing.id.slice(0, 8)}.png`, blob));
  }
}
