//! A store of zarr version 2, read by the words of its specification. It shares nothing with the program but the inflating of
//! zlib.
#![allow(dead_code, reason = "each test program uses a part")]

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

fn described(path: &Path) -> Value {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Shape and values of an array; what stands in `.zmetadata` must be what stands beside it.
pub fn array(store: &Path, name: &str) -> (Vec<usize>, Vec<f64>) {
    let folder = store.join(name);
    let is = described(&folder.join(".zarray"));
    let consolidated = described(&store.join(".zmetadata"));
    assert_eq!(consolidated["metadata"][format!("{name}/.zarray")], is, "{name}");
    chunked(&folder, &is)
}

/// The same by `.zmetadata` alone, as xarray reads.
pub fn consolidated(store: &Path, name: &str) -> (Vec<usize>, Vec<f64>) {
    let consolidated = described(&store.join(".zmetadata"));
    chunked(&store.join(name), &consolidated["metadata"][format!("{name}/.zarray")])
}

fn chunked(folder: &Path, is: &Value) -> (Vec<usize>, Vec<f64>) {
    let name = folder.display();
    let list = |key: &str| -> Vec<usize> { serde_json::from_value(is[key].clone()).expect("whole numbers") };
    let (shape, chunks) = (list("shape"), list("chunks"));
    let size: usize = is["dtype"].as_str().expect("a type")[2..].parse().expect("a size");
    assert_eq!(is["filters"], json!([{"id": "shuffle", "elementsize": size}]));
    assert_eq!((&is["compressor"]["id"], &is["zarr_format"], &is["order"]), (&json!("zlib"), &json!(2), &json!("C")));
    let width: usize = shape[1..].iter().product();
    assert_eq!(width, chunks[1..].iter().product::<usize>(), "chunks hold whole records");
    let mut values = Vec::new();
    for first in (0..shape[0]).step_by(chunks[0]) {
        let behind = ".0".repeat(shape.len() - 1);
        let packed = fs::read(folder.join(format!("{}{behind}", first / chunks[0]))).expect("a chunk");
        let bytes = miniz_oxide::inflate::decompress_to_vec_zlib(&packed).expect("zlib");
        let count = chunks[0] * width;
        assert_eq!(bytes.len(), count * size, "{name}");
        for k in 0..count.min((shape[0] - first) * width) {
            let own: Vec<u8> = (0..size).map(|byte| bytes[byte * count + k]).collect();
            values.push(match is["dtype"].as_str().expect("a type") {
                "<f4" => f64::from(f32::from_le_bytes(own.try_into().expect("four bytes"))),
                "<f8" => f64::from_le_bytes(own.try_into().expect("eight bytes")),
                "<i4" => f64::from(i32::from_le_bytes(own.try_into().expect("four bytes"))),
                other => panic!("{other}"),
            });
        }
    }
    (shape, values)
}

/// Attributes of an array, or of the store.
pub fn attributes(store: &Path, name: &str) -> Value {
    described(&store.join(name).join(".zattrs"))
}
