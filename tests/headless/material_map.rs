//! Cloth whose material differs from place to place, and changes while it moves.

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

/// It hangs lower by what its compliance says, whether it was spawned wet, gets wet asleep, or dries again.
#[test]
fn a_wet_sheet_hangs_lower() {
    let dry = exact(|_| 1.0);
    let soaked = exact(|row| if row > 3 { 10.0 } else { 1.0 });
    for (kind, cloth, allowed) in hung_sheets() {
        let top = top();
        let mut app = app();
        let spawned = (cloth.clone(), top.clone(), soft(), wet());
        let spawned = app.world_mut().spawn(spawned).id();
        let cloth = app.world_mut().spawn((cloth, top, soft())).id();
        tick(&mut app, 600);
        let expect = |app: &App, cloth, exact: f32| {
            let found = sag(app, cloth);
            println!(
                "{kind}: {:.2} mm, closed form {:.2} mm",
                1.0e3 * found,
                1.0e3 * exact
            );
            assert!(
                (found / exact - 1.0).abs() < allowed,
                "{kind}: {found} {exact}"
            );
        };
        expect(&app, spawned, soaked);
        expect(&app, cloth, dry);
        assert!(stats(&app, cloth).is_asleep, "{kind}");
        app.world_mut().entity_mut(cloth).insert(wet());
        tick(&mut app, 600);
        expect(&app, cloth, soaked);
        // A particle that was held in between has its wet mass again.
        let hand = app.world_mut().spawn(Transform::default()).id();
        let held = ClothAttachments::new([(Pin::Vertex(76), hand)]);
        app.world_mut().entity_mut(cloth).insert(held);
        tick(&mut app, 2);
        app.world_mut()
            .entity_mut(cloth)
            .remove::<ClothAttachments>();
        tick(&mut app, 2);
        let masses = |cloth| {
            particles(&app, cloth)
                .inverse_masses()
                .collect::<Vec<f32>>()
        };
        assert_eq!(masses(cloth), masses(spawned), "{kind}");
        app.world_mut()
            .entity_mut(cloth)
            .remove::<ClothMaterialMap>();
        tick(&mut app, 600);
        expect(&app, cloth, dry);
    }
}

/// Weight that changes in every tick moves nothing by itself: what falls goes on to fall, v = g t.
#[test]
fn weight_that_changes_leaves_velocities_alone() {
    for cloth in [Cloth::new(SIDE, SIDE, SPACING), sheet()] {
        let mut app = app();
        let bundle = (cloth, Pins::none(), soft(), ClothMaterialMap::default());
        let cloth = app.world_mut().spawn(bundle).id();
        tick(&mut app, 1);
        let speed =
            |app: &App, index: usize| particles(app, cloth).velocity(index).expect("a particle").y;
        let before = speed(&app, 40);
        for at in 0..64 {
            let wet = at as f32 / 64.0;
            let paint = ClothPaint::at_rest(move |place| if place.y < -0.35 { wet } else { 0.0 });
            change::<ClothMaterialMap>(&mut app, cloth, |map| map.density.paint = paint);
            tick(&mut app, 1);
        }
        // Rounding of 1,280 displacements by 2⁻²⁴ each is 8·10⁻⁵.
        for index in [0, 40, 80] {
            let gained = speed(&app, index) - before;
            assert!((gained / -9.81 - 1.0).abs() < 2.0e-4, "{index}: {gained}");
        }
        let masses = particles(&app, cloth)
            .inverse_masses()
            .map(|inverse| 1.0 / inverse);
        // Of nine rows, five have nearly twice the weight; the last of them is half as wide: 4.5 of 8.
        let dry = soft().areal_density * (8.0 * SPACING).powi(2);
        let ratio = masses.sum::<f32>() / dry;
        let expected = 1.0 + 63.0 / 64.0 * 4.5 / 8.0;
        assert!(
            (ratio / expected - 1.0).abs() < 1.0e-2,
            "{ratio} {expected}"
        );
    }
}

