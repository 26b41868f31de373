// SPDX-License-Identifier: GPL-3.0-or-later
// The view of one packing: spheres, the tilted cell, a camera without perspective. The picture is drawn only when
// something changes.
import {
  BoxGeometry, BufferAttribute, BufferGeometry, Color, EdgesGeometry, GLSL3, InstancedBufferAttribute,
  InstancedBufferGeometry, LineBasicMaterial, LineSegments, Matrix4, Mesh, OrthographicCamera, Raycaster,
  RawShaderMaterial, Scene, Sphere, SRGBColorSpace, Vector2, Vector3, WebGLRenderer
} from "three";
import {OrbitControls} from "three/examples/jsm/controls/OrbitControls.js";

// A sphere is drawn as a square that faces the camera, with the depth and shade of the sphere in each pixel. This is
// exact for a camera without perspective, and fast for 18200 grains.
const vertexShader = `
precision highp float;
uniform mat4 viewMatrix, projectionMatrix;
in vec2 corner;
in vec4 sphere;  // centre and radius
in vec3 colour;
out vec2 place;
out vec3 tint;
out vec2 depth;  // of the centre, and the radius
void main() {
  vec4 eye = viewMatrix * vec4(sphere.xyz, 1.0);
  place = corner * 1.06;  // room for a smooth edge
  tint = colour;
  depth = vec2(eye.z, sphere.w);
  eye.xy += place * sphere.w;
  gl_Position = projectionMatrix * eye;
}`;
const fragmentShader = `
precision highp float;
uniform mat4 projectionMatrix;
uniform vec3 background;
uniform vec2 fog;
in vec2 place;
in vec3 tint;
in vec2 depth;
out vec4 shade;
void main() {
  float r = length(place);
  float edge = fwidth(r);
  float inside = 1.0 - smoothstep(1.0 - edge, 1.0, r);
  if (inside <= 0.0) discard;
  vec3 normal = vec3(place, sqrt(max(0.0, 1.0 - r * r)));
  float z = depth.x + depth.y * normal.z;
  gl_FragDepth = 0.5 * (projectionMatrix[2][2] * z + projectionMatrix[3][2]) + 0.5;
  float lit = 0.56 + 0.5 * max(0.0, dot(normal, vec3(-0.445, 0.594, 0.670)));
  vec3 colour = tint * lit * mix(0.45, 1.0, smoothstep(0.0, 0.32, normal.z));
  shade = vec4(mix(colour, background, 0.5 * clamp((fog.x - z) / fog.y, 0.0, 1.0)), inside);
}`;

const firstDirection = new Vector3(0.5, 0.28, 1).normalize();

// Edges of the sheared box. The side walls tilt about axes at the height of the top wall.
function cellEdges({width, depth, bottom, top, tan_theta: tilt}) {
  const box = new BoxGeometry(width, top - bottom, depth);
  box.translate(width / 2, (bottom + top) / 2, depth / 2);
  const shear = new Matrix4().set(1, tilt, 0, -tilt * top, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);
  return new EdgesGeometry(box).applyMatrix4(shear);
}

