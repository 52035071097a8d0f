//! What a tick leaves behind besides the state matters to nothing.

use bevy::prelude::*;
use bevy_drape::{
    plugin::{ClothBuilt, ClothScratch},
    prelude::*,
};

use crate::{
    mesh::vertices,
    meshes::sheets::{sheet, sheet_asset},
    support::*,
};

/// What is pushed along z, and what is pushed sideways from a tick on.
#[derive(Component)]
struct Pushed {
    speed: Vec3,
    from: usize,
}

/// What is done before each tick.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Dropped {
    Nothing,
    Scratch,
    /// What was built, once.
    Built(usize),
}

/// All that is seen of a tick.
type Tick = Vec<(ClothParticles, Vec<(ClothContact, Vec<ContactPoint>)>)>;

/// The tick in which the sleeper is woken.
const WOKEN: usize = 330;
const TICKS: usize = 400;

/// Grids and meshes with balls that pass, a cloth that falls asleep on a ball and is woken by it, one that is attached, one
/// that teleports, one that holds a tolerance, one of which the material changes.
struct Busy {
    app: App,
    cloths: Vec<Entity>,
    sleeper: Entity,
}

impl Busy {
    fn new() -> Self {
        let mut app = app_that_draws(FixedUpdate);
        let push = |mut pushed: Query<(&mut Pushed, &mut Transform)>, time: Res<Time>| {
            for (mut pushed, mut place) in &mut pushed {
                if pushed.from == 0 {
                    place.translation += pushed.speed * time.delta_secs();
                } else {
                    pushed.from -= 1;
                }
            }
        };
        app.add_systems(FixedUpdate, push.before(ClothSystems::Prepare));
        let mesh = app
            .world_mut()
            .resource_mut::<Assets<Mesh>>()
            .add(sheet_asset(9, 8));
        let (positions, triangles) = sheet(8, 8);
        let at = Transform::from_xyz;
        let world = app.world_mut();
        let pole = (
            at(20.0, 0.0, 0.0),
            Pushed {
                speed: Vec3::new(0.1, 0.2, 0.3),
                from: 40,
            },
        );
        let pole = world.spawn((pole, Name::new("pole"))).id();
        let edge = || Pins::new([Pin::at_rest(|place| place.z < 0.01)]);
        let ball = |radius| ClothCollider::ball(radius);
        // Passed by balls, of which one is small and fast.
        let passed = [
            world.spawn((Cloth::default(), at(0.0, 0.0, 0.0))).id(),
            world
                .spawn((
                    Cloth::mesh(),
                    Mesh3d(mesh.clone()),
                    edge(),
                    at(5.0, 0.0, 0.0),
                ))
                .id(),
        ];
        for (x, y, z, radius, speed) in [
            (0.75, -1.0, -2.2, 0.4, Vec3::Z * 2.2),
            (0.4, -0.6, -3.0, 0.07, Vec3::Z * 9.0),
            (5.4, -0.4, -2.0, 0.2, Vec3::Z * 1.5),
            (5.2, -3.0, 0.1, 0.08, Vec3::Y * 4.0),
        ] {
            world.spawn((ball(radius), at(x, y, z), Pushed { speed, from: 30 }));
        }
        // Sleeps on a ball.
        let corners = Pins::new([
            Pin::Corner(Corner::TopLeft),
            Pin::Corner(Corner::BottomRight),
        ]);
        let sleeper = (
            Cloth::new(9, 9, 0.1).lying().centred(),
            corners,
            ClothMaterial {
                damping: 0.05,
                ..default()
            },
            at(10.0, 0.0, 0.0),
        );
        let sleeper = world.spawn(sleeper).id();
        let woken = Pushed {
            speed: Vec3::new(0.3, 0.4, 0.0),
            from: WOKEN,
        };
        world.spawn((ball(0.3), at(10.0, -0.35, 0.0), woken));
        // Attached; and one that holds a tolerance, and touches a ball.
        let pin = Pin::at_rest(|place| place.x < 0.01);
        let attached = (
            Cloth::mesh(),
            Mesh3d(mesh),
            ClothAttachments::new([(pin, "pole")]),
        );
        let attached = world.spawn((attached, at(20.0, 0.0, 0.0))).id();
        let triangles = Cloth::triangles(positions, triangles);
        let exact = (
            triangles.clone(),
            edge(),
            ClothSettings::tolerance(0.02),
            at(30.0, 0.0, 0.0),
        );
        let exact = world.spawn(exact).id();
        world.spawn((ball(0.15), at(30.3, -0.4, 0.3)));
        let jumping = world
            .spawn((Cloth::new(7, 9, 0.1), at(40.0, 0.0, 0.0), pole_of(pole)))
            .id();
        let changing = world.spawn((triangles, edge(), at(50.0, 0.0, 0.0))).id();
        let mut cloths = vec![sleeper, attached, exact, jumping, changing];
        cloths.extend(passed);
        Self {
            app,
            cloths,
            sleeper,
        }
    }

