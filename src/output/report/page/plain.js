"use strict";
// Deformed bodies without WebGL: values between the corners of triangles, pixel by pixel, so that no background shows between them.

class PlainScene {
  constructor(canvas) {
    this.context = canvas.getContext("2d");
    this.canvas = canvas;
  }

  mesh(places, parts) {
    Object.assign(this, { places, parts });
  }

  frame(moved, values) {
    Object.assign(this, { moved, values });
  }

  colours(map) {
    this.lut = new Uint32Array(Uint8Array.from(lutOf(map)).buffer);
  }

  draw({ view, scale, range, edges }) {
    const { context, canvas, places, moved } = this;
    const { width, height } = canvas;
    const count = places.length / 2;
    const [x, y] = [new Float64Array(count), new Float64Array(count)];
    for (let k = 0; k < count; k++) {
      x[k] = 0.5 * width * (1 + (places[2 * k] + scale * moved[2 * k]) * view[0] + view[2]);
      y[k] = 0.5 * height * (1 - (places[2 * k + 1] + scale * moved[2 * k + 1]) * view[1] - view[3]);
    }
    if (width > 0 && height > 0) {
      const image = context.createImageData(width, height);
      this.fill(new Uint32Array(image.data.buffer), x, y, range);
      context.putImageData(image, 0, 0);
    }
    const lines = (all) => {
      context.beginPath();
      for (let k = 0; k < all.length; k += 2) {
        context.moveTo(x[all[k]], y[all[k]]);
        context.lineTo(x[all[k + 1]], y[all[k + 1]]);
      }
      context.stroke();
    };
    context.lineWidth = 0.6;
    context.strokeStyle = "#40404070";
    if (edges) lines(this.parts.inner);
    context.lineWidth = 1;
    context.strokeStyle = styled("--ink");
    lines(this.parts.outer);
  }

  /** Fills the triangles: in a row of pixels the level is linear. */
  fill(pixels, x, y, [low, high]) {
    const { canvas: { width, height }, values, lut, parts: { triangles } } = this;
    const blank = new Uint32Array(Uint8Array.from([...BLANK, 255]).buffer)[0];
    const share = high > low ? 255 / (high - low) : 0;
    for (let k = 0; k < triangles.length; k += 3) {
      const [a, b, c] = [triangles[k], triangles[k + 1], triangles[k + 2]];
      const [bx, by, cx, cy] = [x[b] - x[a], y[b] - y[a], x[c] - x[a], y[c] - y[a]];
      const area = bx * cy - cx * by;
      if (!area) continue;
      const isBlank = !(isNumber(values[a]) && isNumber(values[b]) && isNumber(values[c]));
      const [l0, l1, l2] = [values[a], values[b], values[c]].map((value) => (value - low) * share);
      const alongX = ((l1 - l0) * cy - (l2 - l0) * by) / area;
      const alongY = ((l2 - l0) * bx - (l1 - l0) * cx) / area;
      const last = Math.min(height - 1, Math.floor(Math.max(y[a], y[b], y[c]) - 0.5));
      for (let j = Math.max(0, Math.ceil(Math.min(y[a], y[b], y[c]) - 0.5)); j <= last; j++) {
        const middle = j + 0.5;
        let [left, right] = [Infinity, -Infinity];
        for (const [p, q] of [[a, b], [b, c], [c, a]]) {
          if ((y[p] <= middle) === (y[q] <= middle)) continue;
          const at = x[p] + ((middle - y[p]) * (x[q] - x[p])) / (y[q] - y[p]);
          left = Math.min(left, at);
          right = Math.max(right, at);
        }
        const end = Math.min(width - 1, Math.floor(right - 0.5));
        for (let i = Math.max(0, Math.ceil(left - 0.5)); i <= end; i++) {
          const level = l0 + (i + 0.5 - x[a]) * alongX + (middle - y[a]) * alongY;
          pixels[j * width + i] = isBlank ? blank : lut[level <= 0 ? 0 : level >= 255 ? 255 : Math.round(level)];
        }
      }
    }
  }

  finish() {}
}
