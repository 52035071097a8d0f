//! A cloth in its tick: what each sub-step does to it, and what the tick leaves.

use bevy::{
    ecs::query::QueryData,
    prelude::{DetectChanges, Entity, Query, Vec3},
};

use crate::{
    cloth::ClothParticles,
    contact::{BodyChange, ClothLayers, ColliderShape},
    hierarchy::Core,
    plugin::{
        frame::ClothFrame,
        prepare::ColliderMotion,
        state::{ClothBuilt, ClothContacts, ClothScratch, ClothState, ClothStats, RestsOn},
    },
    solver::{LimitInputs, Stretch, SubStep, Substepping, TickStep},
};

/// Least distance at which edges are taken to touch, in spacings, where a tick is repeated for the depth of contact.
const THIN: f32 = 0.1;

#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct IntegrateQuery {
    pub entity: Entity,
    pub built: &'static mut ClothBuilt,
    pub frame: &'static ClothFrame,
    pub particles: &'static mut ClothParticles,
    pub state: &'static mut ClothState,
    pub scratch: &'static mut ClothScratch,
    pub contacts: &'static mut ClothContacts,
    pub stats: &'static mut ClothStats,
    pub layers: Option<&'static ClothLayers>,
}

/// All colliders, however far.
pub(crate) type Colliders<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static ColliderMotion,
        Option<&'static ClothLayers>,
    ),
>;

impl IntegrateQueryItem<'_, '_> {
    /// Takes over the results of a tick; its sub-steps took this time (ms).
    pub(crate) fn finish(&mut self, milliseconds: f64) {
        self.stats.integrate_ms = milliseconds;
        self.scratch.begins = false;
        // Particles that are lost here are a fault before the game sees them.
        let survey = self.particles.survey();
        self.state.is_valid &= survey.is_valid;
        self.state.largest_speed = survey.largest_speed;
        self.state.inputs.written = Some(self.particles.last_changed());
        self.remember_contacts();
        self.push_bodies();
        let rotation = self.frame.isometry().rotation;
        self.contacts.renew(
            &self.scratch.near,
            &self.scratch.detection,
            rotation,
            |of| self.state.resting.pieces.sleeps(of),
        );
        self.stats.requeries = self.scratch.detection.requeries();
        self.stats.stretch = self.state.stretch;
        let forces = &self.built.solver.forces;
        self.stats.air_impulse = rotation * forces.impulse();
        (self.stats.enclosed_volume, self.stats.gauge_pressure) = forces.enclosed();
        self.state.inputs.forces.memory = forces.memory;
        let creases = &mut self.state.creases;
        creases.clear();
        creases.extend_from_slice(self.built.solver.creases());
        self.stats.contacts = self.contacts.iter().map(|contact| contact.particles).sum();
    }

    /// Remembers the contacts of the cloth, in case it falls asleep.
    fn remember_contacts(&mut self) {
        let scratch = &*self.scratch;
        let touches = scratch.detection.touches().iter();
        // A body's own path, without the pushes of the tick.
        let known = touches.filter_map(|touch| scratch.near.get(touch.id));
        let known = known.map(|(entity, collider)| RestsOn::new(*entity, collider));
        self.state.resting.on.clear();
        self.state.resting.on.extend(known);
    }

    /// Notes the cloth's pushes on bodies. While it pushes one that moves, it does not rest.
    fn push_bodies(&mut self) {
        let (state, scratch) = (&mut *self.state, &mut *self.scratch);
        let detection = &scratch.detection;
        state.carriers.clear();
        let rotation = self.frame.isometry().rotation;
        let bodies = scratch.near.iter().enumerate();
        for (id, (entity, collider)) in bodies.filter(|(_, near)| near.1.body.is_some()) {
            let carrying = detection.carriers(id).iter();
            (state.carriers).extend(carrying.map(|carrier| (*entity, *carrier)));
            if let Some(change) = detection.body_change(id)
                && change != BodyChange::default()
            {
                let changes = [change, detection.body_held(id)];
                let changes = changes.map(|change| change.turned(rotation));
                scratch.pushed.push((*entity, changes));
                if !collider.is_settled() {
                    state.rest.disturb();
                }
            }
        }
    }

    /// Whether a tick is done again with more sub-steps, if one takes too few.
    pub(crate) fn may_repeat(&self) -> bool {
        match self.scratch.substepping {
            Substepping::Fixed(_) => false,
            Substepping::Automatic => {
                let mut near = self.scratch.near.iter();
                near.any(|(_, near)| near.shape.has_edges())
            }
            Substepping::Adaptive { .. } => true,
        }
    }

    /// Goes back to where the tick began.
    pub(crate) fn restart(&mut self) {
        self.particles.copy_from(&self.scratch.backup);
        self.scratch.detection.restart();
        self.built.solver.forces.memory = self.state.inputs.forces.memory;
        self.built.solver.recall_creases(&self.state.creases);
    }

