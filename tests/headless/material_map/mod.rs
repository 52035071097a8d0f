//! Cloth whose material differs from place to place, and changes while it moves.

mod density;
mod stiffness;

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::{faults::expect_fault, support::*};

const SIDE: u32 = 9;

const SPACING: f32 = 0.1;

const COMPLIANCE: f32 = 5.0e-3;

fn soft() -> ClothMaterial {
    ClothMaterial {
        stretch_compliance: COMPLIANCE,
        shear_compliance: f32::INFINITY,
        bend_rigidity: 0.0,
        damping: 0.1,
        ..ClothMaterial::COTTON
    }
}

/// Ten times the density below the middle, which is where a sheet gets wet.
fn wet() -> ClothMaterialMap {
    weighed(ClothPaint::at_rest(
        |place| {
            if place.y < -0.35 { 9.0 } else { 0.0 }
        },
    ))
}

fn weighed(added: impl Into<ClothPaint>) -> ClothMaterialMap {
    ClothMaterialMap {
        density: ClothFactor::added(added),
        ..default()
    }
}

/// How far the lower edge hangs below its place (m): each spring carries the rows below it, of which the last is half as wide.
fn exact(factor_of: impl Fn(u32) -> f32) -> f32 {
    let last = SIDE - 1;
    let weight = |row: u32| factor_of(row) * if row == last { 0.5 } else { 1.0 };
    let below = |row: u32| (row + 1..SIDE).map(weight).sum::<f32>();
    let carried: f32 = (0..last).map(below).sum();
    COMPLIANCE * soft().areal_density * 9.81 * SPACING * SPACING * carried
}

fn sag(app: &App, cloth: Entity) -> f32 {
    let lowest = particles(app, cloth).positions().map(|place| place.y);
    -lowest.fold(0.0, f32::min) - (SIDE - 1) as f32 * SPACING
}

fn at(app: &App, cloth: Entity, index: usize) -> Vec3 {
    particles(app, cloth).position(index).expect("a particle")
}

fn sheet() -> Cloth {
    let place = |index: u32| Vec3::new((index % SIDE) as f32, -((index / SIDE) as f32), 0.0);
    let triangles = (0..SIDE * (SIDE - 1)).filter(|a| a % SIDE < SIDE - 1);
    let triangles = triangles.flat_map(|a| {
        let (b, c, d) = (a + 1, a + SIDE, a + SIDE + 1);
        [[a, c, b], [b, c, d]]
    });
    let positions = (0..SIDE * SIDE).map(|index| place(index) * SPACING);
    Cloth::triangles(positions, triangles)
}

