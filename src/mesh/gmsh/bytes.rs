//! A gmsh file as bytes: what is checked before it is parsed.

use std::collections::HashMap;
use std::ops::Range;

use memchr::memmem;

use crate::mesh::MeshError;

/// How the numbers are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// From the first two lines, `$MeshFormat` and `4.1 (0 ASCII | 1 binary) 8`; in a binary file an integer 1 follows.
pub(super) fn encoding(bytes: &[u8]) -> Result<Encoding, MeshError> {
    let mut lines = bytes.splitn(3, |&b| b == b'\n');
    if lines.next().map(<[u8]>::trim_ascii) != Some(b"$MeshFormat") {
        return Err(MeshError::NotGmsh);
    }
    let line = String::from_utf8_lossy(lines.next().unwrap_or_default().trim_ascii()).into_owned();
    let one = lines.next().and_then(|rest| rest.first_chunk::<4>()).copied().unwrap_or_default();
    let words: Vec<&str> = line.split_whitespace().collect();
    match words[..] {
        ["4.1", "0", "8"] => Ok(Encoding::Ascii),
        ["4.1", "1", "8"] if i32::from_le_bytes(one) == 1 => Ok(Encoding::LittleEndian),
        ["4.1", "1", "8"] if i32::from_be_bytes(one) == 1 => Ok(Encoding::BigEndian),
        [version, _, _] if version != "4.1" && version.parse::<f64>().is_ok() => {
            Err(MeshError::Version(version.into()))
        }
        _ => Err(MeshError::Format(line.chars().take(40).collect())),
    }
}

/// Where the content of a section lies, if the file has it.
fn section(bytes: &[u8], name: &'static str) -> Result<Option<Range<usize>>, MeshError> {
    let after_line = |from: usize, wanted: &str| {
        let mut end = from;
        bytes[from..].split_inclusive(|&b| b == b'\n').find_map(|line| {
            end += line.len();
            (line.trim_ascii() == wanted.as_bytes()).then_some(end - line.len()..end)
        })
    };
    let Some(begin) = after_line(0, &format!("${name}")) else { return Ok(None) };
    let end = after_line(begin.end, &format!("$End{name}")).ok_or(MeshError::Truncated(name))?;
    Ok(Some(begin.end..end.start))
}

/// A section that the file must have, and once: what is checked in one would be read from another.
fn required_section(bytes: &[u8], name: &'static str) -> Result<Range<usize>, MeshError> {
    let range = section(bytes, name)?.ok_or(MeshError::NoSection(name))?;
    let title = format!("${name}");
    let ends = memmem::find_iter(bytes, &title).map(|start| bytes.get(start + title.len()));
    if ends.filter(|next| next.is_none_or(u8::is_ascii_whitespace)).count() > 1 {
        return Err(MeshError::Malformed { at: title, what: "the file has this section more than once".into() });
    }
    Ok(range)
}

/// The number of nodes or elements that a section's header claims (of curves, for the entities).
///
/// Refuses counts that the file is too small for. Only the counts are looked at: tags follow them in the header of the
/// nodes and elements, and they may be anything.
pub(super) fn checked_count(bytes: &[u8], encoding: Encoding, name: &'static str) -> Result<u64, MeshError> {
    let content = &bytes[required_section(bytes, name)?];
    let counts = leading_numbers(content, encoding, if name == "Entities" { 4 } else { 2 });
    // The shortest entry, an element in ASCII, is four bytes long.
    if let Some(&claimed) = counts.iter().find(|&&count| count > bytes.len() as u64 / 4) {
        return Err(MeshError::ImpossibleCount { section: name, claimed, bytes: bytes.len() });
    }
    counts.get(1).copied().ok_or_else(|| MeshError::Malformed {
        at: format!("${name}"),
        what: "the section does not begin with its counts".into(),
    })
}

/// Up to `count` unsigned numbers at the beginning; fewer if something else stands there.
fn leading_numbers(content: &[u8], encoding: Encoding, count: usize) -> Vec<u64> {
    let binary = |convert: fn([u8; 8]) -> u64| content.as_chunks().0.iter().take(count).map(|&b| convert(b)).collect();
    match encoding {
        Encoding::LittleEndian => binary(u64::from_le_bytes),
        Encoding::BigEndian => binary(u64::from_be_bytes),
        Encoding::Ascii => content
            .split(u8::is_ascii_whitespace)
            .filter(|word| !word.is_empty())
            .take(count)
            .map_while(|word| std::str::from_utf8(word).ok()?.parse().ok())
            .collect(),
    }
}

