//! Keeps a mesh on the particles.

mod adding;
mod blend;
mod drawing;
mod placing;
mod skin;
mod tube;
mod write;

use bevy::{
    asset::AssetEventSystems,
    camera::visibility::VisibilitySystems,
    ecs::{intern::Interned, query::QueryData, schedule::ScheduleLabel, system::SystemParam},
    math::Affine3A,
    prelude::{
        App, Assets, DetectChanges, Entity, Fixed, FixedFirst, FixedLast, FixedPostUpdate,
        FixedPreUpdate, FixedUpdate, GlobalTransform, InheritedVisibility, IntoScheduleConfigs,
        Mesh, Plugin, PostUpdate, Query, Ref, Res, ResMut, Resource, Time, TransformSystems, Vec3,
        resource_exists,
    },
};

use crate::{
    cloth::ClothParticles,
    plugin::{
        authoring::{ClothLodLevel, ClothMesh, ClothSkeleton},
        frame::{ClothFrame, rigid},
        prepare::Skins,
        sets::{ClothSystems, runs_in_schedule},
        state::{ClothBuilt, ClothScratch, ClothState, LodAction, Notices},
    },
};
use adding::remove_mesh;
use placing::Drawn;

pub(super) use adding::add_meshes;
pub(crate) use drawing::MeshDrawing;
pub(super) use write::{Vectors, with_triangles};

/// Whether meshes are drawn between two ticks. In a schedule that runs once a frame there is nothing to interpolate.
#[derive(Resource)]
pub(super) struct Interpolated(bool);

/// Gives each cloth a mesh with UVs, normals and tangents that follows its particles. The mesh is updated once per
/// rendered frame, interpolated between two ticks by `overstep_fraction`. Does nothing in an app without meshes.
#[derive(Debug, Clone, Copy)]
pub struct ClothMeshPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

runs_in_schedule! {
    /// For a [`ClothPlugin`](crate::plugin::ClothPlugin) in `schedule`.
    ClothMeshPlugin
}

impl Plugin for ClothMeshPlugin {
    fn build(&self, app: &mut App) {
        let fixed: [Interned<dyn ScheduleLabel>; 5] = [
            FixedFirst.intern(),
            FixedPreUpdate.intern(),
            FixedUpdate.intern(),
            FixedPostUpdate.intern(),
            FixedLast.intern(),
        ];
        app.init_resource::<Notices>()
            .insert_resource(Interpolated(fixed.contains(&self.schedule)))
            .register_type::<ClothMesh>()
            .register_type::<ClothSkeleton>()
            .add_observer(remove_mesh)
            .add_systems(
                self.schedule,
                remember_positions
                    .after(ClothSystems::Query)
                    .before(ClothSystems::Integrate),
            )
            // Before the asset events, from which Bevy's culling takes the new bounds.
            .add_systems(
                PostUpdate,
                (add_meshes, update_meshes)
                    .chain()
                    .after(ClothSystems::WriteBack)
                    .after(TransformSystems::Propagate)
                    .after(VisibilitySystems::VisibilityPropagate)
                    .before(AssetEventSystems)
                    .run_if(resource_exists::<Assets<Mesh>>)
                    .run_if(resource_exists::<Time<Fixed>>),
            );
    }
}

fn remember_positions(
    mut cloths: Query<(
        &ClothParticles,
        &ClothFrame,
        &ClothState,
        &ClothScratch,
        &mut MeshDrawing,
    )>,
) {
    for (particles, frame, state, scratch, mut drawing) in &mut cloths {
        match state.lod.action {
            LodAction::Move => {}
            LodAction::Wait => continue,
            LodAction::Stand => {
                drawing.carriers.freeze(*frame);
                continue;
            }
        }
        let rests = state.rest.is_asleep();
        if !(rests && drawing.rested) {
            drawing.previous.clear();
            drawing.previous.extend(particles.positions());
            // The state before it was carried along.
            let undone = scratch.carried.map(|carried| carried.undone_in(frame));
            if let Some(undone) = undone {
                let places = drawing.previous.iter_mut();
                places.for_each(|place| *place = undone * *place);
            }
            drawing.pose.follow(*frame, state, scratch, undone);
            drawing.carriers.follow(*frame, state, scratch);
        }
        drawing.rested = rests;
    }
}

#[derive(QueryData)]
#[query_data(mutable)]
pub(super) struct DrawQuery {
    entity: Entity,
    built: &'static ClothBuilt,
    particles: Ref<'static, ClothParticles>,
    frame: &'static ClothFrame,
    state: &'static ClothState,
    transform: Option<&'static GlobalTransform>,
    visibility: Option<&'static InheritedVisibility>,
    mesh: &'static ClothMesh,
    drawing: &'static mut MeshDrawing,
}

/// Where things are drawn.
#[derive(SystemParam)]
pub(super) struct Surroundings<'w, 's> {
    transforms: Query<'w, 's, &'static GlobalTransform>,
    skins: Skins<'w, 's>,
}

