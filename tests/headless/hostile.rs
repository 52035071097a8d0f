//! Touches and their messages, whatever a game does to cloths and colliders.

use std::{
    collections::{HashMap, HashSet},
    time::Duration,
};

use bevy::{ecs::entity_disabling::Disabled, prelude::*, time::TimeUpdateStrategy};
use bevy_drape::prelude::*;
use proptest::prelude::*;

use crate::support::*;

const CLOTHS: usize = 2;
const COLLIDERS: usize = 3;

/// What is done between two ticks, to one cloth or one collider.
#[derive(Debug, Clone)]
enum Act {
    Move(Vec3),
    Scale(f32),
    Parent,
    Orphan,
    Despawn,
    Disable,
    Enable,
    Layers(u32),
    NoLayers,
    /// Takes away what makes it a cloth or a collider, or gives it back.
    Remove,
    Insert,
    Collider(ClothCollider),
    Settings(ClothSettings),
    NarrowPhase(NarrowPhase),
    Cloth(Cloth),
    Particle(usize, Vec3),
    NoContacts,
    NewContacts,
    Teleport,
    Friction(f32),
    Body(ClothBody),
    NoBody,
    SelfCollision(ClothSelfCollision),
    NoSelfCollision,
}

fn places() -> impl Strategy<Value = Vec3> {
    let near = || prop::array::uniform3(-1.0_f32..1.0).prop_map(Vec3::from);
    prop_oneof![
        12 => near(),
        1 => near().prop_map(|place| place * 1.0e4),
        1 => near().prop_map(|place| place * 1.0e19),
        1 => near().prop_map(|place| place * 3.0e38),
        1 => Just(Vec3::NAN),
        1 => Just(Vec3::INFINITY),
    ]
}

fn lengths() -> impl Strategy<Value = f32> {
    prop_oneof![
        12 => 0.05_f32..0.8,
        1 => Just(1.0e-30),
        1 => Just(1.0e12),
        1 => Just(1.0e30),
        1 => Just(f32::MAX),
        1 => Just(f32::NAN),
        1 => Just(0.0),
    ]
}

fn acts() -> impl Strategy<Value = Act> {
    let colliders = prop_oneof![
        lengths().prop_map(ClothCollider::ball),
        (lengths(), lengths()).prop_map(|(r, l)| ClothCollider::capsule(r, l)),
        (lengths(), lengths(), lengths()).prop_map(|(x, y, z)| ClothCollider::cuboid(x, y, z)),
        Just(ClothCollider::plane()),
        (lengths(), lengths()).prop_map(|(r, h)| ClothCollider::cone(r, h)),
        lengths().prop_map(|size| ClothCollider::convex_hull(corners(size))),
        lengths().prop_map(|size| ClothCollider::trimesh(corners(size), TETRAHEDRON)),
        (lengths(), places(), lengths()).prop_map(|(radius, place, length)| {
            // Turned by a quaternion of whatever length.
            let pose = Isometry3d {
                rotation: Quat::from_xyzw(0.0, length, 0.0, 1.0),
                translation: place.into(),
            };
            let ball = ClothCollider::ball(radius);
            ClothCollider::compound([(Isometry3d::IDENTITY, ball.clone()), (pose, ball)])
        }),
        Just(ClothCollider::mesh()),
    ];
    let bodies = (lengths(), lengths(), lengths(), places()).prop_map(
        |(mass, inertia, axes, centre_of_mass)| ClothBody {
            axes: Quat::from_xyzw(0.0, 0.0, axes, 0.0),
            centre_of_mass,
            locked_rotation: BVec3::new(mass > inertia, false, false),
            ..ClothBody::new(mass, Vec3::new(inertia, 1.0e-3, inertia))
        },
    );
    let narrow = prop_oneof![
        Just(NarrowPhase::Auto),
        Just(NarrowPhase::Particles),
        Just(NarrowPhase::Triangles),
    ];
    let radii = |particle_radius| ClothSettings {
        particle_radius,
        ..default()
    };
    prop_oneof![
        6 => places().prop_map(Act::Move),
        1 => lengths().prop_map(Act::Scale),
        1 => Just(Act::Parent),
        1 => Just(Act::Orphan),
        2 => Just(Act::Despawn),
        1 => Just(Act::Disable),
        2 => Just(Act::Enable),
        1 => prop_oneof![Just(0), Just(1), Just(u32::MAX)].prop_map(Act::Layers),
        1 => Just(Act::NoLayers),
        1 => Just(Act::Remove),
        2 => Just(Act::Insert),
        3 => colliders.prop_map(Act::Collider),
        1 => lengths().prop_map(move |radius| Act::Settings(radii(radius))),
        1 => narrow.prop_map(Act::NarrowPhase),
        1 => (2_u32..9, lengths()).prop_map(|(n, spacing)| Act::Cloth(Cloth::new(n, n, spacing))),
        2 => (0_usize..36, places()).prop_map(|(index, place)| Act::Particle(index, place)),
        1 => Just(Act::NoContacts),
        2 => Just(Act::NewContacts),
        1 => Just(Act::Teleport),
        1 => lengths().prop_map(Act::Friction),
        2 => bodies.prop_map(Act::Body),
        1 => Just(Act::NoBody),
        1 => (lengths(), any::<bool>()).prop_map(|(thickness, with_itself)| {
            // Most are as thick as the cloth's spacing lets them be.
            let thickness = 0.05 * thickness;
            Act::SelfCollision(ClothSelfCollision {
                with_itself,
                ..ClothSelfCollision::of_thickness(thickness)
            })
        }),
        1 => Just(Act::NoSelfCollision),
    ]
}

