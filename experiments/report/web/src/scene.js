// SPDX-License-Identifier: GPL-3.0-or-later
// The view of one packing: spheres, the tilted cell, a camera without perspective. It is drawn only
// when something changes.
import {
  BoxGeometry, BufferGeometry, Color, EdgesGeometry, LineBasicMaterial, LineSegments, Matrix4,
  OrthographicCamera, Scene, SRGBColorSpace, Vector3, WebGLRenderer
} from "three";
import {OrbitControls} from "three/examples/jsm/controls/OrbitControls.js";
import {Spheres} from "./spheres.js";

const firstDirection = new Vector3(0.5, 0.28, 1).normalize();

// Edges of the sheared box: side walls tilt about the height of the top wall.
function cellEdges({width, depth, bottom, top, tan_theta: tilt}) {
  const box = new BoxGeometry(width, top - bottom, depth);
  box.translate(width / 2, (bottom + top) / 2, depth / 2);
  const shear = new Matrix4().set(1, tilt, 0, -tilt * top, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);
  return new EdgesGeometry(box).applyMatrix4(shear);
}

export class PackingScene {
  // Throws if the browser has no WebGL 2. `turned` is called when the reader turns, moves or zooms it.
  constructor(canvas, turned) {
    this.canvas = canvas;
    this.turned = turned;
    this.renderer = new WebGLRenderer({canvas, antialias: true, alpha: false});
    this.scene = new Scene();
    this.spheres = new Spheres();
    this.frameLines = new LineSegments(new BufferGeometry(), new LineBasicMaterial());
    this.scene.add(this.spheres.mesh, this.frameLines);
    this.camera = new OrthographicCamera(-1, 1, 1, -1, -500, 500);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    // Without the focus the wheel scrolls the page, and so does a finger that moves up or down.
    this.controls.enableZoom = false;
    canvas.addEventListener("focus", () => (this.controls.enableZoom = true));
    canvas.addEventListener("blur", () => (this.controls.enableZoom = false));
    canvas.style.touchAction = "pan-y";
    this.following = false;
    this.controls.addEventListener("change", () => {
      this.draw();
      if (!this.following) this.turned();
    });
    this.span = 10;
    this.pending = false;
    canvas.addEventListener("webglcontextrestored", () => this.draw());
  }

  setCell(cell, keepView) {
    this.frameLines.geometry.dispose();
    this.frameLines.geometry = cellEdges(cell);
    this.cell = cell;
    if (!keepView) this.resetView();
  }

  resetView() {
    const {width, depth, bottom, top} = this.cell;
    this.span = Math.hypot(width, depth, top - bottom);
    const centre = new Vector3(width / 2, (bottom + top) / 2, depth / 2);
    this.centre = centre;
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(firstDirection, this.span);
    this.camera.near = -2 * this.span;
    this.camera.far = 4 * this.span;
    this.camera.zoom = 1;
    this.controls.update();
    this.fit();
  }

  // The packing fills the canvas whatever its shape.
  fit() {
    const {clientWidth: wide, clientHeight: high} = this.canvas;
    if (!this.cell || wide === 0 || high === 0) return;
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.setSize(wide, high, false);
    const {width, depth, bottom, top} = this.cell;
    const tall = (top - bottom) * 0.5 + depth * 0.16 + 1.5;
    const across = (width * 0.9 + depth * 0.45) * 0.5 + 1.5;
    const scale = Math.max(tall, across * high / wide);
    this.camera.top = scale;
    this.camera.bottom = -scale;
    this.camera.right = scale * wide / high;
    this.camera.left = -this.camera.right;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  turn(horizontal, vertical) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    offset.applyAxisAngle(new Vector3(0, 1, 0), horizontal);
    const side = new Vector3(0, 1, 0).cross(offset).normalize();
    const turned = offset.clone().applyAxisAngle(side, vertical);
    if (Math.abs(turned.clone().normalize().y) < 0.995) offset.copy(turned);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.draw();
  }

  nearer(factor) {
    this.camera.zoom = Math.min(40, Math.max(0.2, this.camera.zoom * factor));
    this.camera.updateProjectionMatrix();
    this.draw();
    this.turned();
  }

  // Takes the direction, the zoom and the shift of another view.
  lookAs(other) {
    if (!this.cell || !other.cell) return;
    const away = other.camera.position.clone().sub(other.controls.target);
    this.controls.target.copy(other.controls.target).sub(other.centre).add(this.centre);
    this.camera.position.copy(this.controls.target).addScaledVector(away.normalize(), this.span);
    this.camera.zoom = other.camera.zoom;
    this.following = true;
    this.controls.update();
    this.following = false;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  setColours({background, line}) {
    this.spheres.material.uniforms.background.value.set(...background.map((c) => c / 255));
    this.frameLines.material.color.setRGB(...line.map((c) => c / 255), SRGBColorSpace);
    this.renderer.setClearColor(new Color().setRGB(...background.map((c) => c / 255), SRGBColorSpace));
    this.draw();
  }

  // Spheres whose centre lies beyond `at` along the axis are not drawn.
  setCut(axis, at, from) {
    const normal = [0, 0, 0];
    if (axis >= 0) normal[axis] = from;
    this.spheres.material.uniforms.cut.value.set(...normal, axis >= 0 ? at * from : 1);
    this.draw();
  }

  draw() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    this.pending = false;
    if (!this.cell) return;
    const distance = this.camera.position.distanceTo(this.controls.target);
    // Depth in the camera's frame, from the front of the packing to its back.
    this.spheres.material.uniforms.fog.value = [-distance + this.span / 2, this.span * 1.15];
    this.renderer.render(this.scene, this.camera);
  }

  // The frontmost visible sphere at a point of the canvas [CSS pixels from its corner], or -1.
  pick(px, py, position, radii) {
    const {clientWidth: wide, clientHeight: high} = this.canvas;
    const {camera} = this;
    const x = ((px / wide) * 2 - 1) * camera.right / camera.zoom;
    const y = (1 - (py / high) * 2) * camera.top / camera.zoom;
    const cut = this.spheres.material.uniforms.cut.value;
    const view = camera.matrixWorldInverse.elements;
    let best = -1;
    let front = -Infinity;
    for (let i = 0; i < radii.length; ++i) {
      const r = radii[i];
      if (r === 0) continue;
      const [gx, gy, gz] = [position[3 * i], position[3 * i + 1], position[3 * i + 2]];
      if (cut.x * gx + cut.y * gy + cut.z * gz > cut.w) continue;
      const dx = view[0] * gx + view[4] * gy + view[8] * gz + view[12] - x;
      const dy = view[1] * gx + view[5] * gy + view[9] * gz + view[13] - y;
      const inside = r * r - dx * dx - dy * dy;
      if (inside < 0) continue;
      const z = view[2] * gx + view[6] * gy + view[10] * gz + view[14] + Math.sqrt(inside);
      if (z > front) [front, best] = [z, i];
    }
    return best;
  }
}
