//! Jolt's soft bodies.

use oxijolt::{
    BodyId, BodySettings, LongRangeAttachment, PhysicsWorld, Quat, RVec3, Shape, SoftBodyBendType,
    SoftBodyDihedralBend, SoftBodyEdge, SoftBodySettings, SoftBodySharedSettings,
    SoftBodySharedSettingsBuilder, SoftBodyVertex, SoftBodyVertexAttributes, SoftBodyVertexState,
    Vec3, WorldSettings,
};

use crate::{
    collider::{self, Collider},
    outcome::Places,
    player::Frames,
    told::Told,
};

/// Jolt's binding takes no particle of less than a gram, so all masses are this many times as large. Divided by it, compliances
/// give the same motion; pressures are multiplied by it.
const HEAVIER: f32 = 100.0;

/// Half of the width and depth of a floor (m), which Jolt does not make endless.
const FLOOR: f32 = 100.0;

/// How its springs are made and ordered and its pins are held.
#[derive(Debug, Clone, Copy)]
pub struct Setting {
    pub iterations: u32,
    /// By Jolt's own function, with one compliance for all edges and one for all folds; without, by the list of the scene. Rigid
    /// ones always are.
    pub is_generated: bool,
    /// The order of its springs, which Jolt sorts by their distance from a pin, or, without, by the numbers of vertices.
    pub is_shuffled: bool,
    /// Pinned after springs are sorted.
    pub late_pins: bool,
    /// To the nearest pin (Jolt: long range attachments), in springs of its own function.
    pub tethers: Option<LongRangeAttachment>,
}

pub struct Jolt {
    world: PhysicsWorld,
    body: BodyId,
    moving: Vec<(BodyId, Collider)>,
    frame: u32,
    /// s
    seconds: f32,
    /// The vertex of each particle.
    vertices: Vec<u32>,
    seen: Vec<SoftBodyVertexState>,
}

impl Jolt {
    /// # Errors
    /// The input that Jolt refuses.
    pub fn new(told: &Told, setting: Setting) -> Result<Self, String> {
        let vertices = if setting.is_shuffled {
            shuffled(told.positions.len())
        } else {
            (0..told.positions.len() as u32).collect()
        };
        // A body that may move away from its origin lies around it.
        let origin = if told.pinned.is_empty() {
            centre(&told.positions)
        } else {
            [0.0; 3]
        };
        let shared = shared(told, setting, &vertices, origin)?;
        let settings = SoftBodySettings::default()
            .position(RVec3::from(origin))
            .num_iterations(setting.iterations)
            .linear_damping(told.damping)
            .friction(told.friction)
            .vertex_radius(told.margin)
            .pressure(HEAVIER * told.gas)
            .update_position(told.pinned.is_empty())
            .allow_sleeping(false);
        let world = WorldSettings::default()
            .single_threaded()
            .gravity(Vec3::new(0.0, -told.gravity, 0.0));
        let mut world = PhysicsWorld::new(world).map_err(|error| error.to_string())?;
        let mut moving = Vec::new();
        for collider in &told.colliders {
            let body = spawn(&mut world, collider, told.friction)?;
            if collider.moves {
                moving.push((body, *collider));
            }
        }
        let body = world
            .create_soft_body(&shared, &settings)
            .map_err(|error| error.to_string())?;
        if setting.late_pins {
            let mut soft = world.soft_body_mut(body).expect("it is soft");
            for &pin in &told.pinned {
                soft.set_vertex_inverse_mass(vertices[pin as usize], 0.0)
                    .expect("it exists");
            }
        }
        Ok(Self {
            world,
            body,
            moving,
            frame: 0,
            seconds: told.frame,
            vertices,
            seen: Vec::new(),
        })
    }
}

impl Frames for Jolt {
    fn step(&mut self) -> Result<(), String> {
        self.frame += 1;
        for (body, collider) in &self.moving {
            let (place, turn) = pose(collider, self.frame as f32 * self.seconds);
            let mut body = self.world.body_mut(*body).expect("it exists");
            body.move_kinematic(place, turn, self.seconds)
                .map_err(|error| error.to_string())?;
        }
        let report = self.world.step(self.seconds);
        let report = report.map_err(|error| error.to_string())?;
        if report.is_complete() {
            Ok(())
        } else {
            Err("it dropped contacts".into())
        }
    }

    fn places(&mut self) -> Places {
        let soft = self.world.soft_body(self.body).expect("it is soft");
        soft.vertices_into(&mut self.seen);
        let place = |vertex: &u32| {
            let at = self.seen[*vertex as usize].position;
            [at.x, at.y, at.z]
        };
        self.vertices.iter().map(place).collect()
    }
}

