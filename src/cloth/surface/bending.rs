//! The triangles on which a surface bends.

use bevy::math::{DVec3, Vec3};

use super::{
    Surface,
    triangulation::{Triangulation, turned},
};

impl Surface {
    /// The triangles on which it bends: as many as it has, in the order of those of the whole surface. What is torn is turned as
    /// before, but beside the tears.
    pub(crate) fn bending_faces(&self) -> &Triangulation {
        self.derived.bending.get_or_init(|| match &self.torn {
            Some(torn) => {
                let (whole, sides) = (torn.whole.bending_faces(), torn.sides());
                Triangulation::torn(&torn.corners, &sides, whole, |at| torn.origin[at as usize])
            }
            // The diagonals of a grid are parallel.
            None if self.as_grid().is_some() => {
                Triangulation::of(self.triangles(), &self.incidence().sides)
            }
            None => turned(self.triangles(), &self.places_in_f64(), &self.grain),
        })
    }

    /// Its places at rest (m), in f64.
    pub(crate) fn places_in_f64(&self) -> Vec<DVec3> {
        self.rest.iter().map(|place| place.as_dvec3()).collect()
    }

    /// The direction of the warp in such a triangle; `None` without a grain.
    pub(crate) fn bending_grain(&self, face: usize) -> Option<Vec3> {
        match &self.torn {
            // That of a grid is the same everywhere.
            Some(torn) if torn.whole.as_grid().is_some() => self.grain.first().copied(),
            Some(torn) => torn.whole.bending_grain(face),
            None => self.grain.get(face).copied(),
        }
    }
}
