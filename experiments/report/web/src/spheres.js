// SPDX-License-Identifier: GPL-3.0-or-later
// Spheres as squares that face the camera, with the sphere's depth and shade in each pixel: exact
// without perspective, and fast for 18200 grains.
import {
  BufferAttribute, BufferGeometry, GLSL3, InstancedBufferAttribute, InstancedBufferGeometry, Mesh,
  RawShaderMaterial, Vector3, Vector4
} from "three";

const vertexShader = `
precision highp float;
uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
uniform vec4 cut;
in vec2 corner;
in vec3 centre;
in vec3 colour;
in float radius;
out vec2 place;
out vec3 tint;
out float depth;
out float size;
void main() {
  bool hidden = radius == 0.0 || dot(cut.xyz, centre) > cut.w;
  vec4 eye = viewMatrix * vec4(centre, 1.0);
  place = corner * 1.06;  // room for a smooth edge
  tint = colour;
  depth = eye.z;
  size = radius;
  eye.xy += place * radius;
  gl_Position = hidden ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * eye;
}`;

const fragmentShader = `
precision highp float;
uniform mat4 projectionMatrix;
uniform vec3 light;
uniform vec3 background;
uniform vec2 fog;
in vec2 place;
in vec3 tint;
in float depth;
in float size;
out vec4 shade;
void main() {
  float r = length(place);
  float edge = fwidth(r);
  float inside = 1.0 - smoothstep(1.0 - edge, 1.0, r);
  if (inside <= 0.0) discard;
  float height = sqrt(max(0.0, 1.0 - r * r));
  float z = depth + size * height;
  float clip = projectionMatrix[2][2] * z + projectionMatrix[3][2];
  gl_FragDepth = 0.5 * clip + 0.5;
  vec3 normal = vec3(place, height);
  float lit = 0.56 + 0.5 * max(0.0, dot(normal, light));
  float gleam = 0.16 * pow(max(0.0, dot(normal, normalize(light + vec3(0.0, 0.0, 1.0)))), 30.0);
  float rim = mix(0.45, 1.0, smoothstep(0.0, 0.32, height));
  vec3 colour = tint * lit * rim + gleam;
  float far = clamp((fog.x - z) / fog.y, 0.0, 1.0);
  shade = vec4(mix(colour, background, 0.5 * far), inside);
}`;

export class Spheres {
  constructor() {
    this.material = new RawShaderMaterial({
      glslVersion: GLSL3, vertexShader, fragmentShader, alphaToCoverage: true,
      uniforms: {
        cut: {value: new Vector4(0, 0, 0, 1)},
        light: {value: new Vector3(-0.45, 0.6, 0.66).normalize()},
        background: {value: new Vector3(1, 1, 1)},
        fog: {value: [0, 1]}
      }
    });
    this.mesh = new Mesh(new BufferGeometry(), this.material);
    this.mesh.frustumCulled = false;
  }

  setPositions(position) {
    const geometry = new InstancedBufferGeometry();
    const corners = new Float32Array([-1, -1, 1, -1, 1, 1, -1, -1, 1, 1, -1, 1]);
    geometry.setAttribute("corner", new BufferAttribute(corners, 2));
    geometry.setAttribute("centre", new InstancedBufferAttribute(position, 3));
    geometry.instanceCount = position.length / 3;
    geometry.setDrawRange(0, 6);  // else three looks for an attribute "position" to count
    this.mesh.geometry.dispose();
    this.mesh.geometry = geometry;
  }

  setColours(bytes) {
    this.mesh.geometry.setAttribute("colour", new InstancedBufferAttribute(bytes, 3, true));
  }

  setRadii(radii) {
    this.mesh.geometry.setAttribute("radius", new InstancedBufferAttribute(radii, 1));
  }
}
