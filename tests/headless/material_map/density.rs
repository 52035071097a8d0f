//! Density that differs from place to place.

use super::*;

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