/// The vertices and what holds them together.
fn shared(
    told: &Told,
    setting: Setting,
    vertices: &[u32],
    origin: [f32; 3],
) -> Result<SoftBodySharedSettings, String> {
    let mut settings = vec![SoftBodyVertex::new(Vec3::ZERO); vertices.len()];
    for (index, (place, mass)) in told.positions.iter().zip(&told.masses).enumerate() {
        let is_kinematic = !setting.late_pins && told.pinned.contains(&(index as u32));
        settings[vertices[index] as usize] = SoftBodyVertex {
            position: Vec3::new(
                place[0] - origin[0],
                place[1] - origin[1],
                place[2] - origin[2],
            ),
            velocity: Vec3::ZERO,
            inverse_mass: if is_kinematic {
                0.0
            } else {
                1.0 / (HEAVIER * mass)
            },
        };
    }
    let faces = told
        .triangles
        .iter()
        .map(|corners| corners.map(|corner| vertices[corner as usize]))
        .collect();
    let builder = SoftBodySharedSettings::builder(settings, faces);
    let builder = if told.is_rigid() || setting.is_generated {
        generated(builder, told, setting)
    } else {
        listed(builder, told, vertices)
    };
    builder.build().map_err(|error| error.to_string())
}

/// By Jolt's function, with the mean compliances of the scene's list.
fn generated(
    builder: SoftBodySharedSettingsBuilder,
    told: &Told,
    setting: Setting,
) -> SoftBodySharedSettingsBuilder {
    let mean = |of: &mut dyn ExactSizeIterator<Item = f32>| {
        let count = of.len() as f32;
        of.sum::<f32>() / count
    };
    let stretch = mean(&mut told.compliances.iter().copied()) / HEAVIER;
    let mut stiffnesses = told.hinges.iter().map(|hinge| hinge.stiffness);
    let (bend, folding) = if told.hinges.is_empty() {
        (SoftBodyBendType::None, None)
    } else {
        let compliance = 1.0 / (HEAVIER * mean(&mut stiffnesses));
        (SoftBodyBendType::Dihedral, Some(compliance))
    };
    let attachment = setting.tethers.unwrap_or(LongRangeAttachment::None);
    let attributes = SoftBodyVertexAttributes::default()
        .compliance(stretch)
        .shear_compliance(stretch)
        .bend_compliance(folding)
        .long_range_attachment(attachment, 1.0);
    builder.create_constraints(bend, attributes)
}

/// By the scene's own list.
fn listed(
    mut builder: SoftBodySharedSettingsBuilder,
    told: &Told,
    vertices: &[u32],
) -> SoftBodySharedSettingsBuilder {
    for (ends, compliance) in told.springs.iter().zip(&told.compliances) {
        builder = builder.edge(SoftBodyEdge {
            vertices: ends.map(|end| vertices[end as usize]),
            compliance: compliance / HEAVIER,
        });
    }
    for hinge in &told.hinges {
        builder = builder.dihedral_bend(SoftBodyDihedralBend {
            vertices: hinge.vertices.map(|vertex| vertices[vertex as usize]),
            compliance: 1.0 / (HEAVIER * hinge.stiffness),
        });
    }
    builder
}

fn spawn(world: &mut PhysicsWorld, collider: &Collider, friction: f32) -> Result<BodyId, String> {
    let shape = match collider.shape {
        collider::Shape::Ball(radius) => Shape::new_sphere(radius),
        collider::Shape::Capsule { radius, length } => Shape::new_capsule(0.5 * length, radius),
        collider::Shape::Cuboid(sides) => {
            let [x, y, z] = (0.5 * sides).to_array();
            Shape::new_box(Vec3::new(x, y, z))
        }
        collider::Shape::Floor => Shape::new_plane(Vec3::new(0.0, 1.0, 0.0), 0.0, FLOOR),
    };
    let shape = shape.map_err(|error| error.to_string())?;
    let settings = if collider.moves {
        BodySettings::new_kinematic()
    } else {
        BodySettings::new_static()
    };
    let (place, turn) = pose(collider, 0.0);
    let settings = settings.position(place).rotation(turn).friction(friction);
    let body = world.create_body(&shape, &settings);
    body.map_err(|error| error.to_string())
}

fn pose(collider: &Collider, seconds: f32) -> (RVec3, Quat) {
    let at = (collider.at)(seconds);
    let turn = Quat::from(at.rotation.normalize().to_array());
    (RVec3::from(at.translation.to_array()), turn)
}

fn centre(positions: &[[f32; 3]]) -> [f32; 3] {
    let sum = |axis: usize| positions.iter().map(|place| place[axis]).sum::<f32>();
    [0, 1, 2].map(|axis| sum(axis) / positions.len() as f32)
}

/// The numbers below `count` in an order that is random and always the same.
fn shuffled(count: usize) -> Vec<u32> {
    let mut all: Vec<u32> = (0..count as u32).collect();
    let mut random = 1_u64;
    for last in (1..count).rev() {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        all.swap(last, (random >> 33) as usize % (last + 1));
    }
    all
}
