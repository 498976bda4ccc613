// The scene as triangles, each element in one colour. Input: the model and the values of elements. Output: the picture.

import {
  BufferAttribute, BufferGeometry, Color, DataTexture, FloatType, GLSL3, Mesh, PerspectiveCamera, RedFormat, Scene,
  ShaderMaterial, Vector3, WebGLRenderer,
} from "./three.module.min.js";
import { Orbit } from "./orbit.js";

// Background, as in the written pictures: 0.02 in linear light.
const BACKGROUND = new Color(0.02, 0.02, 0.02);
const WIDTH = 2048; // width of the texture with the values

// Kinds of values: light in linear RGB, or a position on a colour ramp.
export const LIGHT = 0, COLOURS = 1, RAMP = 2;

const VERTEX = `
uniform highp sampler2D values;
uniform int stride, kind;
uniform float exposure;
uniform vec2 range;
uniform vec3 ramp[5], nothing;
in uint element;
in vec4 edges;
flat out vec3 colour;
out vec3 edge, place;

float value(int k) {
  int i = int(element) * stride + k;
  return texelFetch(values, ivec2(i % ${WIDTH}, i / ${WIDTH}), 0).r;
}

// The tone curve of the pictures: linear up to 0.8, then approaching 1.
vec3 tone(vec3 x) {
  return mix(max(x, 0.0), 1.0 - 0.2 * exp(-(x - 0.8) / 0.2), greaterThan(x, vec3(0.8)));
}

vec3 onRamp(float share) {
  if (share <= 0.0) return nothing;
  float t = clamp((log2(share) * 0.30103 - range.x) / (range.y - range.x), 0.0, 1.0) * 4.0;
  int i = min(int(t), 3);
  return mix(ramp[i], ramp[i + 1], t - float(i));
}

void main() {
  if (kind == ${RAMP}) {
    colour = onRamp(value(0));
  } else {
    vec3 v = vec3(value(0), value(1), value(2));
    // Unknown values are stored as the least f32.
    bool known = all(greaterThan(v, vec3(-1e37)));
    colour = kind == ${COLOURS} ? v : known ? tone(exposure * v / 3.14159265) : nothing;
  }
  edge = edges.xyz;
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  place = seen.xyz;
  gl_Position = projectionMatrix * seen;
}`;

const FRAGMENT = `
uniform int kind;
uniform float lines;
flat in vec3 colour;
in vec3 edge, place;
out vec4 pixel;

void main() {
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  // Light is shown unshaded; colours that only distinguish elements are shaded to make shapes visible.
  vec3 shown = kind == ${LIGHT} ? colour : colour * (0.45 + 0.55 * abs(normal.z));
  vec3 width = fwidth(edge);
  vec3 inside = clamp(edge / max(1.3 * width, vec3(1e-6)), 0.0, 1.0);
  float line = 1.0 - min(inside.x, min(inside.y, inside.z));
  // Where elements are about as small as pixels, lines would cover everything.
  line *= lines * clamp(1.6 - 3.0 * max(width.x, max(width.y, width.z)), 0.0, 1.0);
  vec3 drawn = dot(shown, vec3(0.3, 0.6, 0.1)) > 0.12 ? vec3(0.01) : vec3(0.25);
  shown = mix(shown, drawn, line);
  pixel = vec4(mix(12.92 * shown, 1.055 * pow(shown, vec3(1.0 / 2.4)) - 0.055, greaterThan(shown, vec3(0.0031308))), 1.0);
}`;

