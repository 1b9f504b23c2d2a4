//! A rigid master, with its geometry checked.

use nalgebra::Vector2;

use super::contact::MasterSide;
use super::error::{Checked, ModelError};
use super::limits::check_finite;
use crate::contact::master::{Circle, Plane, Polyline, Rigid};

/// The body of a rigid master.
pub fn rigid(side: &MasterSide, place: &str) -> Checked<Rigid> {
    match side {
        MasterSide::Group(group) => Err(ModelError::new(place, format!("`{group}` is a group, not a rigid body"))),
        MasterSide::Plane { point, normal } => plane(*point, *normal, place),
        MasterSide::Circle { centre, radius, hole } => {
            check_finite(&format!("{place}.circle.centre"), *centre)?;
            if !(*radius > 0.0 && radius.is_finite()) {
                let message = format!("is {radius}: must be positive");
                return Err(ModelError::new(format!("{place}.circle.radius"), message));
            }
            Ok(Rigid::Circle(Circle { centre: Vector2::from(*centre), radius: *radius, hole: *hole }))
        }
        MasterSide::Polyline(points) => {
            let place = format!("{place}.polyline.points");
            check_finite(&place, points.iter().flatten().copied())?;
            if points.len() < 2 {
                return Err(ModelError::new(place, format!("has {} points: must have two or more", points.len())));
            }
            if let Some(k) = points.windows(2).position(|pair| pair[0] == pair[1]) {
                let message = format!("points {} and {} are the same: leave one out", k, k + 1);
                return Err(ModelError::new(place, message));
            }
            Ok(Rigid::Polyline(Polyline::new(points.iter().map(|&point| Vector2::from(point)).collect())))
        }
    }
}

fn plane(point: [f64; 2], normal: [f64; 2], place: &str) -> Checked<Rigid> {
    check_finite(&format!("{place}.plane.point"), point)?;
    let given = Vector2::from(normal);
    let Some(normal) = given.try_normalize(0.0).filter(|normal| normal.norm() > 0.5) else {
        let message = format!("is [{}, {}]: must have a direction, such as [0, 1]", given.x, given.y);
        return Err(ModelError::new(format!("{place}.plane.normal"), message));
    };
    Ok(Rigid::Plane(Plane { point: Vector2::from(point), normal }))
}