/// Makes `mshio` keep every node's tag.
///
/// It drops the tags when the header says that they leave no gaps, as if they then came in ascending order, which the
/// format does not promise. So the header is made to announce one single node; the true number is checked afterwards.
pub(super) fn keep_node_tags(bytes: &mut [u8], encoding: Encoding) -> Result<(), MeshError> {
    let range = required_section(bytes, "Nodes")?;
    let content = &mut bytes[range];
    match encoding {
        Encoding::Ascii => {
            let mut words = content.split_mut(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
            if let Some([first, rest @ ..]) = words.nth(1) {
                *first = b'1';
                rest.fill(b' ');
            }
        }
        Encoding::LittleEndian => overwrite_second(content, 1u64.to_le_bytes()),
        Encoding::BigEndian => overwrite_second(content, 1u64.to_be_bytes()),
    }
    Ok(())
}

fn overwrite_second(content: &mut [u8], number: [u8; 8]) {
    if let Some(second) = content.as_chunks_mut().0.get_mut(1) {
        *second = number;
    }
}

/// Names of the physical groups by (dimension, tag).
pub(super) type Names = HashMap<(i32, u32), String>;

/// The section of names, which is text even in binary files.
pub(super) fn physical_names(bytes: &[u8]) -> Result<Names, MeshError> {
    let Some(range) = section(bytes, "PhysicalNames")? else { return Ok(Names::new()) };
    let text = String::from_utf8_lossy(&bytes[range]);
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty()).skip(1);
    lines.map(|line| physical_name(line).ok_or_else(|| bad_name(line))).collect()
}

/// `dimension tag "name"`
fn physical_name(line: &str) -> Option<((i32, u32), String)> {
    let (dimension, rest) = line.split_once(char::is_whitespace)?;
    let (tag, name) = rest.trim_start().split_once(char::is_whitespace)?;
    let name = name.trim().strip_prefix('"')?.strip_suffix('"')?;
    Some(((dimension.parse().ok()?, tag.parse().ok()?), name.into()))
}

fn bad_name(line: &str) -> MeshError {
    MeshError::Malformed {
        at: "$PhysicalNames".into(),
        what: format!("`{}` is not of the form: dimension tag \"name\"", line.chars().take(80).collect::<String>()),
    }
}

/// What stands where the parser gave up without a word.
fn unexpected(bytes: &[u8], offset: usize, encoding: Encoding) -> String {
    if encoding != Encoding::Ascii {
        return "the numbers there are not those that the format has at this place".into();
    }
    let begin = bytes[..offset.min(bytes.len())].iter().rposition(|&b| b == b'\n').map_or(0, |end| end + 1);
    let line = bytes[begin..].split(|&b| b == b'\n').next().unwrap_or_default();
    let line: String = String::from_utf8_lossy(line).trim().chars().take(80).collect();
    match line.is_empty() {
        true => "the line is empty, where the format has numbers".into(),
        false => format!("`{line}` has more, fewer or other entries than the format has there"),
    }
}

/// The parser's trace of errors (innermost first) in one line, with the place in the file.
pub(super) fn explain(bytes: &[u8], encoding: Encoding, error: &mshio::MshParserError<&[u8]>) -> MeshError {
    let trace: Vec<String> = error.filter_msh_errors().map(|(_, kind)| kind.to_string()).collect();
    if trace.iter().any(|message| message.contains("parametric nodes")) {
        return MeshError::Parametric;
    }
    let rest = error.backtrace.first().map_or(0, |(rest, _)| rest.len());
    let offset = bytes.len().saturating_sub(rest);
    let at = match encoding {
        Encoding::Ascii => format!("line {}", 1 + bytes.iter().take(offset).filter(|&&b| b == b'\n').count()),
        _ => format!("byte {offset}"),
    };
    let told = trace.into_iter().rev().filter(|message| !message.trim().is_empty()).collect::<Vec<_>>().join(", ");
    let what = if told.is_empty() { unexpected(bytes, offset, encoding) } else { told };
    MeshError::Malformed { at, what }
}
