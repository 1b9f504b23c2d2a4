"use strict";
// Deformed bodies on a canvas: by WebGL 2, or pixel by pixel where there is none.

/** Corners of a cell in order with the nodes between them, by VTK's number of its kind. */
const RINGS = { 5: [0, 1, 2], 9: [0, 1, 2, 3], 22: [0, 3, 1, 4, 2, 5], 23: [0, 4, 1, 5, 2, 6, 3, 7], 28: [0, 4, 1, 5, 2, 6, 3, 7] };
/** Triangles of a cell. */
const PARTS = {
  5: [0, 1, 2], 9: [0, 1, 2, 0, 2, 3], 22: [0, 3, 5, 3, 1, 4, 5, 4, 2, 3, 4, 5],
  23: [0, 4, 7, 4, 1, 5, 5, 2, 6, 6, 3, 7, 4, 5, 7, 5, 6, 7],
  28: [0, 4, 8, 0, 8, 7, 4, 1, 5, 4, 5, 8, 8, 5, 2, 8, 2, 6, 7, 8, 6, 7, 6, 3],
};

/** Triangles, edges between elements and outlines of a mesh without some bodies. */
function shapes({ connectivity, ends, kinds, bodies }, points, hidden) {
  const [triangles, rings] = [[], []];
  ends.forEach((_, e) => {
    if (hidden.includes(bodies[e])) return;
    const start = e ? ends[e - 1] : 0;
    for (const k of PARTS[kinds[e]] || []) triangles.push(connectivity[start + k]);
    const ring = RINGS[kinds[e]] || [];
    ring.forEach((k, i) => rings.push(connectivity[start + k], connectivity[start + ring[(i + 1) % ring.length]]));
  });
  const seen = new Map();
  for (let k = 0; k < rings.length; k += 2) {
    const key = Math.min(rings[k], rings[k + 1]) * points + Math.max(rings[k], rings[k + 1]);
    seen.set(key, (seen.get(key) || 0) + 1);
  }
  const [inner, outer] = [[], []];
  for (const [key, count] of seen) (count > 1 ? inner : outer).push(Math.floor(key / points), key % points);
  return { triangles: Uint32Array.from(triangles), inner: Uint32Array.from(inner), outer: Uint32Array.from(outer) };
}

const VERTEX = `#version 300 es
in vec2 place; in vec2 moved; in float value;
uniform vec4 view; uniform float scale; uniform vec2 range;
out float level;
void main() {
  gl_Position = vec4((place + scale * moved) * view.xy + view.zw, 0.0, 1.0);
  level = value > 1e30 ? 1e6 : (value - range.x) * range.y;
}`;
const FRAGMENT = `#version 300 es
precision highp float;
in float level; uniform sampler2D colours; uniform vec4 plain; out vec4 colour;
void main() {
  if (plain.a > 0.0) colour = plain;
  else if (level > 1e4) colour = vec4(0.59, 0.59, 0.59, 1.0);
  else colour = texture(colours, vec2(clamp(level, 0.0, 1.0) * 0.99609375 + 0.001953125, 0.5));
}`;

class WebGLScene {
  constructor(canvas, elements) {
    const gl = canvas.getContext("webgl2", { antialias: elements < 30000, preserveDrawingBuffer: true, alpha: true });
    if (!gl) throw new Error("no WebGL 2");
    this.gl = gl;
    this.canvas = canvas;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    ["place", "moved", "value"].forEach((name, k) => gl.bindAttribLocation(program, k, name));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program) || "WebGL failed");
    gl.useProgram(program);
    this.at = Object.fromEntries(["view", "scale", "range", "plain"].map((name) => [name, gl.getUniformLocation(program, name)]));
    this.buffers = {};
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  }

  fill(name, target, array, use) {
    const { gl } = this;
    if (!this.buffers[name]) this.buffers[name] = gl.createBuffer();
    gl.bindBuffer(target, this.buffers[name]);
    gl.bufferData(target, array, use);
  }

  attribute(name, location, size, array, use) {
    const { gl } = this;
    this.fill(name, gl.ARRAY_BUFFER, array, use);
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, gl.FLOAT, false, 0, 0);
  }

  mesh(places, parts) {
    const { gl } = this;
    this.parts = parts;
    this.attribute("places", 0, 2, places, gl.STATIC_DRAW);
    for (const name of ["triangles", "inner", "outer"]) this.fill(name, gl.ELEMENT_ARRAY_BUFFER, parts[name], gl.STATIC_DRAW);
  }

  frame(moved, values) {
    this.attribute("moved", 1, 2, moved, this.gl.DYNAMIC_DRAW);
    this.attribute("values", 2, 1, values, this.gl.DYNAMIC_DRAW);
  }

  colours(map) {
    const { gl } = this;
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, lutOf(map));
  }

  draw({ view, scale, range, edges, ink }) {
    const { gl, at } = this;
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.uniform4fv(at.view, view);
    gl.uniform1f(at.scale, scale);
    gl.uniform2f(at.range, range[0], range[1] > range[0] ? 1 / (range[1] - range[0]) : 0);
    const pass = (name, kind, plain) => {
      gl.uniform4fv(at.plain, plain);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.buffers[name]);
      gl.drawElements(kind, this.parts[name].length, gl.UNSIGNED_INT, 0);
    };
    pass("triangles", gl.TRIANGLES, [0, 0, 0, 0]);
    if (edges) pass("inner", gl.LINES, [0.25, 0.25, 0.25, 1]);
    pass("outer", gl.LINES, ink);
  }

  /** Wait until it is drawn: for measuring. */
  finish() {
    this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, new Uint8Array(4));
  }
}

/** A scene on a canvas in a place; a canvas that failed at WebGL cannot draw in 2D any more. */
function scene(host, elements) {
  const canvas = () => {
    const made = el("canvas");
    host.prepend(made);
    return made;
  };
  const first = canvas();
  try {
    return new WebGLScene(first, elements);
  } catch {
    first.remove();
    return new PlainScene(canvas());
  }
}
