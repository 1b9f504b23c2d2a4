//! Colours of slip rates.

/// Slip rates are told apart over so many powers of ten below the highest.
pub const DECADES: f64 = 4.0;

/// Colours from the lowest to the highest, printed in grey they rise in darkness.
const COLOURS: [[f64; 3]; 5] =
    [[255.0, 255.0, 255.0], [253.0, 212.0, 120.0], [240.0, 110.0, 60.0], [170.0, 20.0, 90.0], [40.0, 0.0, 70.0]];

/// Colour of a slip rate, 0 to 1.
pub fn level(rate: f64, highest: f64) -> f64 {
    match rate / highest {
        of if of > 0.0 => (1.0 + of.log10() / DECADES).clamp(0.0, 1.0),
        _ => 0.0,
    }
}

/// The colour of a level, as SVG writes it.
pub fn colour(level: f64) -> String {
    let at = level * (COLOURS.len() - 1) as f64;
    let k = (at as usize).min(COLOURS.len() - 2);
    let mixed = [0, 1, 2].map(|i| COLOURS[k][i] + (at - k as f64) * (COLOURS[k + 1][i] - COLOURS[k][i]));
    // Few different colours, so that neighbours often share one.
    let [r, g, b] = mixed.map(|value| (8.0 * (value / 8.0).round()).min(255.0) as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}