pub(super) fn update_meshes(
    mut cloths: Query<DrawQuery>,
    around: Surroundings,
    (fixed, time): (Res<Time<Fixed>>, Res<Time>),
    mut meshes: ResMut<Assets<Mesh>>,
    interpolated: Res<Interpolated>,
) {
    let overstep = fixed.overstep_fraction().min(1.0);
    let fraction = if interpolated.0 { overstep } else { 1.0 };
    let seconds = time.elapsed_secs_f64();
    for mut cloth in &mut cloths {
        cloth.update(&around, &mut meshes, fraction, seconds);
    }
}

impl DrawQueryItem<'_, '_> {
    fn update(
        &mut self,
        around: &Surroundings,
        meshes: &mut Assets<Mesh>,
        fraction: f32,
        seconds: f64,
    ) {
        let drives = std::mem::take(&mut self.drawing.drives);
        if !self.state.is_valid || !self.built.matches(&self.particles) {
            return;
        }
        // No camera sees what the game hides. A mesh outside every camera's view is kept up to date: culling comes
        // later in the frame, so that is not known yet.
        let is_seen = self.visibility.is_none_or(|visibility| visibility.get());
        let lod = &self.state.lod;
        if !is_seen && !drives || lod.level == ClothLodLevel::Off {
            self.drawing.settled = None;
            return;
        }
        // Over the ticks from the last move to the next.
        let fraction = lod.drawn_part(lod.since as f32 + fraction);
        let cuts = lod.cuts;
        let own = GlobalTransform::from(self.frame.affine());
        let entity = self.transform.copied().unwrap_or(own);
        let stands = self.find_targets(around, entity.affine());
        let place = |joint| around.transforms.get(joint).ok().copied();
        let drawing = &mut *self.drawing;
        let moves = drawing.pose.read(self.entity, &around.skins, place);
        // A cloth that sleeps or is frozen is drawn once.
        let rests = self.state.rest.is_asleep() && drawing.rested;
        let is_asleep = !moves && rests && !drawing.carriers.differ_from(&drawing.targets);
        let still = stands.or(is_asleep.then_some(entity.affine()));
        let still = still.filter(|_| drawing.blend.is_over(cuts));
        let settled = still.map(|place| (self.particles.last_changed(), place, is_seen));
        if settled.is_some() && drawing.settled == settled {
            return;
        }
        let blends = !drawing.blend.is_over(cuts);
        if blends {
            std::mem::swap(&mut drawing.before, &mut drawing.drawn);
        }
        self.place(stands, entity, fraction);
        let drawing = &mut *self.drawing;
        if blends {
            let (before, drawn) = (&drawing.before, &mut drawing.drawn);
            (drawing.blend).add(cuts, seconds, &self.particles, before, drawn);
        }
        drawing.version = drawing.version.wrapping_add(1);
        drawing.settled = settled;
        let surface = self.built.surface();
        if is_seen
            && let Some(mut mesh) = meshes.get_mut(&self.mesh.handle)
            && mesh.count_vertices() == drawing.vertices.len(surface)
        {
            drawing.write(&mut mesh);
        }
    }

    /// Finds where the targets of the tick are drawn; later attachments count from the next tick on. Returns the place of the
    /// particles relative to their entity if they are frozen.
    fn find_targets(&mut self, around: &Surroundings, entity: Affine3A) -> Option<Affine3A> {
        let drawing = &mut *self.drawing;
        let drawn_at = self.state.attachments.targets.iter();
        let drawn_at = drawn_at.map_while(|target| around.transforms.get(*target).ok());
        drawing.targets.clear();
        (drawing.targets).extend(drawn_at.map(GlobalTransform::affine));
        let Some(stands) = self.state.lod.frozen else {
            drawing.frozen = None;
            return None;
        };
        Some(match drawing.targets.first() {
            None => *drawing.frozen.get_or_insert(self.frame.to_entity()),
            Some(target) => {
                let place = rigid(target) * stands.carrier.inverse() * stands.frame;
                entity.inverse() * Affine3A::from(place)
            }
        })
    }

    /// Places the drawn particles in their entity's frame.
    fn place(&mut self, stands: Option<Affine3A>, entity: GlobalTransform, fraction: f32) {
        let drawing = &mut *self.drawing;
        let drawn = &mut drawing.drawn;
        if let Some(to_entity) = stands {
            drawn.clear();
            let positions = self.particles.positions();
            drawn.extend(positions.map(|place| to_entity.transform_point3(place)));
            return;
        }
        interpolate(drawn, &drawing.previous, &self.particles, fraction);
        let place = Drawn {
            built: self.built,
            state: self.state,
            particles: &self.particles,
            entity,
            targets: &drawing.targets,
            fraction,
        };
        let is_skinned = (drawing.pose).place(&self.built.shared, fraction, drawn);
        place.place(&mut drawing.carriers, is_skinned, drawn);
    }
}

/// Positions at which the particles are drawn: `fraction` of the way from the last tick to this one, in the cloth's
/// frame.
fn interpolate(
    drawn: &mut Vec<Vec3>,
    previous: &[Vec3],
    particles: &ClothParticles,
    fraction: f32,
) {
    drawn.clear();
    if previous.len() == particles.len() {
        let pairs = previous.iter().zip(particles.positions());
        drawn.extend(pairs.map(|(from, to)| from.lerp(to, fraction)));
    } else {
        drawn.extend(particles.positions());
    }
}
