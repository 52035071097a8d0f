//! rapier-cloth: position-based cloth beside Rapier's rigid bodies.

use std::collections::BTreeMap;

use bevy::math::Vec3;
use rapier_cloth::{
    Cloth, ClothHandle, ClothMaterial, ClothMesh, RapierClothWorld, RapierScene, SceneSnapshot,
    WorldId,
    rapier::prelude::{
        ColliderBuilder, PhysicsWorld, Pose, QueryFilter, RigidBodyBuilder, RigidBodyHandle,
        SharedShape,
    },
};

use crate::{
    collider::{Collider, Shape},
    outcome::Places,
    player::Frames,
    told::Told,
};

/// How far a body may move in a sub-step, in radii of a particle. Its default of a half would refuse legs at four sub-steps a frame.
const MOTION: f32 = 4.0;

/// A compliance of one for what is scaled to its own.
const ONE: f32 = 1.0;

#[derive(Debug, Clone, Copy)]
pub struct Setting {
    /// Sub-steps of a frame, in each of which Rapier steps, too.
    pub substeps: u32,
    pub iterations: usize,
    /// Rigid edges, as is its default. Only with them does it bound the distance of each vertex from the pins.
    pub is_rigid: bool,
}

pub struct RapierCloth {
    world: WorldId,
    rigid: PhysicsWorld,
    cloths: RapierClothWorld,
    cloth: ClothHandle,
    moving: Vec<(RigidBodyHandle, Collider)>,
    substeps: u32,
    /// Sub-steps until now.
    done: u64,
    /// Of a sub-step (s).
    seconds: f32,
    gas: f32,
}

impl RapierCloth {
    /// # Errors
    /// The input that it refuses.
    pub fn new(told: &Told, setting: Setting) -> Result<Self, String> {
        let world = WorldId::new();
        let seconds = told.frame / setting.substeps as f32;
        let mut rigid = PhysicsWorld::new();
        rigid.integration_parameters.dt = seconds;
        rigid.gravity = [0.0, -told.gravity, 0.0].into();
        let mut moving = Vec::new();
        for collider in &told.colliders {
            let shape = shape(collider.shape);
            let shape = ColliderBuilder::new(shape).friction(told.friction);
            let body = if collider.moves {
                RigidBodyBuilder::kinematic_position_based()
            } else {
                RigidBodyBuilder::fixed()
            };
            let (body, _) = rigid.insert(body.pose(pose(collider, 0.0)), shape);
            if collider.moves {
                moving.push((body, *collider));
            }
        }
        let mut cloths = RapierClothWorld::new(world);
        cloths.solver_settings.iterations = setting.iterations;
        cloths.collision_settings.motion_limit_ratio = MOTION;
        let cloth = cloth(told, setting).map_err(|error| error.to_string())?;
        let cloth = cloths.add_cloth(cloth);
        Ok(Self {
            world,
            rigid,
            cloths,
            cloth,
            moving,
            substeps: setting.substeps,
            done: 0,
            seconds,
            gas: told.gas,
        })
    }

    fn substep(&mut self) -> Result<(), String> {
        if self.gas > 0.0 {
            self.inflate().map_err(|error| error.to_string())?;
        }
        let rigid = &mut self.rigid;
        let before = SceneSnapshot::capture(self.world, self.done, &rigid.bodies, &rigid.colliders);
        self.done += 1;
        for (body, collider) in &self.moving {
            let place = pose(collider, self.done as f32 * self.seconds);
            rigid.bodies[*body].set_next_kinematic_position(place);
        }
        rigid.step();
        let query = rigid.broad_phase.as_query_pipeline(
            rigid.narrow_phase.query_dispatcher(),
            &rigid.bodies,
            &rigid.colliders,
            QueryFilter::default(),
        );
        let scene = RapierScene::new(query, &before, self.seconds, rigid.gravity);
        let report = self.cloths.step_substep(self.seconds, &scene);
        report.map(|_| ()).map_err(|error| error.to_string())
    }