    fn tick(&mut self, number: usize, dropped: Dropped) -> Tick {
        let [jumping, changing] = [self.cloths[3], self.cloths[4]];
        match number {
            100 => {
                let there = (Transform::from_xyz(42.0, 1.0, 0.0), ClothTeleport);
                self.app.world_mut().entity_mut(jumping).insert(there);
            }
            110 => change::<Transform>(&mut self.app, jumping, |place| place.translation.x += 0.02),
            150 => change::<ClothMaterial>(&mut self.app, changing, |material| {
                *material = ClothMaterial::RUBBER;
            }),
            170 => change::<ClothMaterial>(&mut self.app, changing, |material| {
                material.areal_density *= 2.0;
            }),
            _ => {}
        }
        for &cloth in &self.cloths {
            match dropped {
                Dropped::Scratch => change::<ClothScratch>(&mut self.app, cloth, |scratch| {
                    *scratch = ClothScratch::default();
                }),
                Dropped::Built(at) if at == number => {
                    let mut cloth = self.app.world_mut().entity_mut(cloth);
                    cloth.insert(ClothBuilt::default());
                }
                _ => {}
            }
        }
        tick(&mut self.app, 1);
        let world = self.app.world();
        let of = |cloth: &Entity| {
            assert!(world.get::<ClothFault>(*cloth).is_none());
            let contacts = world.get::<ClothContacts>(*cloth).expect("contacts");
            let contact = |contact: &ClothContact| (*contact, contacts.points(contact).to_vec());
            let contacts = contacts.iter().map(contact).collect();
            (particles(&self.app, *cloth).clone(), contacts)
        };
        self.cloths.iter().map(of).collect()
    }
}

/// A pin of the last column that follows a pole, besides the top row.
fn pole_of(pole: Entity) -> ClothAttachments {
    ClothAttachments::new([(Pin::Cell(8, 6), pole)])
}

/// With its scratch memory dropped before each tick every cloth goes on as it would have, and is drawn so.
#[test]
fn scratch_memory_may_be_dropped() {
    let (mut kept, mut dropped) = (Busy::new(), Busy::new());
    let (mut touched, mut slept_on, mut woke) = (vec![false; 7], false, false);
    for number in 0..TICKS {
        let expected = kept.tick(number, Dropped::Nothing);
        let found = dropped.tick(number, Dropped::Scratch);
        for (index, (expected, found)) in expected.iter().zip(&found).enumerate() {
            assert!(
                expected.0 == found.0,
                "particles of {index} in tick {number}"
            );
            assert_eq!(expected.1, found.1, "contacts of {index} in tick {number}");
            let cloths = [
                (&kept, kept.cloths[index]),
                (&dropped, dropped.cloths[index]),
            ];
            let drawn =
                cloths.map(|(run, cloth)| vertices(&run.app, cloth, Mesh::ATTRIBUTE_POSITION));
            assert_eq!(drawn[0], drawn[1], "vertices of {index} in tick {number}");
            touched[index] |= !expected.1.is_empty();
        }
        let is_asleep = stats(&kept.app, kept.sleeper).is_asleep;
        assert_eq!(is_asleep, stats(&dropped.app, dropped.sleeper).is_asleep);
        slept_on |= is_asleep && !expected[0].1.is_empty();
        woke |= number > WOKEN && !is_asleep && slept_on;
    }
    assert!(
        slept_on && woke,
        "asleep on a ball {slept_on}, woken {woke}"
    );
    assert_eq!(touched, [true, false, true, false, false, true, true]);
}

/// What was built is built anew where it is gone, and the particles go on from where they were.
#[test]
fn what_was_built_may_be_dropped() {
    const DROPPED: usize = 60;
    let (mut kept, mut dropped) = (Busy::new(), Busy::new());
    let mut differ = [false; 7];
    for number in 0..DROPPED + 30 {
        let expected = kept.tick(number, Dropped::Nothing);
        let found = dropped.tick(number, Dropped::Built(DROPPED));
        for (index, ((expected, _), (found, _))) in expected.iter().zip(&found).enumerate() {
            assert!(number >= DROPPED || expected == found);
            differ[index] |= expected != found;
            let places = expected.positions().zip(found.positions());
            let farthest = places
                .map(|(one, other)| one.distance(other))
                .fold(0.0, f32::max);
            // A cloth at rest would be metres away.
            assert!(farthest < 0.2, "{index} in tick {number}: {farthest}");
        }
    }
    println!("other bits once what was built was dropped: {differ:?}");
}
