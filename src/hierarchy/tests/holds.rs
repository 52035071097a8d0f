//! Tests whether a volume contains points and other volumes.

use bevy::math::{
    DVec3, Vec3,
    bounding::{Aabb3d, BoundingSphere, BoundingVolume},
};

use crate::hierarchy::{
    probe::ROUNDING,
    volume::{KDop, NodeVolume, Obb},
};

/// Whether a volume contains others, up to rounding errors.
pub trait Holds {
    /// Whether it contains a ball at `centre` (m), in `f64`, up to the rounding errors of lengths of `scale` (m).
    fn holds(&self, centre: DVec3, radius: f64) -> bool;

    /// Whether it contains another volume, up to rounding errors.
    fn holds_volume(&self, other: &Self) -> bool;
}

impl Holds for BoundingSphere {
    fn holds(&self, centre: DVec3, radius: f64) -> bool {
        let distance = Vec3::from(self.center).as_dvec3().distance(centre);
        distance + radius <= f64::from(self.radius() * ROUNDING)
    }

    fn holds_volume(&self, other: &Self) -> bool {
        let centre = Vec3::from(other.center).as_dvec3();
        self.holds(centre, other.radius().into())
    }
}

impl Holds for Aabb3d {
    fn holds(&self, centre: DVec3, radius: f64) -> bool {
        let [min, max] = [self.min, self.max].map(|corner| Vec3::from(corner).as_dvec3());
        (centre - radius).cmpge(min).all() && (centre + radius).cmple(max).all()
    }

    fn holds_volume(&self, other: &Self) -> bool {
        self.contains(other)
    }
}

impl Holds for Obb {
    fn holds(&self, centre: DVec3, radius: f64) -> bool {
        let offset = centre - self.centre.as_dvec3();
        let local = self.axes.as_dmat3().transpose() * offset;
        // Its axes have length 1 up to rounding errors, and so have measurements along them.
        let rounding = f64::from(self.half_size.max_element()) * 1.0e-6;
        (local.abs() + radius)
            .cmple(self.half_size.as_dvec3() + rounding)
            .all()
    }

    fn holds_volume(&self, other: &Self) -> bool {
        let offset = other.centre.as_dvec3() - self.centre.as_dvec3();
        (0..3).all(|at| {
            let (axis, half) = (self.axes.col(at), self.half_size[at]);
            offset.dot(axis.as_dvec3()).abs() as f32 + other.reach_along(axis)
                <= half * ROUNDING + self.half_size.max_element() * 1.0e-6
        })
    }
}

impl<const N: usize> Holds for KDop<N> {
    fn holds(&self, centre: DVec3, radius: f64) -> bool {
        self.slabs().all(|(axis, low, high)| {
            let axis = axis.as_dvec3();
            let (middle, half) = (centre.dot(axis), radius * axis.length());
            f64::from(low) <= middle - half && middle + half <= f64::from(high)
        })
    }

    fn holds_volume(&self, other: &Self) -> bool {
        let mut slabs = self.slabs().zip(other.slabs());
        slabs.all(|((_, low, high), (_, least, most))| low <= least && most <= high)
    }
}

impl Holds for NodeVolume {
    fn holds(&self, centre: DVec3, radius: f64) -> bool {
        match self {
            Self::Sphere(of) => of.holds(centre, radius),
            Self::Aabb(of) => of.holds(centre, radius),
            Self::Obb(of) => of.holds(centre, radius),
            Self::KDop14(of) => of.holds(centre, radius),
            Self::KDop18(of) => of.holds(centre, radius),
            Self::KDop26(of) => of.holds(centre, radius),
        }
    }

    fn holds_volume(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Sphere(of), Self::Sphere(other)) => of.holds_volume(other),
            (Self::Aabb(of), Self::Aabb(other)) => of.holds_volume(other),
            (Self::Obb(of), Self::Obb(other)) => of.holds_volume(other),
            (Self::KDop14(of), Self::KDop14(other)) => of.holds_volume(other),
            (Self::KDop18(of), Self::KDop18(other)) => of.holds_volume(other),
            (Self::KDop26(of), Self::KDop26(other)) => of.holds_volume(other),
            _ => false,
        }
    }
}