    /// The quantities of the tick's last run of sub-steps that are compared with the limits; layers have `lost` so many pairs.
    pub(crate) fn limit_inputs(&self, step: TickStep, lost: u32) -> LimitInputs {
        let spacing = self.built.surface().spacing();
        let root = self
            .built
            .tree()
            .root_sphere(&self.particles, self.state.stretch.bound);
        let count = step.substeps as f32;
        // The colliders that reach the ball around the cloth; a capsule's rotation counts.
        let around = root.radius() + self.scratch.reach;
        let travels = self.scratch.near.iter().filter_map(|(_, collider)| {
            let core = Core::Segment([collider.from.translation.into(), collider.to]);
            if !core.may_reach(root.center.into(), around + collider.shape.extent()) {
                return None;
            }
            let travel = match collider.shape {
                ColliderShape::Ball { .. } => collider.travel(),
                _ => collider.max_surface_travel(f32::INFINITY),
            };
            LimitInputs::travel_in_radii(collider.shape.radius()?, travel / count, spacing.longest)
        });
        LimitInputs {
            lost,
            embedded: self.scratch.detection.embedded(),
            collider_travel: travels.fold(0.0, f32::max),
            stretch: self.state.stretch.structural,
            substepping: self.scratch.substepping,
            is_beyond: self.state.control.is_beyond(),
            substep: step.seconds / count,
            damping: step.damping,
            material_stretch: self.built.largest_material_stretch,
            holds_weight: self.built.shared.springs.are_of_grid()
                || !self.built.solver.tethers().is_empty(),
            masses: self.built.masses,
            distance: (Vec3::from(root.center).length() - root.radius()).max(0.0),
            spacing: spacing.shortest,
        }
    }

    /// Sub-steps that hold what the cloth carries, and of a mesh the places where it is heavier than elsewhere.
    pub(crate) fn load_substeps(&self, step: &TickStep) -> f32 {
        let (gravity, spacing) = (step.acceleration.length(), self.built.surface().spacing());
        let carried = (self.scratch.detection).load_ratio(gravity * step.seconds);
        let ratio = carried.max(self.built.density_ratio());
        Substepping::for_load(ratio, gravity, spacing.shortest, step.seconds)
    }

    /// Sub-steps that hold the cloth together where something that moves forces it over the edges of a collider: these pass
    /// between particles.
    pub(crate) fn contact_substeps(&self, step: &TickStep, stretch: &Stretch) -> f32 {
        let detection = &self.scratch.detection;
        let is_pulled = !self.scratch.pins.is_empty();
        let depths = detection.touches().iter().filter_map(|touch| {
            let moves = is_pulled || touch.collider.max_surface_travel(f32::INFINITY) > 0.0;
            (moves && touch.collider.shape.has_edges()).then_some(touch.deepest)
        });
        let deepest = depths.fold(0.0, f32::max);
        // A force of its own draws embedded cloth out.
        if deepest == 0.0 || detection.embedded() > 0.0 {
            return 0.0;
        }
        let given = stretch.material.max(step.material_stretch);
        let radius = self.scratch.contact_settings.particle_radius;
        let touching = radius.max(THIN * self.built.surface().spacing().longest);
        let depths = deepest / touching;
        Substepping::for_contact(stretch.structural - given, depths, step.substeps)
    }

    /// Restores the bodies that particles carried as the last tick ended.
    pub(crate) fn recall_carriers(&mut self, substeps: u32) {
        let scratch = &mut *self.scratch;
        let carriers = &self.state.carriers;
        (scratch.detection).recall(&mut self.particles, substeps, |id| {
            let body = scratch.near[id].0;
            let own = carriers.iter().filter(move |(entity, _)| *entity == body);
            own.map(|(_, carrier)| *carrier)
        });
    }

    /// Holds it near its pose as a sub-step ends, if it follows one. Returns whether anything moved.
    pub(crate) fn hold(&mut self, substep: &mut SubStep) -> bool {
        let constraints = &self.scratch.constraints;
        !constraints.is_empty() && constraints.hold(&mut self.particles, substep)
    }

    /// Pushes it out of colliders. Those that were far away as the tick began may be near now, and known ones keep their
    /// number. Returns whether anything moved.
    pub(crate) fn touch(&mut self, substep: SubStep, colliders: &Colliders) -> bool {
        let scratch = &mut *self.scratch;
        let (near, known) = (&mut scratch.near, &mut scratch.near_set);
        let (settings, carried) = (&scratch.contact_settings, scratch.carried.as_ref());
        let layers = self.layers.copied().unwrap_or_default();
        (scratch.detection).respond(&mut self.particles, settings, substep, |numbered| {
            known.clear();
            known.extend(near.iter().map(|(entity, _)| *entity));
            for (entity, motion, others) in colliders {
                if layers.interacts_with(others.copied().unwrap_or_default())
                    && !known.contains(&entity)
                    && let Some(collider) = motion.seen_from(self.frame, carried)
                {
                    numbered.push((near.len(), collider.clone()));
                    near.push((entity, collider));
                }
            }
        })
    }
}
