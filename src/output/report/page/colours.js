"use strict";
// Colours that the colour-blind can tell apart: for values (viridis, cividis; blue to red about zero) and for curves.

const MAPS = {
  viridis: "440154 482475 414487 355f8d 2a788e 21918c 22a884 44bf70 7ad151 bddf26 fde725",
  cividis: "00224e 123570 3b496c 575d6d 707173 8a8678 a59c74 c3b369 e1cc55 fee838",
  "blue–red": "053061 2166ac 4393c3 92c5de d1e5f0 f7f7f7 fddbc7 f4a582 d6604d b2182b 67001f",
  grey: "f4f4f4 c8c8c8 969696 646464 323232 101010",
};

/** What is no number. */
const BLANK = [150, 150, 150];

/** 256 colours of a map, four bytes each. */
const lutOf = (() => {
  const made = new Map();
  return (name) => {
    if (made.has(name)) return made.get(name);
    const points = MAPS[name].split(" ").map((hex) => [0, 2, 4].map((i) => parseInt(hex.slice(i, i + 2), 16)));
    const lut = new Uint8Array(1024);
    for (let k = 0; k < 256; k++) {
      const at = (k / 255) * (points.length - 1);
      const i = Math.min(Math.floor(at), points.length - 2);
      for (let c = 0; c < 3; c++) lut[4 * k + c] = Math.round(points[i][c] + (at - i) * (points[i + 1][c] - points[i][c]));
      lut[4 * k + 3] = 255;
    }
    made.set(name, lut);
    return lut;
  };
})();

/** Colours and dashes of curves (Okabe and Ito). */
const CURVES = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c6d46"];
const DASHES = [[], [8, 4], [2, 3], [10, 3, 2, 3], [4, 4]];
const curveColour = (k) => CURVES[k % CURVES.length];
const dash = (k) => DASHES[k % DASHES.length];

/** A colour bar that says what its colours mean. */
class ColourBar {
  constructor() {
    this.canvas = el("canvas", { width: 256, height: 1, class: "bar", role: "img" });
    this.texts = el("div", { class: "bar-texts" });
    this.title = el("div", { class: "bar-title" });
    this.element = el("div", { class: "colour-bar" }, this.title, this.canvas, this.texts);
  }

  show(title, texts, map) {
    const context = this.canvas.getContext("2d");
    context.putImageData(new ImageData(new Uint8ClampedArray(lutOf(map)), 256, 1), 0, 0);
    this.canvas.setAttribute("aria-label", `colours from ${texts[0]} to ${texts[texts.length - 1]}`);
    this.title.textContent = title;
    this.texts.replaceChildren(...texts.map((text) => el("span", {}, text)));
    this.shown = { title, texts };
  }

  /** The same in a picture, so wide. */
  paint(context, x, width) {
    const { title, texts } = this.shown;
    context.fillStyle = context.strokeStyle = styled("--ink");
    context.textAlign = "left";
    context.fillText(title, x, 10);
    context.drawImage(this.canvas, x, 15, width, 13);
    context.strokeRect(x, 15, width, 13);
    context.textAlign = "center";
    texts.forEach((text, k) => context.fillText(text, x + (k / (texts.length - 1)) * width, 42));
  }
}
