//! Keeps a mesh on the particles.

use bevy::{
    app::{
        App, FixedFirst, FixedLast, FixedPostUpdate, FixedPreUpdate, FixedUpdate, Plugin,
        PostUpdate,
    },
    asset::{AssetEventSystems, Assets, Handle, RenderAssetUsages},
    ecs::{
        change_detection::{DetectChanges, Ref, Tick},
        component::Component,
        entity::Entity,
        intern::Interned,
        lifecycle::Remove,
        observer::On,
        query::With,
        schedule::{IntoScheduleConfigs, ScheduleLabel, common_conditions::resource_exists},
        system::{Commands, Query, Res, ResMut},
    },
    math::{Affine3A, Vec3},
    mesh::{Indices, Mesh, Mesh3d, PrimitiveTopology, VertexAttributeValues},
    time::{Fixed, Time},
};

use super::{ClothFrame, ClothSystems, ClothTopology, components::ClothTick};
use crate::cloth::{Cloth, ClothGrid, ClothParticles};

/// On a cloth whose [`Mesh3d`] follows its particles; it replaces one that the entity had. Give the entity a
/// material with `double_sided: true` and `cull_mode: None`: cloth is seen from both sides.
#[derive(Component, Debug, Default)]
pub struct ClothMesh {
    handle: Handle<Mesh>,
    grid: ClothGrid,
    /// Positions as the last tick began, in the cloth's frame.
    previous: Vec<Vec3>,
    /// Whether those were remembered from a cloth that slept.
    rested: bool,
    /// Positions to be drawn, in the entity's frame.
    drawn: Vec<Vec3>,
    /// What is drawn of a cloth that sleeps: when its particles were written, and its frame.
    settled: Option<(Tick, ClothFrame)>,
}

/// Gives each cloth a mesh with normals and UVs that follows its particles, updated once a rendered frame and
/// interpolated between two ticks by `overstep_fraction`. Does nothing in an app without meshes.
#[derive(Debug, Clone, Copy)]
pub struct ClothMeshPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl Default for ClothMeshPlugin {
    fn default() -> Self {
        Self::new(FixedUpdate)
    }
}

impl ClothMeshPlugin {
    /// For a [`ClothPlugin`](super::ClothPlugin) in `schedule`.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self {
            schedule: schedule.intern(),
        }
    }
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
        // In any other schedule a tick is a frame, and there is nothing to interpolate.
        let interpolated = fixed.contains(&self.schedule);
        let update = move |cloths: Query<_, _>, time: Res<_>, meshes: ResMut<_>| {
            update_meshes(cloths, time, meshes, interpolated);
        };
        app.add_observer(remove_mesh)
            .add_systems(
                self.schedule,
                remember_positions
                    .after(ClothSystems::Query)
                    .before(ClothSystems::Integrate),
            )
            // Before the asset events, from which Bevy's culling takes the new bounds.
            .add_systems(
                PostUpdate,
                (add_meshes, update)
                    .chain()
                    .after(ClothSystems::WriteBack)
                    .before(AssetEventSystems)
                    .run_if(resource_exists::<Assets<Mesh>>),
            );
    }
}

fn remember_positions(mut cloths: Query<(&ClothParticles, &ClothTick, &mut ClothMesh)>) {
    for (particles, tick, mut mesh) in &mut cloths {
        let rests = tick.rest.is_asleep();
        if !(rests && mesh.rested) {
            mesh.previous.clear();
            mesh.previous.extend(particles.positions());
        }
        mesh.rested = rests;
    }
}

fn add_meshes(
    cloths: Query<(Entity, &ClothTopology, Option<&ClothMesh>)>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut commands: Commands,
) {
    for (entity, topology, mesh) in &cloths {
        let is_right =
            |mesh: &ClothMesh| mesh.grid == topology.grid && meshes.contains(&mesh.handle);
        if topology.grid.is_empty() || mesh.is_some_and(is_right) {
            continue;
        }
        let handle = meshes.add(flat_mesh(&topology.grid));
        let mesh = ClothMesh {
            handle: handle.clone(),
            grid: topology.grid,
            ..Default::default()
        };
        commands.entity(entity).try_insert((Mesh3d(handle), mesh));
    }
}