/// Corners of a tetrahedron, and its faces.
fn corners(size: f32) -> Vec<Vec3> {
    vec![Vec3::ZERO, Vec3::X * size, Vec3::Y * size, Vec3::Z * size]
}

const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

fn cloth() -> impl Bundle {
    (Cloth::new(6, 6, 0.1), Transform::from_xyz(-0.25, 0.25, 0.0))
}

fn act(world: &mut World, entities: &mut [Entity], which: usize, act: Act) {
    let is_cloth = which < CLOTHS;
    let parent = entities[if is_cloth { CLOTHS } else { 0 }];
    let mut entity = world.entity_mut(entities[which]);
    match act {
        Act::Move(place) => {
            if let Some(mut transform) = entity.get_mut::<Transform>() {
                transform.translation = place;
            }
        }
        Act::Scale(scale) => {
            if let Some(mut transform) = entity.get_mut::<Transform>() {
                transform.scale = Vec3::new(scale, 1.0, -1.0);
            }
        }
        // Only cloths are children of colliders, so that nothing is above itself.
        Act::Parent if is_cloth => {
            entity.insert(ChildOf(parent));
        }
        Act::Orphan => {
            entity.remove::<ChildOf>();
        }
        Act::Despawn => {
            entity.despawn();
            for (which, entity) in entities.iter_mut().enumerate() {
                if world.get_entity(*entity).is_err() {
                    *entity = if which < CLOTHS {
                        world.spawn(cloth()).id()
                    } else {
                        world.spawn(ClothCollider::ball(0.2)).id()
                    };
                }
            }
        }
        Act::Disable => {
            entity.insert(Disabled);
        }
        Act::Enable => {
            entity.remove::<Disabled>();
        }
        Act::Layers(memberships) => {
            entity.insert(ClothLayers::new(memberships, u32::MAX));
        }
        Act::NoLayers => {
            entity.remove::<ClothLayers>();
        }
        Act::Remove if is_cloth => {
            entity.remove::<Cloth>();
        }
        Act::Remove => {
            entity.remove::<ClothCollider>();
        }
        Act::Insert if is_cloth => {
            entity.insert(Cloth::new(6, 6, 0.1));
        }
        Act::Insert => {
            entity.insert(ClothCollider::ball(0.3));
        }
        Act::Collider(collider) if !is_cloth => {
            if let Some(mut known) = entity.get_mut::<ClothCollider>() {
                *known = collider;
            }
        }
        Act::Settings(settings) if is_cloth => {
            entity.insert(settings);
        }
        Act::NarrowPhase(narrow_phase) if is_cloth => {
            entity.insert(narrow_phase);
        }
        Act::Cloth(cloth) if is_cloth => {
            entity.insert(cloth);
        }
        Act::Particle(index, place) if is_cloth => {
            if let Some(mut particles) = entity.get_mut::<ClothParticles>()
                && index < particles.len()
            {
                particles
                    .set_position(index, place)
                    .expect("the particle exists");
            }
        }
        Act::NoContacts if is_cloth => {
            entity.remove::<ClothContacts>();
        }
        Act::NewContacts if is_cloth => {
            entity.insert(ClothContacts::default());
        }
        Act::Teleport => {
            entity.insert((ClothTeleport, Transform::from_xyz(0.1, 0.3, 0.0)));
        }
        Act::Friction(friction) if is_cloth => {
            entity.insert(ClothMaterial {
                friction,
                ..ClothMaterial::COTTON
            });
        }
        Act::Body(body) if !is_cloth => {
            entity.insert(body);
        }
        Act::NoBody => {
            entity.remove::<ClothBody>();
        }
        Act::SelfCollision(contact) if is_cloth => {
            entity.insert(contact);
        }
        Act::NoSelfCollision => {
            entity.remove::<ClothSelfCollision>();
        }
        _ => {}
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        max_shrink_iters: 400,
        failure_persistence: None,
        ..ProptestConfig::with_cases(60)
    })]

    /// What starts has not started before, what stops has; what touches now has started; every figure is finite.
    #[test]
    fn touches_start_and_stop_in_turns(
        ticks in prop::collection::vec(
            (prop::collection::vec((0..CLOTHS + COLLIDERS, acts()), 0..4), prop::bool::weighted(0.1)),
            1..40,
        ),
    ) {
        let mut app = app();
        let mut entities = Vec::new();
        for _ in 0..CLOTHS {
            entities.push(app.world_mut().spawn(cloth()).id());
        }
        for which in 0..COLLIDERS {
            let place = Transform::from_xyz(0.2 * which as f32, 0.0, 0.1);
            entities.push(app.world_mut().spawn((ClothCollider::ball(0.2), place)).id());
        }
        let mut touching: HashSet<(Entity, Entity)> = HashSet::new();
        for (acts, is_paused) in ticks {
            for (which, what) in acts {
                act(app.world_mut(), &mut entities, which, what);
            }
            let strategy = if is_paused {
                TimeUpdateStrategy::ManualDuration(Duration::ZERO)
            } else {
                TimeUpdateStrategy::FixedTimesteps(1)
            };
            app.insert_resource(strategy);
            app.update();
            // What a game takes away stops before the tick.
            for stopped in messages::<ClothTouchStopped>(&mut app) {
                let pair = (stopped.cloth, stopped.collider);
                prop_assert!(touching.remove(&pair), "{stopped:?} had not started");
                prop_assert!(stopped.particles > 0 && stopped.deepest_penetration.is_finite());
            }
            for started in messages::<ClothTouchStarted>(&mut app) {
                let pair = (started.cloth, started.collider);
                prop_assert!(touching.insert(pair), "{started:?} had started");
                prop_assert!(started.particles > 0 && started.deepest_penetration.is_finite());
            }
            let mut cloths = app.world_mut().query::<(Entity, &ClothContacts)>();
            let mut now: HashMap<Entity, HashSet<Entity>> = HashMap::new();
            for (cloth, contacts) in cloths.iter(app.world()) {
                for contact in contacts.iter() {
                    let figures = [
                        contact.deepest_penetration,
                        contact.area,
                        contact.volume,
                    ];
                    prop_assert!(figures.iter().all(|figure| figure.is_finite()), "{contact:?}");
                    let given = [contact.impulse, contact.angular_impulse];
                    prop_assert!(given.iter().all(|given| given.is_finite()), "{contact:?}");
                    prop_assert!(
                        contacts.points(contact).iter().all(|point| point.depth < f32::INFINITY),
                        "{contact:?}"
                    );
                    prop_assert!(
                        now.entry(cloth).or_default().insert(contact.collider),
                        "twice: {contact:?}"
                    );
                }
            }
            let mut pushes = app.world_mut().query::<&ClothPush>();
            for push in pushes.iter(app.world()) {
                let is_finite = push.velocity.is_finite() && push.angular_velocity.is_finite();
                prop_assert!(is_finite, "{push:?}");
            }
            for (&cloth, colliders) in &now {
                for &collider in colliders {
                    prop_assert!(touching.contains(&(cloth, collider)), "no message");
                }
            }
        }
    }
}
