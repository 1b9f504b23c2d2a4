//! Fewer points for the same picture.

use std::collections::HashSet;

/// A curve in pixels, broken where points have no place.
pub type Pieces = Vec<Vec<[f64; 2]>>;

/// Break a curve at the points that are not finite.
fn broken(points: impl Iterator<Item = [f64; 2]>) -> Pieces {
    let mut pieces = vec![Vec::new()];
    for point in points {
        match (point.iter().all(|x| x.is_finite()), pieces.last_mut()) {
            (true, Some(piece)) => piece.push(point),
            (false, Some(piece)) if !piece.is_empty() => pieces.push(Vec::new()),
            _ => {}
        }
    }
    pieces.retain(|piece| !piece.is_empty());
    pieces
}

/// A curve with no more than about `most` points that looks the same, as far as so few can: a function of x keeps its
/// extremes in every column of pixels, any other curve a point in every cell it enters and no way gone before.
pub fn thin(points: impl Iterator<Item = [f64; 2]>, most: usize) -> Pieces {
    let pieces = broken(points);
    let is_function = pieces.iter().all(|piece| piece.windows(2).all(|pair| pair[0][0] <= pair[1][0]));
    let count = |pieces: &Pieces| pieces.iter().map(Vec::len).sum::<usize>();
    let mut size = 1.0;
    loop {
        let thinned: Pieces = match is_function {
            true => pieces.iter().map(|piece| extremes(piece, size)).collect(),
            false => new_ways(&pieces, size),
        };
        if count(&thinned) <= most.max(4 * pieces.len()) {
            return thinned;
        }
        size *= 1.5;
    }
}

/// First, lowest, highest and last point in every column.
fn extremes(piece: &[[f64; 2]], width: f64) -> Vec<[f64; 2]> {
    let column = |point: &[f64; 2]| (point[0] / width).floor() as i64;
    let mut kept = Vec::new();
    for group in piece.chunk_by(|a, b| column(a) == column(b)) {
        let by_height = |a: &usize, b: &usize| group[*a][1].total_cmp(&group[*b][1]);
        let lowest = (0..group.len()).min_by(by_height).unwrap_or(0);
        let highest = (0..group.len()).max_by(by_height).unwrap_or(0);
        let mut order = [0, lowest, highest, group.len() - 1];
        order.sort_unstable();
        for (k, index) in order.iter().enumerate() {
            if k == 0 || order[k - 1] != *index {
                kept.push(group[*index]);
            }
        }
    }
    kept
}

/// The first point in every cell the curve enters; broken where it goes from one cell to another once again.
fn new_ways(pieces: &Pieces, size: f64) -> Pieces {
    let cell = |point: &[f64; 2]| point.map(|x| (x / size).round() as i64);
    let mut gone = HashSet::new();
    let mut kept: Pieces = Vec::new();
    for piece in pieces {
        let (mut last, mut drawing) = (piece[0], false);
        for point in &piece[1..] {
            if cell(point) == cell(&last) {
                continue;
            }
            if gone.insert((cell(&last), cell(point))) {
                match kept.last_mut() {
                    Some(way) if drawing => way.push(*point),
                    _ => kept.push(vec![last, *point]),
                }
                drawing = true;
            } else {
                drawing = false;
            }
            last = *point;
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::thin;

    #[test]
    fn a_function_keeps_its_extremes() {
        let points = || (0..1_000_000).map(|k| [k as f64 * 7e-4, if k == 654_321 { 100.0 } else { (k % 7) as f64 }]);
        let thinned = thin(points(), 4000).concat();
        assert!(thinned.len() <= 4000, "{} points", thinned.len());
        assert!(thinned.contains(&[654_321.0 * 7e-4, 100.0]));
        assert_eq!((thinned.first(), thinned.last()), (points().next().as_ref(), points().next_back().as_ref()));
    }

    #[test]
    fn a_loop_gone_round_many_times_is_drawn_once() {
        let circle = |rounds: usize| {
            (0..=360 * rounds).map(|k| (k as f64).to_radians()).map(|a| [100.0 * a.cos(), 100.0 * a.sin()])
        };
        let count = |rounds| thin(circle(rounds), 4000).concat().len();
        assert!(count(1) > 300 && count(1000) < count(1) + 10, "{} and {}", count(1), count(1000));
    }

    #[test]
    fn values_without_a_place_break_the_curve() {
        let points = [[0.0, 0.0], [1.0, f64::NAN], [2.0, 1.0], [3.0, 1.0]];
        assert_eq!(thin(points.into_iter(), 10), vec![vec![[0.0, 0.0]], vec![[2.0, 1.0], [3.0, 1.0]]]);
    }
}