/// What is no cloth any more is not drawn as one.
fn remove_mesh(
    removed: On<Remove, Cloth>,
    meshes: Query<(), With<ClothMesh>>,
    mut commands: Commands,
) {
    if meshes.contains(removed.entity) {
        commands
            .entity(removed.entity)
            .try_remove::<(ClothMesh, Mesh3d)>();
    }
}

/// The cloth at rest, with room for what changes.
fn flat_mesh(grid: &ClothGrid) -> Mesh {
    let uv = |row: u32, column: u32| {
        [
            column as f32 / (grid.columns() - 1) as f32,
            row as f32 / (grid.rows() - 1) as f32,
        ]
    };
    let positions: Vec<_> = grid
        .cells()
        .map(|(r, c)| grid.rest_position(r, c).to_array())
        .collect();
    let uvs: Vec<_> = grid.cells().map(|(row, column)| uv(row, column)).collect();
    let normals = vec![Vec3::Z.to_array(); grid.len()];
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
    .with_inserted_indices(Indices::U32(grid.triangles().flatten().collect()))
}

fn update_meshes(
    mut cloths: Query<(
        &ClothTopology,
        Ref<ClothParticles>,
        &ClothFrame,
        &ClothTick,
        &mut ClothMesh,
    )>,
    time: Res<Time<Fixed>>,
    mut meshes: ResMut<Assets<Mesh>>,
    interpolated: bool,
) {
    let fraction = if interpolated {
        time.overstep_fraction().min(1.0)
    } else {
        1.0
    };
    for (topology, particles, frame, tick, mut cloth_mesh) in &mut cloths {
        if !tick.sound || !topology.fits(&particles) {
            continue;
        }
        // What sleeps is drawn once.
        let state = (tick.rest.is_asleep() && cloth_mesh.rested)
            .then_some((particles.last_changed(), *frame));
        if state.is_some() && cloth_mesh.settled == state {
            continue;
        }
        let Some(mut mesh) = meshes.get_mut(&cloth_mesh.handle) else {
            continue;
        };
        let ClothMesh {
            previous, drawn, ..
        } = &mut *cloth_mesh;
        if mesh.count_vertices() != particles.len() {
            continue;
        }
        interpolate(drawn, previous, &particles, fraction, &frame.to_entity());
        if let Ok(VertexAttributeValues::Float32x3(values)) =
            mesh.try_attribute_mut(Mesh::ATTRIBUTE_POSITION)
        {
            values
                .iter_mut()
                .zip(&*drawn)
                .for_each(|(value, position)| *value = position.to_array());
        }
        if let Ok(VertexAttributeValues::Float32x3(values)) =
            mesh.try_attribute_mut(Mesh::ATTRIBUTE_NORMAL)
        {
            let normals = topology
                .grid
                .cells()
                .map(|(row, column)| normal(&topology.grid, drawn, row, column));
            values
                .iter_mut()
                .zip(normals)
                .for_each(|(value, normal)| *value = normal.to_array());
        }
        cloth_mesh.settled = state;
    }
}

/// Where the particles are to be drawn: `fraction` of the way from the last tick to this one.
fn interpolate(
    drawn: &mut Vec<Vec3>,
    previous: &[Vec3],
    particles: &ClothParticles,
    fraction: f32,
    to_entity: &Affine3A,
) {
    drawn.clear();
    if previous.len() == particles.len() {
        let pairs = previous.iter().zip(particles.positions());
        drawn.extend(pairs.map(|(from, to)| to_entity.transform_point3(from.lerp(to, fraction))));
    } else {
        drawn.extend(
            particles
                .positions()
                .map(|position| to_entity.transform_point3(position)),
        );
    }
}

/// The normal of the surface through a particle's neighbours, which is +z at rest.
fn normal(grid: &ClothGrid, position: &[Vec3], row: u32, column: u32) -> Vec3 {
    let at = |row, column| position[grid.index(row, column) as usize];
    let along = at(row, (column + 1).min(grid.columns() - 1)) - at(row, column.saturating_sub(1));
    let up = at(row.saturating_sub(1), column) - at((row + 1).min(grid.rows() - 1), column);
    along.cross(up).normalize_or(Vec3::Z)
}
