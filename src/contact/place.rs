//! Where a contact point is at the end of an increment, and whether it is closed there.

use super::kinematics::{Kinematics, kinematics};
use super::pair::ContactPair;
use super::point::{MasterPoint, SlavePoint};
use super::presumption::{PointIncrement, Presume};
use super::projection::Projection;
use super::state::ContactState;
use crate::mesh::configuration::Configuration;

/// Where a point is at the end of an increment.
#[derive(Clone, Copy, Debug, Default)]
pub struct PointPlace {
    /// g; 0 where nothing faces it [L]
    pub gap: f64,
    /// The foot, if the master faces it
    pub foot: Option<MasterPoint>,
    /// Whether it is closed, and has kinematics
    pub closes: bool,
    /// p_w; it has kinematics where this is not 0, too [F/L²]
    pub fluid: f64,
}

/// Where a point is whose projection is known, in the committed configuration and that of the trial, and its kinematics if it
/// is closed.
pub fn place(
    pair: &ContactPair,
    slave: &SlavePoint,
    projection: Option<Projection>,
    old: &ContactState,
    increment: PointIncrement,
    [before, x]: [&Configuration; 2],
    k: &mut Kinematics,
) -> PointPlace {
    let Some(projection) = projection else { return PointPlace::default() };
    let gap = slave.gap(projection.gap, increment.during.fading);
    let closes = closes(pair, slave, gap, old, increment);
    let fluid = pair.fluid_pressure(slave, x, increment.during.time);
    if closes || fluid != 0.0 {
        kinematics(slave, &pair.master, &projection, old.foot, x, k);
        if old.foot.is_none() {
            k.count_from(before, x);
        }
    }
    PointPlace { gap, foot: Some(projection.foot), closes, fluid }
}

/// Whether a point with this gap carries pressure, or is presumed to.
pub fn closes(pair: &ContactPair, slave: &SlavePoint, gap: f64, old: &ContactState, increment: PointIncrement) -> bool {
    let kept = increment.presumption.kept > 0.0;
    let clearance = gap - old.friction.opening;
    let pressure = old.multiplier - pair.normal_stiffness(increment.during.stiffening) * clearance;
    let presume = increment.presumption.presume;
    kept || pressure > 0.0 || touches(pair, clearance, old, presume) || may_ride(pair, slave, old)
}

/// Whether slip may keep a point closed, or part it, whatever its gap says: that is known once its slip is.
pub(super) fn may_ride(pair: &ContactPair, slave: &SlavePoint, old: &ContactState) -> bool {
    old.foot.is_some() && !pair.law(slave).start().offsets().is_empty() && !old.apart(pair.touch)
}

/// Whether a zero gap is presumed to be closed, and to stick.
pub fn touches(pair: &ContactPair, clearance: f64, old: &ContactState, presume: Presume) -> bool {
    let presumed = presume == Presume::Touch && old.foot.is_some();
    presumed && [old.clearance(), clearance].iter().all(|gap| gap.abs() <= pair.touch)
}
