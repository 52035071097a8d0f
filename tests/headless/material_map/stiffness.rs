//! Stretch and bending that differ from place to place.

use super::*;

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
