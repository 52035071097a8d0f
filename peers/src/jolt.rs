//! Jolt's soft bodies.

use oxijolt::{
    BodyId, BodySettings, LongRangeAttachment, PhysicsWorld, RVec3, Shape, SoftBodyBendType,
    SoftBodyEdge, SoftBodySettings, SoftBodySharedSettings, SoftBodyVertex,
    SoftBodyVertexAttributes, SoftBodyVertexState, Vec3, WorldSettings,
};

use crate::{
    outcome::Places,
    player::Frames,
    scene::{FRAME, FRICTION, Scene},
};

/// Jolt's binding takes no particle of less than a gram, so all masses are this many times as large. Divided by it, compliances
/// give the same motion.
const HEAVIER: f32 = 100.0;

/// How its springs are ordered and its pins are held.
#[derive(Debug, Clone, Copy)]
pub struct Setting {
    pub iterations: u32,
    /// The order of its springs, which Jolt sorts by their distance from a pin, or, without, by the numbers of vertices.
    pub is_shuffled: bool,
    /// Pinned after springs are sorted.
    pub late_pins: bool,
    /// To the nearest pin (Jolt: long range attachments).
    pub tethers: bool,
}

pub struct Jolt {
    world: PhysicsWorld,
    body: BodyId,
    /// The vertex of each particle.
    vertices: Vec<u32>,
    seen: Vec<SoftBodyVertexState>,
}

impl Jolt {
    pub fn new(scene: &Scene, setting: Setting, start: u32) -> Self {
        let told = scene.told(start);
        let count = told.positions.len();
        let vertices = if setting.is_shuffled {
            shuffled(count)
        } else {
            (0..count as u32).collect()
        };
        let mut settings = vec![SoftBodyVertex::new(Vec3::ZERO); count];
        for (index, (place, mass)) in told.positions.iter().zip(&told.masses).enumerate() {
            let is_kinematic = !setting.late_pins && told.pinned.contains(&(index as u32));
            settings[vertices[index] as usize] = SoftBodyVertex {
                position: Vec3::new(place[0], place[1], place[2]),
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
        let mut builder = SoftBodySharedSettings::builder(settings, faces);
        if scene.compliance == 0.0 {
            let attachment = if setting.tethers {
                LongRangeAttachment::EuclideanDistance
            } else {
                LongRangeAttachment::None
            };
            let attributes =
                SoftBodyVertexAttributes::default().long_range_attachment(attachment, 1.0);
            builder = builder.create_constraints(SoftBodyBendType::None, attributes);
        } else {
            for (ends, compliance) in told.springs.iter().zip(&told.compliances) {
                builder = builder.edge(SoftBodyEdge {
                    vertices: ends.map(|end| vertices[end as usize]),
                    compliance: compliance / HEAVIER,
                });
            }
        }
        let shared = builder.build().expect("a valid soft body");
        let settings = SoftBodySettings::default()
            .num_iterations(setting.iterations)
            .linear_damping(0.0)
            .friction(FRICTION)
            .vertex_radius(0.0)
            .update_position(scene.ball.is_some())
            .allow_sleeping(false);
        let world = WorldSettings::default()
            .single_threaded()
            .gravity(Vec3::new(0.0, -told.gravity, 0.0));
        let mut world = PhysicsWorld::new(world).expect("a valid world");
        if let Some(radius) = scene.ball {
            let shape = Shape::new_sphere(radius).expect("a valid ball");
            let ball = BodySettings::new_static()
                .position(RVec3::ZERO)
                .friction(FRICTION);
            world.create_body(&shape, &ball).expect("there is room");
        }
        let body = world
            .create_soft_body(&shared, &settings)
            .expect("there is room");
        if setting.late_pins {
            let mut soft = world.soft_body_mut(body).expect("it is soft");
            for &pin in &told.pinned {
                soft.set_vertex_inverse_mass(vertices[pin as usize], 0.0)
                    .expect("it exists");
            }
        }
        Self {
            world,
            body,
            vertices,
            seen: Vec::new(),
        }
    }
}

impl Frames for Jolt {
    fn step(&mut self) {
        let report = self.world.step(FRAME).expect("a valid step");
        assert!(report.is_complete(), "Jolt dropped contacts");
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