    /// Sets the force of the gas on each vertex, as a game has to: it has no pressure of its own.
    fn inflate(&mut self) -> Result<(), rapier_cloth::ClothError> {
        let cloth = self.cloths.cloth_mut(self.cloth)?;
        let places = cloth.positions();
        let mut forces = vec![rapier_cloth::Vec3::ZERO; places.len()];
        let mut volume = 0.0;
        for triangle in cloth.mesh().triangles() {
            let [a, b, c] = triangle.map(|corner| places[corner as usize]);
            volume += a.dot(b.cross(c)) / 6.0;
            let push = (b - a).cross(c - a) / 6.0;
            for corner in triangle {
                forces[*corner as usize] += push;
            }
        }
        for (vertex, force) in (0..).zip(forces) {
            cloth.set_force(vertex, force * (self.gas / volume))?;
        }
        Ok(())
    }
}

impl Frames for RapierCloth {
    fn step(&mut self) -> Result<(), String> {
        (0..self.substeps).try_for_each(|_| self.substep())
    }

    fn places(&mut self) -> Places {
        let cloth = self.cloths.cloth(self.cloth).expect("it was added");
        let places = cloth.positions().iter();
        places.map(rapier_cloth::Vec3::to_array).collect()
    }
}

fn cloth(told: &Told, setting: Setting) -> Result<Cloth, rapier_cloth::ClothError> {
    let places = told.positions.iter();
    let places: Vec<rapier_cloth::Vec3> = places
        .map(|place| rapier_cloth::Vec3::from_array(*place))
        .collect();
    let mut mesh = ClothMesh::new(places.clone(), told.triangles.clone())?;
    let sorted = |a: u32, b: u32| [a.min(b), a.max(b)];
    let springs = told.springs.iter().zip(&told.compliances);
    let compliances: BTreeMap<[u32; 2], f32> = springs
        .map(|(&[a, b], compliance)| (sorted(a, b), *compliance))
        .collect();
    let hinges = told.hinges.iter();
    let stiffnesses: BTreeMap<[u32; 2], f32> = hinges
        .map(|hinge| {
            let [a, b, ..] = hinge.vertices;
            (sorted(a, b), hinge.stiffness)
        })
        .collect();
    // Each edge and each fold has what the scene's list says.
    let is_rigid = setting.is_rigid || told.is_rigid();
    if !is_rigid {
        mesh.scale_edge_compliance(|edge| {
            let [a, b] = edge.vertices;
            compliances.get(&sorted(a, b)).copied().unwrap_or(ONE)
        })?;
    }
    if !told.hinges.is_empty() {
        mesh.scale_hinge_stiffness(|hinge| {
            let [a, b, ..] = hinge.vertices;
            stiffnesses.get(&sorted(a, b)).copied().unwrap_or(ONE)
        })?;
    }
    let mass: f32 = told.masses.iter().sum();
    let material = ClothMaterial {
        surface_density: mass / mesh.area(),
        stretch_compliance: if is_rigid { 0.0 } else { ONE },
        bend_compliance: ONE,
        damping: told.damping,
        friction: told.friction,
        contact_radius: told.margin,
        ..ClothMaterial::default()
    };
    let mut cloth = Cloth::new(mesh, material)?;
    for &pin in &told.pinned {
        cloth.pin(pin, places[pin as usize])?;
    }
    Ok(cloth)
}

fn shape(shape: Shape) -> SharedShape {
    match shape {
        Shape::Ball(radius) => SharedShape::ball(radius),
        Shape::Capsule { radius, length } => SharedShape::capsule_y(0.5 * length, radius),
        Shape::Cuboid(sides) => {
            let [x, y, z] = (0.5 * sides).to_array();
            SharedShape::cuboid(x, y, z)
        }
        Shape::Floor => SharedShape::halfspace(Vec3::Y.to_array().into()),
    }
}

fn pose(collider: &Collider, seconds: f32) -> Pose {
    let at = (collider.at)(seconds);
    let [x, y, z, w] = at.rotation.normalize().to_array();
    let turn = rapier_cloth::rapier::prelude::Rotation::from_xyzw(x, y, z, w);
    Pose::from_parts(at.translation.to_array().into(), turn)
}