/// A grid and a mesh, and how far off the closed form each may hang. A grid is rounded in its last digits, 0.02 of a spring's stretch. A
/// mesh draws in at its free sides and is clamped at its top: as a strip its stiffness is between that of a plate that may draw in, 1, and
/// of one that may not, 9/8.
fn hung_sheets() -> [(&'static str, Cloth, f32); 2] {
    [
        ("grid", Cloth::new(SIDE, SIDE, SPACING), 0.02),
        ("mesh", sheet(), 0.1),
    ]
}

fn top() -> Pins {
    Pins::new([Pin::at_rest(|place| place.y > -1.0e-4)])
}

/// The lower half, five springs of eight, is a fourth as stiff. Of the spring between both halves, half is.
fn soft_below() -> ClothMaterialMap {
    ClothMaterialMap {
        stretch: ClothFactor::of(ClothPaint::at_rest(|place| {
            if place.y < -0.35 { 0.25 } else { 1.0 }
        })),
        ..default()
    }
}

/// On a slope of 0.6, cloth of μ 0.5 slides by g (sin α − μ cos α), and holds where its map doubles that. Of one whose columns have no
/// friction on one side and twice as much on the other, each column slides by itself: it has no springs that pull across.
#[test]
fn friction_follows_its_map() {
    let slope = 0.6_f32.atan();
    let material = ClothMaterial {
        friction: 0.5,
        damping: 0.0,
        shear_compliance: f32::INFINITY,
        bend_rigidity: 0.0,
        weft: Some(ClothWeft {
            stretch_compliance: 1.0e6,
            bend_rigidity: 0.0,
        }),
        ..ClothMaterial::COTTON
    };
    let map = |paint: ClothPaint| ClothMaterialMap {
        friction: ClothFactor::of(paint),
        ..default()
    };
    let sides = ClothPaint::at_rest(|place| if place.x < 0.0 { 0.0 } else { 2.0 });
    let capsule = ClothCollider::capsule(500.0, 1.0);
    let block = ClothCollider::cuboid(20.0, 1.0, 20.0);
    for (name, collider, offset, narrow_phase) in [
        ("plane", ClothCollider::plane(), 0.0, NarrowPhase::Auto),
        ("box", block, 0.5, NarrowPhase::Auto),
        (
            "ball",
            ClothCollider::ball(500.0),
            500.0,
            NarrowPhase::Triangles,
        ),
        ("capsule", capsule, 500.5, NarrowPhase::Triangles),
    ] {
        let mut app = app();
        // Down its columns.
        let down = Vec3::new(0.0, -slope.cos(), slope.sin());
        app.insert_resource(ClothGravity(9.81 * down));
        let below = Transform::from_xyz(0.0, -offset, 0.0);
        app.world_mut().spawn((collider, below));
        let mut spawn = |map: ClothMaterialMap, x: f32| {
            let cloth = Cloth::new(8, 8, 0.05).lying().centred().flat();
            let settings = ClothSettings::default();
            let place = Transform::from_xyz(x, settings.particle_radius, 0.0);
            let bundle = (
                cloth,
                material,
                map,
                Pins::none(),
                settings,
                narrow_phase,
                place,
            );
            app.world_mut().spawn(bundle).id()
        };
        let plain = spawn(default(), -2.0);
        let doubled = spawn(map(2.0.into()), 0.0);
        let sides = spawn(map(sides.clone()), 2.0);
        let speed = |app: &App, cloth, columns: std::ops::Range<usize>| {
            let count = 8 * columns.len();
            let all = columns.flat_map(|column| (0..8).map(move |row| 8 * row + column));
            let all = all.map(|index| particles(app, cloth).velocity(index));
            all.map(|speed| speed.expect("a particle").z).sum::<f32>() / count as f32
        };
        let each = |app: &App| {
            let sides = [0..4, 4..8].map(|columns| speed(app, sides, columns));
            let all = [plain, doubled].map(|cloth| speed(app, cloth, 0..8));
            [all[0], all[1], sides[0], sides[1]]
        };
        tick(&mut app, 8);
        let before = each(&app);
        tick(&mut app, 32);
        let after = each(&app);
        let [plain, doubled, free, held] = [0, 1, 2, 3].map(|at| after[at] - before[at]);
        let fall = |friction: f32| 9.81 * (slope.sin() - friction * slope.cos()) * 32.0 * TICK;
        println!("{name}: {plain:.4} {doubled:.4} {free:.4} {held:.4} m/s");
        // It slides by less than 1.3 m, over which a slope of a radius of 500 m changes by 0.3 %, and its part of the speed by 1 %.
        for (found, exact) in [(plain, fall(0.5)), (free, fall(0.0))] {
            assert!(
                (found / exact - 1.0).abs() < 0.015,
                "{name}: {found} {exact}"
            );
        }
        assert!(
            doubled.abs().max(held.abs()) < 1.0e-3,
            "{name}: {doubled} {held}"
        );
    }
}

/// A snapshot of a grid that has become a mesh since, or the other way round, is restored, and goes on.
#[test]
fn a_snapshot_from_before_a_map_is_restored() {
    for has_map in [false, true] {
        let mut app = app();
        let cloth = (Cloth::new(SIDE, SIDE, SPACING), soft());
        let cloth = app.world_mut().spawn(cloth).id();
        let toggle = |app: &mut App, has_map: bool| {
            let mut cloth = app.world_mut().entity_mut(cloth);
            match has_map {
                true => cloth.insert(soft_below()),
                false => cloth.remove::<ClothMaterialMap>(),
            };
        };
        toggle(&mut app, has_map);
        tick(&mut app, 30);
        let place = |app: &App| at(app, cloth, 60);
        let saved = (
            ClothSnapshot::of(app.world(), cloth).expect("saved"),
            place(&app),
        );
        toggle(&mut app, !has_map);
        tick(&mut app, 30);
        assert_ne!(place(&app), saved.1);
        saved.0.restore(app.world_mut(), cloth).expect("restored");
        tick(&mut app, 1);
        assert!(app.world().get::<ClothFault>(cloth).is_none());
        // As fast as it was, and a tick of gravity.
        let farthest = (particles(&app, cloth).largest_speed() + 9.81 * TICK) * TICK;
        let moved = place(&app).distance(saved.1);
        assert!(moved < farthest, "{moved} {farthest}");
        tick(&mut app, 30);
        assert!(app.world().get::<ClothFault>(cloth).is_none());
    }
}

/// A cloth that sleeps, and one that a hand holds, take over a map; one that is written without a change wakes nobody.
#[test]
fn a_map_wakes_what_sleeps_and_leaves_what_is_held() {
    let mut app = app();
    let hand = app.world_mut().spawn(Transform::default()).id();
    let held = ClothAttachments::new([(Pin::Row(0), hand)]);
    let grid = Cloth::new(SIDE, SIDE, SPACING);
    let bundle = (
        grid,
        Pins::none(),
        soft(),
        held,
        ClothMaterialMap::default(),
    );
    let cloth = app.world_mut().spawn(bundle).id();
    tick(&mut app, 600);
    assert!(stats(&app, cloth).is_asleep);
    change::<ClothMaterialMap>(&mut app, cloth, |map| map.friction = ClothFactor::of(1.0));
    tick(&mut app, 1);
    assert!(stats(&app, cloth).is_asleep, "1 is 1");
    app.world_mut().entity_mut(cloth).insert(soft_below());
    tick(&mut app, 1);
    assert!(!stats(&app, cloth).is_asleep);
    for (from, to) in [(0.0, 0.1), (0.1, 0.0)] {
        let moved = Vec3::new(to, 0.0, 0.0);
        change::<Transform>(&mut app, hand, |hand| hand.translation = moved);
        tick(&mut app, 1);
        // The hand has moved through the tick.
        assert!(at(&app, cloth, 0).distance(moved) < 1.0e-5, "{from} {to}");
        app.world_mut()
            .entity_mut(cloth)
            .remove::<ClothMaterialMap>();
    }
}

/// Two sheets lie on each other, on a plane. Their layers are as far apart as their thickness is there, also after it changes.
#[test]
fn layers_are_as_thick_as_their_map() {
    let thickness = 0.01;
    let thinner = ClothMaterialMap {
        thickness: ClothFactor::of(ClothPaint::at_rest(
            |place| if place.x < 0.0 { 0.3 } else { 1.0 },
        )),
        ..default()
    };
    let material = ClothMaterial {
        bend_rigidity: 0.0,
        ..ClothMaterial::COTTON
    };
    let sheet = |height: f32| {
        (
            Cloth::new(25, 25, 0.025).lying().centred(),
            Transform::from_xyz(0.0, height, 0.0),
            Pins::none(),
            material,
            ClothSelfCollision::of_thickness(thickness),
        )
    };
    let mut app = app();
    app.world_mut()
        .spawn((ClothCollider::plane(), Transform::default()));
    let heights = [0.01, 0.03];
    let sheets = heights.map(|height| {
        let bundle = (sheet(height), thinner.clone());
        app.world_mut().spawn(bundle).id()
    });
    // The mean gap of either half, away from the middle.
    let gaps = |app: &App| {
        let [below, above] = sheets.map(|sheet| particles(app, sheet).positions());
        let begun = heights[1] - heights[0];
        let gap = |(below, above): (Vec3, Vec3)| [below.x, above.y - below.y + begun];
        let all: Vec<[f32; 2]> = below.zip(above).map(gap).collect();
        [-1.0, 1.0].map(|side| {
            let half = all.iter().filter(|of| of[0] * side > 0.1);
            let gaps: Vec<f32> = half.map(|of| of[1]).collect();
            gaps.iter().sum::<f32>() / gaps.len() as f32
        })
    };
    let expect = |app: &App, factors: [f32; 2]| {
        let gaps = gaps(app).map(|gap| gap / thickness);
        println!("{gaps:?} of {factors:?}");
        for (gap, factor) in gaps.into_iter().zip(factors) {
            // Resting layers are up to a twenty-fifth closer.
            let of = gap / factor;
            assert!((0.95..1.1).contains(&of), "{gaps:?} of {factors:?}");
        }
    };
    tick(&mut app, 400);
    expect(&app, [0.3, 1.0]);
    for sheet in sheets {
        change::<ClothMaterialMap>(&mut app, sheet, |map| map.thickness = default());
    }
    // A pair adds velocity only up to 0.25 m/s. Pairs that share particles may add as much again.
    for _ in 0..10 {
        tick(&mut app, 1);
        for sheet in sheets {
            let all = particles(&app, sheet);
            let speeds = (0..all.len()).filter_map(|index| all.velocity(index));
            let fastest = speeds.map(Vec3::length).fold(0.0, f32::max);
            assert!(fastest < 0.5, "{fastest} m/s");
        }
    }
    tick(&mut app, 400);
    expect(&app, [1.0, 1.0]);
    // One of both is thin.
    change::<ClothMaterialMap>(&mut app, sheets[1], |map| map.thickness = thinner.thickness);
    tick(&mut app, 400);
    expect(&app, [0.65, 1.0]);
    for factor in [0.0, 0.05, 1.5, f32::NAN] {
        expect_fault(
            (Cloth::default(), Pins::none()),
            |app, entity| {
                let map = ClothMaterialMap {
                    thickness: ClothFactor::of(factor),
                    ..default()
                };
                app.world_mut().entity_mut(entity).insert(map);
            },
            |error| error.to_string().contains("factor of the thickness"),
            |app, entity| {
                change::<ClothMaterialMap>(app, entity, |map| *map = default());
            },
        );
    }
}