export class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.scene = new Scene();
    this.scene.background = BACKGROUND;
    this.camera = new PerspectiveCamera();
    this.orbit = new Orbit(canvas, this.camera, () => this.draw());
    this.material = new ShaderMaterial({
      vertexShader: VERTEX, fragmentShader: FRAGMENT, glslVersion: GLSL3,
      uniforms: {
        values: { value: null }, stride: { value: 3 }, kind: { value: LIGHT }, exposure: { value: 1 }, lines: { value: 0 },
        range: { value: [-3, 0] }, ramp: { value: Array.from({ length: 5 }, () => new Color()) }, nothing: { value: new Color() },
      },
    });
    new ResizeObserver(() => this.resize()).observe(canvas);
  }

  // Read the bytes of `model`. The camera keeps its position, unless this is the first model.
  load(buffer) {
    const length = new DataView(buffer).getUint32(0, true);
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
    const corners = new Float32Array(buffer, 4 + length, 12 * head.elements);
    this.instances = new Uint32Array(buffer, 4 + length + corners.byteLength, head.elements);
    const before = this.head;
    this.head = head;
    this.mesh?.geometry.dispose();
    this.mesh?.removeFromParent();
    this.mesh = new Mesh(triangles(corners, head.elements), this.material);
    this.mesh.frustumCulled = false;
    this.mesh.visible = false;
    this.scene.add(this.mesh);
    [this.camera.near, this.camera.far] = [1e-3 * head.radius, 100 * head.radius];
    if (before) this.orbit.shift(before.centre.map((x, axis) => x - head.centre[axis]));
    else this.orbit.stand(head.eye, head.target);
    this.orbit.home = [head.eye, head.target];
    this.resize();
  }

  // Show these values, `stride` for each element.
  show(values, stride, kind) {
    const uniforms = this.material.uniforms;
    let texture = uniforms.values.value;
    const rows = Math.max(Math.ceil(values.length / WIDTH), 1);
    if (texture?.image.height !== rows) {
      texture?.dispose();
      texture = new DataTexture(new Float32Array(WIDTH * rows), WIDTH, rows, RedFormat, FloatType);
      uniforms.values.value = texture;
    }
    texture.image.data.set(values);
    texture.needsUpdate = true;
    uniforms.stride.value = stride;
    uniforms.kind.value = kind;
    if (this.mesh) this.mesh.visible = true;
    this.draw();
  }

  // Colours of a ramp between the powers of ten `from` and `to`, and the colour of zero; sRGB.
  setRamp(colours, nothing, [from, to]) {
    const uniforms = this.material.uniforms;
    uniforms.ramp.value.forEach((colour, i) => colour.set(colours[i]));
    uniforms.nothing.value.set(nothing);
    uniforms.range.value = [from, to];
  }

  set exposure(factor) {
    this.material.uniforms.exposure.value = factor;
    this.canvas.dataset.exposure = factor;
    this.draw();
  }

  set lines(share) {
    this.material.uniforms.lines.value = share;
    this.draw();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    const { fov = 0.7, aspect = 4 / 3 } = this.head ?? {};
    // A canvas that is narrower than the picture still shows all of the picture.
    const half = Math.tan(fov / 2) * Math.max(1, aspect / this.camera.aspect);
    this.camera.fov = (360 / Math.PI) * Math.atan(half);
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  // Draw once before the next frame.
  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.renderer.render(this.scene, this.camera);
    });
  }
}

// One or two triangles for each element. `edges` are their barycentric coordinates, with 1 for a side that is not an edge.
function triangles(corners, elements) {
  const most = 6 * elements;
  const [position, element, edges] = [new Float32Array(3 * most), new Uint32Array(most), new Uint8Array(4 * most)];
  let count = 0;
  const add = (number, corner, edge) => {
    const from = 12 * number + 3 * corner;
    position.set(corners.subarray(from, from + 3), 3 * count);
    element[count] = number;
    edges.set(edge, 4 * count);
    count += 1;
  };
  for (let number = 0; number < elements; number += 1) {
    const isQuad = [0, 1, 2].some((axis) => corners[12 * number + 6 + axis] !== corners[12 * number + 9 + axis]);
    const diagonal = isQuad ? 255 : 0;
    add(number, 0, [255, diagonal, 0, 0]);
    add(number, 1, [0, 255, 0, 0]);
    add(number, 2, [0, diagonal, 255, 0]);
    if (!isQuad) continue;
    add(number, 0, [255, 0, 255, 0]);
    add(number, 2, [0, 255, 255, 0]);
    add(number, 3, [0, 0, 255, 0]);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(position.subarray(0, 3 * count), 3));
  geometry.setAttribute("element", new BufferAttribute(element.subarray(0, count), 1));
  geometry.setAttribute("edges", new BufferAttribute(edges.subarray(0, 4 * count), 4, true));
  return geometry;
}
