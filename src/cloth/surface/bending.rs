//! The triangles on which a surface bends.

use bevy::math::DVec3;

use super::{
    Surface,
    triangulation::{Triangulation, turned},
};

impl Surface {
    /// The triangles on which it bends, as many as it has and in their places. Those of a torn surface are turned as before, but
    /// beside the tears.
    pub(crate) fn bending_faces(&self) -> &Triangulation {
        self.derived.bending.get_or_init(|| match &self.torn {
            Some(torn) => Triangulation::torn(self.triangles(), torn.whole.bending_faces(), |at| {
                self.origin_of(at)
            }),
            None => {
                let places = self.rest.iter().map(|place| place.as_dvec3());
                let places: Vec<DVec3> = places.collect();
                turned(self.triangles(), &places, &self.grain)
            }
        })
    }
}