export class PackingScene {
  // Throws if the browser has no WebGL 2. `turned` is called when the reader turns, moves or zooms the view.
  constructor(canvas, turned) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({canvas, antialias: true, alpha: false});
    this.camera = new OrthographicCamera();
    this.scene = new Scene();
    this.frameLines = new LineSegments(new BufferGeometry(), new LineBasicMaterial());
    this.spheres = new Mesh(new BufferGeometry(), new RawShaderMaterial({
      glslVersion: GLSL3, vertexShader, fragmentShader, alphaToCoverage: true,
      uniforms: {background: {value: new Vector3()}, fog: {value: [0, 1]}}
    }));
    this.spheres.frustumCulled = false;
    this.scene.add(this.spheres, this.frameLines);
    this.controls = new OrbitControls(this.camera, canvas);
    Object.assign(this.controls, {minZoom: 0.2, maxZoom: 40});
    // If the canvas does not have the focus, the wheel scrolls the page. A finger that moves up or down always scrolls
    // the page.
    this.controls.enableZoom = false;
    canvas.addEventListener("focus", () => (this.controls.enableZoom = true));
    canvas.addEventListener("blur", () => (this.controls.enableZoom = false));
    canvas.style.touchAction = "pan-y";
    this.controls.addEventListener("change", () => {
      this.draw();
      if (!this.following) turned();
    });
    canvas.addEventListener("webglcontextrestored", () => this.draw());
  }

  setCell(cell, keepView) {
    this.frameLines.geometry.dispose();
    this.frameLines.geometry = cellEdges(cell);
    this.cell = cell;
    if (!keepView) this.resetView();
  }

  // `spheres`: x, y, z and radius of each sphere. `colours`: three bytes for each sphere. A sphere of radius 0 is
  // invisible.
  setSpheres(spheres, colours) {
    const geometry = new InstancedBufferGeometry();
    const corners = new Float32Array([-1, -1, 1, -1, 1, 1, -1, -1, 1, 1, -1, 1]);
    geometry.setAttribute("corner", new BufferAttribute(corners, 2));
    geometry.setAttribute("sphere", new InstancedBufferAttribute(spheres, 4));
    geometry.setAttribute("colour", new InstancedBufferAttribute(colours, 3, true));
    geometry.setDrawRange(0, 6);  // otherwise three.js counts the vertices in an attribute "position"
    this.spheres.geometry.dispose();
    this.spheres.geometry = geometry;
    this.data = spheres;
    this.draw();
  }

  resetView() {
    const {width, depth, bottom, top} = this.cell;
    this.span = Math.hypot(width, depth, top - bottom);
    this.centre = new Vector3(width / 2, (bottom + top) / 2, depth / 2);
    this.controls.target.copy(this.centre);
    this.camera.position.copy(this.centre).addScaledVector(firstDirection, this.span);
    Object.assign(this.camera, {near: -2 * this.span, far: 4 * this.span, zoom: 1});
    this.controls.update();
    this.fit();
  }

  // Scales the view so that the packing fills a canvas of any shape.
  fit() {
    const {clientWidth: wide, clientHeight: high} = this.canvas;
    if (!this.cell || wide === 0 || high === 0) return;
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.setSize(wide, high, false);
    const {width, depth, bottom, top} = this.cell;
    const tall = (top - bottom) * 0.5 + depth * 0.16 + 1.5;
    const across = (width * 0.9 + depth * 0.45) * 0.5 + 1.5;
    const scale = Math.max(tall, across * high / wide);
    const side = scale * wide / high;
    Object.assign(this.camera, {top: scale, bottom: -scale, right: side, left: -side});
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  turn(horizontal, vertical) {
    this.controls.rotateLeft(horizontal);
    this.controls.rotateUp(vertical);
  }

  nearer(factor) {
    this.controls.dollyIn(1 / factor);
  }

  // Copies the direction, the zoom and the shift of another view.
  lookAs(other) {
    const away = other.camera.position.clone().sub(other.controls.target);
    this.controls.target.copy(other.controls.target).sub(other.centre).add(this.centre);
    this.camera.position.copy(this.controls.target).addScaledVector(away.normalize(), this.span);
    this.camera.zoom = other.camera.zoom;
    this.camera.updateProjectionMatrix();
    this.following = true;
    this.controls.update();
    this.following = false;
    this.draw();
  }

  setColours({background, ink}) {
    const colour = (channels) => new Color().setRGB(...channels.map((c) => c / 255), SRGBColorSpace);
    this.frameLines.material.color = colour(ink);
    this.renderer.setClearColor(colour(background));
    this.spheres.material.uniforms.background.value.set(...background.map((c) => c / 255));
    this.draw();
  }

  draw() {
    this.pending ??= requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    this.pending = null;
    if (!this.cell) return;
    // Depth in the camera's frame, from the front of the packing to its back.
    const distance = this.camera.position.distanceTo(this.controls.target);
    this.spheres.material.uniforms.fog.value = [this.span / 2 - distance, this.span * 1.15];
    this.renderer.render(this.scene, this.camera);
  }

  // The index of the front visible sphere at a point of the canvas, or -1. The point is in CSS pixels from the top left
  // corner.
  pick(px, py) {
    const {clientWidth: wide, clientHeight: high} = this.canvas;
    const caster = new Raycaster();
    caster.setFromCamera(new Vector2((px / wide) * 2 - 1, 1 - (py / high) * 2), this.camera);
    const [sphere, at] = [new Sphere(), new Vector3()];
    let [best, least] = [-1, Infinity];
    for (let i = 0; i < this.data.length / 4; ++i) {
      sphere.center.fromArray(this.data, 4 * i);
      sphere.radius = this.data[4 * i + 3];
      if (sphere.radius === 0 || !caster.ray.intersectSphere(sphere, at)) continue;
      const distance = at.distanceToSquared(caster.ray.origin);
      if (distance < least) [best, least] = [i, distance];
    }
    return best;
  }
}