#[test]
fn a_density_that_cannot_be() {
    let mend = |app: &mut App, entity: Entity| {
        change::<ClothMaterialMap>(app, entity, |map| *map = default());
    };
    for factor in [0.0, -1.0, f32::NAN, f32::INFINITY, 1.0e-30] {
        expect_fault(
            (
                Cloth::default(),
                ClothMaterialMap {
                    density: ClothFactor {
                        base: factor,
                        ..default()
                    },
                    ..default()
                },
                Pins::none(),
            ),
            |_, _| {},
            |error| error.quantity().is_some(),
            mend,
        );
    }
    expect_fault(
        (
            Cloth::default(),
            weighed(ClothPaint::vertices([1.0; 3])),
            Pins::none(),
        ),
        |_, _| {},
        |error| matches!(error, ClothError::Paint(PaintError::Count { .. })),
        mend,
    );
    // While it moves: it stays where it is until it is mended.
    expect_fault(
        (Cloth::default(), ClothMaterialMap::default(), Pins::none()),
        |app, entity| {
            tick(app, 3);
            change::<ClothMaterialMap>(app, entity, |map| {
                map.density.paint = ClothPaint::from(f32::NAN);
            });
        },
        |error| error.quantity().is_some(),
        mend,
    );
    // Masses that are too small, at run time; without a density, all is as it was.
    let mut masses = Vec::new();
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    tick(&mut app, 3);
    let all = |app: &App| particles(app, cloth).inverse_masses().collect::<Vec<f32>>();
    masses.extend(all(&app));
    let tiny = ClothMaterialMap {
        density: ClothFactor::of(1.0e-30),
        ..default()
    };
    app.world_mut().entity_mut(cloth).insert(tiny);
    tick(&mut app, 3);
    assert!(app.world().get::<ClothFault>(cloth).is_some());
    app.world_mut()
        .entity_mut(cloth)
        .remove::<ClothMaterialMap>();
    change::<Pins>(&mut app, cloth, |pins| *pins = Pins::none());
    change::<Pins>(&mut app, cloth, |pins| *pins = Pins::top_row());
    tick(&mut app, 3);
    assert!(app.world().get::<ClothFault>(cloth).is_none());
    assert_eq!(all(&app), masses);
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

/// How far the lower edge hangs below its place (m), with a compliance of each spring.
fn exact_stretch(elongation: impl Fn(u32, f32) -> f32) -> f32 {
    let last = SIDE - 1;
    let weight = |row: u32| if row == last { 0.5 } else { 1.0 };
    let load = soft().areal_density * 9.81 * SPACING;
    let of = |row: u32| {
        let below = (row + 1..SIDE).map(weight).sum::<f32>();
        elongation(row, COMPLIANCE * load * below)
    };
    (0..last).map(|row| SPACING * of(row)).sum()
}

/// It hangs lower by what its compliance says: painted at once, while it hangs, and no more once the map is gone.
#[test]
fn a_cloth_that_is_softer_below_hangs_lower() {
    let softer = |row: u32, strain: f32| {
        strain
            * match row {
                0..3 => 1.0,
                3 => 2.5,
                _ => 4.0,
            }
    };
    for (kind, cloth, allowed) in hung_sheets() {
        let top = top();
        let mut app = app();
        let bundle = (cloth.clone(), top.clone(), soft(), soft_below());
        let spawned = app.world_mut().spawn(bundle).id();
        let cloth = app.world_mut().spawn((cloth, top, soft())).id();
        let expect = |app: &App, cloth, exact: f32| {
            let found = sag(app, cloth);
            println!("{kind}: {found:.5} m, closed form {exact:.5} m");
            let ratio = found / exact;
            assert!((ratio - 1.0).abs() < allowed, "{kind}: {found} {exact}");
        };
        tick(&mut app, 600);
        let (alike, soft) = (exact_stretch(|_, strain| strain), exact_stretch(softer));
        expect(&app, spawned, soft);
        expect(&app, cloth, alike);
        let before = at(&app, cloth, 40);
        app.world_mut().entity_mut(cloth).insert(soft_below());
        tick(&mut app, 1);
        // It begins where it was: free fall for a tick is 1.2 mm.
        let moved = at(&app, cloth, 40).distance(before);
        assert!(moved < 1.2e-3, "{kind}: {moved}");
        tick(&mut app, 600);
        expect(&app, cloth, soft);
        app.world_mut()
            .entity_mut(cloth)
            .remove::<ClothMaterialMap>();
        tick(&mut app, 600);
        expect(&app, cloth, alike);
        let built = app.world().get::<ClothBuilt>(cloth).expect("built");
        assert!(!built.surface().is_torn(), "{kind}: as it was");
    }
}

/// Force over strain has a knee: each spring gives as its own load says, above and below it, and a cloth that swings up and
/// down over it gains nothing.
#[test]
fn a_cloth_that_stiffens_hangs_as_its_knee_says() {
    let stiffening = ClothStiffening {
        strain: 2.0e-3,
        factor: 5.0,
    };
    let material = ClothMaterial {
        stiffening: Some(stiffening),
        ..soft()
    };
    let exact = exact_stretch(|_, strain| match strain - stiffening.strain {
        beyond @ 0.0.. => stiffening.strain + beyond / stiffening.factor,
        _ => strain,
    });
    // Loads reach from half a row to seven and a half: some springs are on either side.
    let alike = exact_stretch(|_, strain| strain);
    assert!(exact < 0.7 * alike && exact > 1.5 * alike / stiffening.factor);
    for (kind, cloth, allowed) in hung_sheets() {
        let top = top();
        let mut app = app();
        let calm = app
            .world_mut()
            .spawn((cloth.clone(), top.clone(), material));
        let calm = calm.id();
        let swinging = ClothMaterial {
            damping: 0.0,
            ..material
        };
        let swinging = app.world_mut().spawn((cloth, top, swinging)).id();
        let largest = |app: &mut App, ticks: usize| {
            let each = (0..ticks).map(|_| {
                tick(app, 1);
                sag(app, swinging)
            });
            each.fold(0.0, f32::max)
        };
        let [first, later] = [64, 576].map(|ticks| largest(&mut app, ticks));
        println!("{kind}: deepest {first:.5} m, later {later:.5} m");
        assert!(later < 1.05 * first, "{kind}: {first} {later}");
        let found = sag(&app, calm);
        println!("{kind}: {found:.5} m, closed form {exact:.5} m");
        assert!((found / exact - 1.0).abs() < allowed, "{kind}: {found}");
    }
}

/// A strip that is clamped level and five times as rigid in its inner half droops by `q L⁴/8D (15/16 / 5 + 1/16)`: the integral of
/// the moment q (L − x)²/2 over the rigidity, times L − x.
#[test]
fn a_strip_that_is_stiffer_at_its_clamp_droops_less() {
    let (columns, spacing) = (41, 0.01);
    let length = (columns - 2) as f32 * spacing;
    let material = ClothMaterial {
        bend_rigidity: 0.09,
        stretch_compliance: 1.0e-6,
        damping: 0.1,
        ..ClothMaterial::COTTON
    };
    let middle = spacing + length / 2.0;
    let map = ClothMaterialMap {
        bending: ClothFactor::of(ClothPaint::at_rest(move |place| {
            if place.x < middle { 5.0 } else { 1.0 }
        })),
        ..default()
    };
    let clamp = Pins::new([Pin::at_rest(move |place| place.x < 1.5 * spacing)]);
    let strip = Cloth::new(columns, 5, spacing).lying();
    let mut app = app();
    let bundle = (strip.clone(), clamp.clone(), material, map);
    let stiffer = app.world_mut().spawn(bundle).id();
    let alike = app.world_mut().spawn((strip, clamp, material)).id();
    tick(&mut app, 1_000);
    let alone = material.areal_density * 9.81 * length.powi(4) / (8.0 * material.bend_rigidity);
    for (cloth, part) in [(alike, 1.0), (stiffer, 15.0 / 16.0 / 5.0 + 1.0 / 16.0)] {
        let end = at(&app, cloth, columns as usize * 3 - 1);
        let (found, exact) = (-end.y, alone * part);
        println!("droops by {found:.5} m, closed form {exact:.5} m");
        // Γ is 1: of an elastica the end droops by 0.1235 L, and 1/8 L of this theory of small droops. The middle of the spring
        // between both halves is half a spacing off, 1 % of L.
        assert!((found / exact - 1.0).abs() < 0.05, "{found} {exact}");
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

/// A map that says 1 everywhere leaves a grid what it is; one that is taken away, another resolution, and a tear are followed.
#[test]
fn a_grid_with_a_map_is_followed() {
    let mut app = app();
    let grid = |side: u32| Cloth::new(side, side, 0.8 / (side - 1) as f32);
    let cloth = (grid(SIDE), soft(), ClothMaterialMap::default());
    let cloth = app.world_mut().spawn(cloth).id();
    let is_grid = |app: &App| {
        let layout = particles(app, cloth);
        (layout.columns(), layout.rows())
    };
    tick(&mut app, 60);
    assert_eq!(is_grid(&app), (9, 9));
    app.world_mut().entity_mut(cloth).insert(soft_below());
    tick(&mut app, 300);
    assert_eq!(is_grid(&app), (81, 1));
    let hanging = sag(&app, cloth);
    // Half of the spacing: it stays where it is.
    change::<Cloth>(&mut app, cloth, |cloth| *cloth = grid(17));
    tick(&mut app, 1);
    assert_eq!(is_grid(&app), (289, 1));
    let lowest = particles(&app, cloth).positions().map(|place| place.y);
    let lowest = -lowest.fold(0.0, f32::min) - 0.8;
    assert!((lowest - hanging).abs() < 2.0e-3, "{lowest} {hanging}");
    let surface = app.world().get::<ClothBuilt>(cloth).expect("built");
    let surface = surface.surface().clone();
    let mut tears = ClothTears::default();
    tears.tear_out(&surface, surface.triangles()[100]);
    app.world_mut().entity_mut(cloth).insert(tears);
    tick(&mut app, 60);
    assert!(app.world().get::<ClothFault>(cloth).is_none());
    assert_eq!(
        messages::<ClothTorn>(&mut app).len(),
        1,
        "for its tear alone"
    );
    app.world_mut()
        .entity_mut(cloth)
        .remove::<(ClothTears, ClothMaterialMap)>();
    tick(&mut app, 60);
    assert_eq!(is_grid(&app), (17, 17));
}

#[test]
fn a_stiffness_that_cannot_be() {
    let is_quantity = |error: &ClothError| error.quantity().is_some();
    let mend = |app: &mut App, entity: Entity| {
        change::<ClothMaterialMap>(app, entity, |map| *map = default());
    };
    for factor in [0.0, f32::NAN, f32::INFINITY] {
        let map = ClothMaterialMap {
            stretch: ClothFactor::of(factor),
            ..default()
        };
        expect_fault(
            (Cloth::default(), map, Pins::none()),
            |_, _| {},
            is_quantity,
            mend,
        );
    }
    for factor in [f32::NAN, f32::INFINITY] {
        let map = ClothMaterialMap {
            bending: ClothFactor::of(factor),
            friction: ClothFactor::of(factor),
            ..default()
        };
        expect_fault(
            (Cloth::default(), map, Pins::none()),
            |_, _| {},
            is_quantity,
            mend,
        );
    }
    // While it moves.
    let bundle = (Cloth::default(), ClothMaterialMap::default(), Pins::none());
    expect_fault(
        bundle,
        |app, entity| {
            tick(app, 3);
            change::<ClothMaterialMap>(app, entity, |map| {
                map.stretch = ClothFactor::of(ClothPaint::vertices([1.0; 3]));
            });
        },
        |error| matches!(error, ClothError::Paint(PaintError::Count { .. })),
        mend,
    );
    // A rope is solved by its row alone.
    let rope = || Cloth::rope(9, 0.1, 0.01);
    let mut app = app();
    let map = ClothMaterialMap {
        stretch: ClothFactor::of(2.0),
        ..default()
    };
    let stiffer = app.world_mut().spawn((rope(), map)).id();
    let stiffening = ClothMaterial {
        stiffening: Some(default()),
        ..default()
    };
    let stiffening = app.world_mut().spawn((rope(), stiffening)).id();
    let heavy = app.world_mut().spawn((rope(), wet())).id();
    tick(&mut app, 3);
    let has_fault = |cloth| app.world().get::<ClothFault>(cloth).is_some();
    assert_eq!(
        [stiffer, stiffening, heavy].map(has_fault),
        [true, true, false]
    );
}

/// A factor that is the same everywhere is another material, to the bit: stretch, bending, and creases.
#[test]
fn a_factor_that_is_everywhere_is_another_material() {
    let softer = ClothMaterial {
        stretch_compliance: 1.0e-3,
        shear_compliance: 2.0e-3,
        ..ClothMaterial::COTTON
    };
    let stiffer = ClothMaterial {
        stretch_compliance: 0.5e-3,
        shear_compliance: 1.0e-3,
        bend_rigidity: 4.0 * softer.bend_rigidity,
        ..softer
    };
    let of = |factor: f32| ClothFactor::of(ClothPaint::at_rest(move |_| factor));
    let map = ClothMaterialMap {
        stretch: of(2.0),
        bending: of(4.0),
        ..default()
    };
    let creasing = ClothCreasing {
        yield_curvature: 1.0,
        hardening: 0.1,
    };
    let mut app = app();
    app.insert_resource(ClothWind::new(Vec3::new(1.0, 0.0, 4.0)));
    let pins = || Pins::new([Pin::Vertex(0), Pin::Vertex(SIDE as usize - 1)]);
    let by_map = (sheet(), softer, map, pins(), creasing);
    let by_map = app.world_mut().spawn(by_map).id();
    let by_material = (sheet(), stiffer, pins(), creasing);
    let by_material = app.world_mut().spawn(by_material).id();
    tick(&mut app, 200);
    assert_eq!(particles(&app, by_map), particles(&app, by_material));
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
