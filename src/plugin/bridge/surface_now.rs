//! The surface of a cloth between a snapshot and the next tick.

use std::{borrow::Cow, sync::Arc};

use crate::{
    cloth::{ClothParticles, ClothTears, Surface},
    plugin::state::{ClothBuilt, ClothState},
};

/// The surface of a cloth's particles: the built one. After a restored snapshot with other tears it is another, until the next tick builds that.
/// `None` before the first tick, and where the particles are not of the cloth.
pub(super) fn surface_now<'a>(
    built: &'a ClothBuilt,
    state: &ClothState,
    tears: Option<&ClothTears>,
    particles: &ClothParticles,
) -> Option<Cow<'a, Arc<Surface>>> {
    if particles.is_empty() {
        return None;
    }
    let edges = tears.map_or(&[][..], ClothTears::edges);
    let opened = edges.get(..state.inputs.opened).unwrap_or(edges);
    let is_built = opened == built.tears().edges() && state.inputs.as_mesh == built.is_as_mesh();
    let surface = match !state.resumes || is_built {
        true => Cow::Borrowed(built.surface()),
        false => Cow::Owned(match opened {
            [] if !state.inputs.as_mesh => built.surface().whole(),
            opened => Arc::new(built.surface().torn(opened).ok()?),
        }),
    };
    particles.matches(&surface).then_some(surface)
}
