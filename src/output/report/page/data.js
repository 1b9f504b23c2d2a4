"use strict";
// The numbers of the page: text → bytes → arrays, when they are asked for, kept as long as there is room.

const DATA = JSON.parse(document.getElementById("data").textContent);
const NUMBERS = document.getElementById("numbers").textContent;
const ARRAYS = { f64: Float64Array, f32: Float32Array, i32: Int32Array, u32: Uint32Array, u8: Uint8Array };

/** Unpacked arrays by where they start, the last used at the end; bytes in all. */
const kept = new Map();
let keptBytes = 0;
const ROOM = 600e6;

function decoded(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let k = 0; k < binary.length; k++) bytes[k] = binary.charCodeAt(k);
  return bytes;
}

/** Bytes sorted by weight, put together again. */
function joined(bytes, type) {
  const size = ARRAYS[type].BYTES_PER_ELEMENT;
  if (size === 1) return bytes;
  const count = bytes.length / size;
  const out = new Uint8Array(bytes.length);
  for (let i = 0; i < size; i++) {
    const from = i * count;
    for (let k = 0, to = i; k < count; k++, to += size) out[to] = bytes[from + k];
  }
  return new ARRAYS[type](out.buffer);
}

/** Numbers in whole steps, of which there is the difference from the point before. */
function summed(differences, step, components) {
  const last = new Array(components).fill(0);
  return Float32Array.from(differences, (difference, k) =>
    difference === NO_STEPS ? NaN : step * (last[k % components] += difference));
}
const NO_STEPS = -(2 ** 31);

/** The array of a chunk, if it is at hand. */
function peek(chunk) {
  const entry = chunk && kept.get(chunk[0]);
  return entry && entry.array;
}

/** The array of a chunk. */
function unpack(chunk, type = "f32") {
  const [start, length, step, components] = chunk;
  const known = kept.get(start);
  if (known) {
    kept.delete(start);
    kept.set(start, known);
    return known.promise;
  }
  const entry = { array: null, promise: null };
  entry.promise = (async () => {
    const stream = new Blob([decoded(NUMBERS.slice(start, start + length))]).stream();
    const bytes = await new Response(stream.pipeThrough(new DecompressionStream("deflate-raw"))).arrayBuffer();
    const packed = new Uint8Array(bytes);
    entry.array = step ? summed(joined(packed, "i32"), step, components) : joined(packed, type);
    keptBytes += entry.array.byteLength;
    for (const [oldest, { array }] of kept) {
      if (keptBytes <= ROOM || oldest === start) break;
      if (array) keptBytes -= array.byteLength;
      kept.delete(oldest);
    }
    return entry.array;
  })();
  kept.set(start, entry);
  return entry.promise;
}

/** A table: its columns by name, words in the place of their numbers. */
async function table(packed) {
  if (!packed) return null;
  const all = await Promise.all(packed.columns.map((column) => unpack(column.chunk, column.type)));
  const columns = new Map();
  packed.columns.forEach((column, k) => {
    columns.set(column.name, column.words ? Array.from(all[k], (word) => column.words[word]) : all[k]);
  });
  return { rows: packed.rows, names: packed.columns.map((column) => column.name), get: (name) => columns.get(name) };
}

/** Label of a unit by its name, as the case has it or made of those that it has. */
const unitOf = (of) => DATA.labels.units[of] || "";

/** Label of the unit of a quantity, and what it is called. */
const fieldUnit = (name) => DATA.labels.quantities[name]?.[0] || "";
const spoken = (name) => DATA.labels.quantities[name]?.[1] || (name.startsWith("d(") ? name : name.replaceAll("_", " "));
