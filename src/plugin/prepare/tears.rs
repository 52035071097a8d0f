//! Tears cloths that are simulated already.

use std::mem;

use bevy::{
    prelude::{Changed, Entity, Query, ResMut},
    tasks::{AsyncComputeTaskPool, TaskPool},
};

use super::build_inputs::{Build, Building};
use crate::{
    cloth::{ClothError, ClothMaterial, ClothMaterialMap, ClothTears, Surface},
    plugin::{
        authoring::Attached,
        state::{BuildRequest, ClothBuilt, ClothState, Recipe, SharedParts},
    },
    solver::creases_of_torn,
};

/// Begins to build what was torn since the tick began: until the next tick there is time for it.
pub(crate) fn build_torn_ahead(
    cloths: Query<
        (
            Entity,
            &ClothTears,
            &ClothBuilt,
            Option<&ClothMaterial>,
            Option<&ClothMaterialMap>,
        ),
        Changed<ClothTears>,
    >,
    mut parts: ResMut<SharedParts>,
) {
    for (cloth, tears, built, material, map) in &cloths {
        let material = material.copied().unwrap_or_default();
        let Some(known) = &built.shared.recipe else {
            continue;
        };
        // A mended cloth may be a grid again.
        if tears.is_empty() || *tears == known.tears || material.validate().is_err() {
            continue;
        }
        let recipe = Recipe {
            tears: tears.clone(),
            as_mesh: false,
            ..known.clone()
        };
        let request = BuildRequest {
            recipe,
            material,
            map: map.cloned(),
            before: Some(built.shared.clone()),
        };
        parts.build_ahead(cloth, request);
    }
}

impl Building<'_, '_> {
    /// Takes over other tears, or the change of a grid to a mesh and back. Particles keep their places, motion and indices, and new ones follow.
    ///
    /// # Errors
    /// [`NoSuchEdge`](crate::cloth::TearError::NoSuchEdge); the cloth stays as it was.
    pub(super) fn follow_tears(&mut self) -> Result<Build, ClothError> {
        let wanted = self.wanted;
        let Some(known) = &self.built.shared.recipe else {
            return Ok(Build::Kept);
        };
        let recipe = Recipe {
            tears: wanted.tears.clone(),
            as_mesh: wanted.is_as_mesh(),
            ..known.clone()
        };
        let before = self.built.surface().clone();
        // The known parts don't keep it.
        let _kept_alive = self.parts.built_ahead(&recipe);
        let of = |surface: &Surface| wanted.factors(surface);
        let known = Some(&*self.built.shared);
        let (shared, factors) = self.parts.get(&recipe, wanted.material, known, of, || {
            recipe.opened(before.whole())
        })?;
        let surface = &shared.surface;
        // Other changes are those of the same particles.
        self.follow_masses()?;
        let Some(parents) = surface.parents_in(&before) else {
            return Ok(Build::Kept);
        };
        let (particles, built) = (&mut *self.particles, &mut *self.built);
        let state = &mut *self.state;
        let torn = particles.torn(&before, surface, &parents, wanted.has_layers);
        **particles = torn;
        let count = recipe.tears.count_beyond(built.tears());
        let at = ends_of_tear(
            [&recipe.tears, built.tears()],
            before.len(),
            particles.len(),
        );
        built.unreported_tear = at.map(|ends| (ends, count));
        hold_parts(surface, &parents, state);
        state.pose.take_parts(&parents);
        state.creases = creases_of_torn(&before, surface, &state.creases);
        let solver = mem::replace(&mut built.solver, shared.new_solver());
        built.forget_tethers();
        let old = (solver, mem::replace(&mut built.shared, shared));
        // To free their memory takes long.
        AsyncComputeTaskPool::get_or_init(TaskPool::default)
            .spawn(async move { drop(old) })
            .detach();
        if let Some(from) = &mut built.from {
            from.changes.tears = wanted.changes.tears;
            from.factors = factors;
        }
        Ok(Build::Resampled)
    }
}

/// The first new particle, twice, or the ends of the last torn edge, if nothing opened. Both particles exist as long as this surface does.
fn ends_of_tear([now, then]: [&ClothTears; 2], before: usize, after: usize) -> Option<[u32; 2]> {
    if before < after {
        return Some([before as u32; 2]);
    }
    now.edges().last().or(then.edges().last()).copied()
}

/// Attaches the new parts of attached particles, too.
fn hold_parts(surface: &Surface, parents: &[u32], state: &mut ClothState) {
    let attached = &mut state.attachments.attached;
    attached.retain(|attached| parents.get(attached.particle as usize) == Some(&attached.particle));
    for known in 0..attached.len() {
        let of = attached[known];
        for part in (0..surface.len() as u32).filter(|part| *part != of.particle) {
            let is_held = || attached.iter().any(|known| known.particle == part);
            if parents[part as usize] == of.particle && !is_held() {
                attached.push(Attached {
                    particle: part,
                    ..of
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use bevy::{prelude::*, time::TimeUpdateStrategy};

    use super::*;
    use crate::{cloth::Cloth, plugin::ClothPlugin};

    /// The frame in which something was torn begins to build it, once; the next tick takes it.
    #[test]
    fn a_tear_is_built_ahead() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin, ClothPlugin::default()))
            .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
        let parts = (Cloth::new(6, 6, 0.1), ClothTears::default());
        let cloth = app.world_mut().spawn(parts).id();
        app.finish();
        app.cleanup();
        (0..3).for_each(|_| app.update());
        let building = |app: &App| app.world().resource::<SharedParts>().builds.all.len();
        assert_eq!(building(&app), 0);
        let tears = app.world_mut().get_mut::<ClothTears>(cloth);
        tears.expect("it may tear").tear_all([[12, 13], [13, 14]]);
        for _ in 0..2 {
            app.world_mut().run_schedule(Last);
            assert_eq!(building(&app), 1);
        }
        app.update();
        assert_eq!(building(&app), 0);
        let built = app.world().get::<ClothBuilt>(cloth).expect("a cloth");
        assert!(built.surface().is_torn());
    }
}
