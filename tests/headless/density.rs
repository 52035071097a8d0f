//! Cloth that weighs more in places, and changes its weight while it moves.

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
fn wet() -> ClothDensity {
    ClothDensity::added(ClothPaint::at_rest(
        |place| {
            if place.y < -0.35 { 9.0 } else { 0.0 }
        },
    ))
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

/// It hangs lower by what its compliance says, whether it was spawned wet, gets wet asleep, or dries again.
#[test]
fn a_wet_sheet_hangs_lower() {
    let dry = exact(|_| 1.0);
    let soaked = exact(|row| if row > 3 { 10.0 } else { 1.0 });
    // A mesh draws in at its free sides and is clamped at its top.
    for (kind, cloth, allowed) in [
        ("grid", Cloth::new(SIDE, SIDE, SPACING), 0.02),
        ("mesh", sheet(), 0.1),
    ] {
        let top = Pins::new([Pin::at_rest(|place| place.y > -1.0e-4)]);
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
        app.world_mut().entity_mut(cloth).remove::<ClothDensity>();
        tick(&mut app, 600);
        expect(&app, cloth, dry);
    }
}

/// Weight that changes in every tick moves nothing by itself: what falls goes on to fall, v = g t.
#[test]
fn weight_that_changes_leaves_velocities_alone() {
    for cloth in [Cloth::new(SIDE, SIDE, SPACING), sheet()] {
        let mut app = app();
        let bundle = (cloth, Pins::none(), soft(), ClothDensity::default());
        let cloth = app.world_mut().spawn(bundle).id();
        tick(&mut app, 1);
        let speed =
            |app: &App, index: usize| particles(app, cloth).velocity(index).expect("a particle").y;
        let before = speed(&app, 40);
        for at in 0..64 {
            let wet = at as f32 / 64.0;
            let paint = ClothPaint::at_rest(move |place| if place.y < -0.35 { wet } else { 0.0 });
            change::<ClothDensity>(&mut app, cloth, |density| density.paint = paint);
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
        change::<ClothDensity>(app, entity, |density| *density = default());
    };
    for factor in [0.0, -1.0, f32::NAN, f32::INFINITY, 1.0e-30] {
        expect_fault(
            (
                Cloth::default(),
                ClothDensity {
                    base: factor,
                    ..default()
                },
                Pins::none(),
            ),
            |_, _| {},
            |error| matches!(error, ClothError::Quantity { .. }),
            mend,
        );
    }
    expect_fault(
        (
            Cloth::default(),
            ClothDensity::added(ClothPaint::vertices([1.0; 3])),
            Pins::none(),
        ),
        |_, _| {},
        |error| matches!(error, ClothError::PaintCount { .. }),
        mend,
    );
    // While it moves: it stays where it is until it is mended.
    expect_fault(
        (Cloth::default(), ClothDensity::default(), Pins::none()),
        |app, entity| {
            tick(app, 3);
            change::<ClothDensity>(app, entity, |density| {
                density.paint = ClothPaint::from(f32::NAN);
            });
        },
        |error| matches!(error, ClothError::Quantity { .. }),
        mend,
    );
    // Masses that are too small, at run time; without a density, all is as it was.
    let mut masses = Vec::new();
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    tick(&mut app, 3);
    let all = |app: &App| particles(app, cloth).inverse_masses().collect::<Vec<f32>>();
    masses.extend(all(&app));
    let tiny = ClothDensity {
        base: 1.0e-30,
        ..default()
    };
    app.world_mut().entity_mut(cloth).insert(tiny);
    tick(&mut app, 3);
    assert!(app.world().get::<ClothFault>(cloth).is_some());
    app.world_mut().entity_mut(cloth).remove::<ClothDensity>();
    change::<Pins>(&mut app, cloth, |pins| *pins = Pins::none());
    change::<Pins>(&mut app, cloth, |pins| *pins = Pins::top_row());
    tick(&mut app, 3);
    assert!(app.world().get::<ClothFault>(cloth).is_none());
    assert_eq!(all(&app), masses);
}
