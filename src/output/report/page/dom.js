"use strict";
// Small helpers: elements, numbers as they are read, ticks.

/** An element with its attributes and children; texts are never read as HTML. */
function el(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value != null) element.setAttribute(name, value);
  }
  element.append(...children.flat().filter((child) => child != null));
  return element;
}

/** A button. */
const button = (text, title, onclick) => el("button", { type: "button", title, "aria-label": title, onclick }, text);

/** A choice with a label: options are [value, text]. */
function choice(label, options, value, onchange) {
  const select = el("select", { onchange: () => onchange(select.value) });
  for (const [key, text] of options) select.append(el("option", { value: key, selected: key === value }, text));
  return Object.assign(el("label", {}, label + " ", select), { select });
}

/** A check box with a label. */
function check(label, checked, onchange) {
  const box = el("input", { type: "checkbox", checked, onchange: () => onchange(box.checked) });
  return Object.assign(el("label", { class: "check" }, box, " " + label), { box });
}

/** A number with so many digits, in powers of ten where it is very large or small. */
function told(value, digits = 5) {
  if (value === 0) return "0";
  if (value == null || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const whole = Math.max(digits, Math.floor(Math.log10(size)) + 1);
  const text = size < 1e-3 || size >= 1e6 ? value.toExponential(digits - 1) : value.toPrecision(whole);
  return text.replace(/(\.\d*?)0+(e|$)/, "$1$2").replace(/\.(e|$)/, "$1").replace("e+", "e").replace("-", "−");
}

/** A quantity with its unit in brackets, if that is known. */
const withUnit = (name, unit) => (unit ? `${name} [${unit}]` : name);

/** Round values between two numbers, about so many. */
function ticks(low, high, count) {
  const span = high - low;
  if (!(span > 0)) return [low];
  const rough = span / Math.max(1, count);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((k) => k * power).find((size) => size >= rough * 0.999);
  const all = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * span; k++) all.push(k * step);
  return all.map((value) => (Math.abs(value) < 1e-9 * step ? 0 : value));
}

/** Texts of ticks: as many digits as tell them apart. */
function tickTexts(values) {
  const step = values.length > 1 ? Math.abs(values[1] - values[0]) : Math.abs(values[0]) || 1;
  const size = Math.max(...values.map(Math.abs), step);
  const digits = Math.min(12, Math.max(2, Math.ceil(Math.log10(size / step)) + 2));
  return values.map((value) => told(value, digits));
}

/** Index of the value nearest to another in an ascending array. */
function nearest(ascending, value) {
  let [low, high] = [0, ascending.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (ascending[middle] < value) low = middle;
    else high = middle;
  }
  return Math.abs(ascending[low] - value) <= Math.abs(ascending[high] - value) ? low : high;
}

/** Lowest and highest number of an array. */
function bounds(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low && value > -Infinity) low = value;
    if (value > high && value < Infinity) high = value;
  }
  return low <= high ? [low, high] : [0, 0];
}

/** Two numbers between which nearly all of an array lies, but for a fiftieth at either end: zeros, where nothing happens, are
 * between them and do not count. */
function most(values) {
  const step = Math.ceil(values.length / 100000);
  const sorted = values.filter((value, k) => k % step === 0 && Number.isFinite(value) && value !== 0).sort();
  const at = (share) => sorted[Math.round(share * (sorted.length - 1))] ?? 0;
  const zero = values.includes(0) ? [0] : [];
  return [Math.min(at(0.02), ...zero), Math.max(at(0.98), ...zero)];
}

/** Texts of a range of colours, which may go on beyond its ends. */
function rangeTexts([low, high], [lowest, highest]) {
  const texts = tickTexts([0, 0.25, 0.5, 0.75, 1].map((share) => low + share * (high - low)));
  if (lowest < low) texts[0] = `≤ ${texts[0]}`;
  if (highest > high) texts[4] = `≥ ${texts[4]}`;
  return texts;
}

/** The time that is looked at, in all parts of the page. */
const now = {
  time: null,
  listeners: [],
  set(time, from) {
    if (!Number.isFinite(time)) return;
    this.time = time;
    for (const listener of this.listeners) if (listener.from !== from) listener.heard(time);
  },
  hear(from, heard) {
    this.listeners.push({ from, heard });
  },
};

/** A colour of the page's style. */
const styled = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
