//! What events of slip amount to ([`super::events`]).

use super::events::{Course, SlipEvent};
use super::passages::{Interface, Point};

/// What an event amounts to.
pub(super) struct Measures {
    /// Time and place of the first arrival
    pub onset: f64,
    pub position: f64,
    pub at: [f64; 2],
    /// Length that its points stand for [L]
    pub length: f64,
    pub mean_slip: f64,
    pub largest_slip: f64,
    pub peak_slip_rate: f64,
    pub stress_drop: f64,
    pub fracture_energy: f64,
    pub released: f64,
    pub radiated: f64,
    pub front_speed: f64,
}

impl Measures {
    /// What it amounts to; nothing if no front has reached a point.
    pub fn of(event: &SlipEvent, interface: &Interface) -> Option<Self> {
        let reached: Vec<(&Point, &Course, f64)> = interface
            .points
            .iter()
            .zip(&event.courses)
            .filter_map(|(point, course)| {
                let arrival = point.arrivals.iter().find(|arrival| arrival.event == event.number)?;
                Some((point, course, arrival.time))
            })
            .collect();
        let (first, _, onset) = *reached.iter().min_by(|a, b| a.2.total_cmp(&b.2))?;
        let length: f64 = reached.iter().map(|(point, ..)| point.length).sum();
        let mean = |of: &dyn Fn(&Course) -> f64| {
            reached.iter().map(|(point, course, _)| point.length * of(course)).sum::<f64>() / length
        };
        let largest = |of: &dyn Fn(&Course) -> f64| reached.iter().map(|(_, course, _)| of(course)).fold(0.0, f64::max);
        let [start, end] = event.energies;
        let released = end.given - start.given;
        Some(Self {
            onset,
            position: first.position,
            at: first.at,
            length,
            mean_slip: mean(&Course::slip),
            largest_slip: largest(&|course| course.slip().abs()),
            peak_slip_rate: largest(&|course| course.peak_rate),
            stress_drop: mean(&Course::stress_drop),
            fracture_energy: mean(&Course::fracture_energy),
            released,
            radiated: released - (end.friction - start.friction),
            front_speed: front_speed(first, onset, &reached),
        })
    }
}

/// Slope of the distance from the first point of a line over the time of arrival; NaN where there is none.
fn front_speed(first: &Point, onset: f64, reached: &[(&Point, &Course, f64)]) -> f64 {
    let near = reached.iter().filter(|(point, ..)| point.line == first.line);
    let pairs: Vec<[f64; 2]> =
        near.map(|(point, _, time)| [time - onset, (point.position - first.position).abs()]).collect();
    let count = pairs.len() as f64;
    let mean = [0, 1].map(|i| pairs.iter().map(|pair| pair[i]).sum::<f64>() / count);
    let (both, square) = pairs.iter().fold((0.0, 0.0), |(both, square), [t, d]| {
        (both + (t - mean[0]) * (d - mean[1]), square + (t - mean[0]).powi(2))
    });
    if square > 0.0 { both / square } else { f64::NAN }
}
