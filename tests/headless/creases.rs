//! Folds that stay.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::{meshes::sheets::surface, shared_meshes::irregular, support::*};

/// Length of the sheet (m).
const LENGTH: f32 = 0.4;

const CREASING: ClothCreasing = ClothCreasing {
    yield_curvature: 5.0,
    hardening: 0.1,
};

/// A sheet whose ends two hands brought together and let go of, two seconds ago.
fn folded(creasing: Option<ClothCreasing>) -> (App, Entity) {
    folded_along(creasing, false)
}

/// The same of a sheet of 21 columns and 5 rows, or the other way round.
fn folded_along(creasing: Option<ClothCreasing>, is_tall: bool) -> (App, Entity) {
    let spacing = LENGTH / 20.0;
    let (cloth, place) = match is_tall {
        true => (
            Cloth::new(5, 21, spacing),
            Transform::from_rotation(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2)),
        ),
        false => (Cloth::new(21, 5, spacing), Transform::default()),
    };
    let line = if is_tall { Pin::Row } else { Pin::Column };
    folded_by([line(0), line(20)], cloth, place, creasing)
}

/// The same of an irregular mesh as large and as fine.
fn folded_mesh(creasing: Option<ClothCreasing>) -> (App, Entity) {
    let mesh = irregular(LENGTH, LENGTH / 5.0, LENGTH / 20.0, 0.2);
    let ends = [
        Pin::at_rest(|place| place.x < 1.0e-4),
        Pin::at_rest(|place| place.x > LENGTH - 1.0e-4),
    ];
    let cloth = Cloth::triangles(mesh.positions, mesh.triangles);
    folded_by(ends, cloth, Transform::default(), creasing)
}

/// The same of any sheet of this length, which is held by two ends.
fn folded_by(
    [first, second]: [Pin; 2],
    cloth: Cloth,
    place: Transform,
    creasing: Option<ClothCreasing>,
) -> (App, Entity) {
    let mut app = app();
    let hands = [0.0, LENGTH].map(|x| {
        let place = Transform::from_xyz(x, 0.0, 0.0);
        app.world_mut().spawn(place).id()
    });
    let held = ClothAttachments::new([(first, hands[0]), (second, hands[1])]);
    let paper = ClothMaterial {
        bend_rigidity: 3.0e-4,
        damping: 0.1,
        ..ClothMaterial::COTTON
    };
    let settings = ClothSettings {
        gravity: Some(Vec3::ZERO),
        ..default()
    };
    let sheet = (cloth, place, Pins::none(), paper);
    let sheet = app.world_mut().spawn((sheet, settings, held)).id();
    if let Some(creasing) = creasing {
        app.world_mut().entity_mut(sheet).insert(creasing);
    }
    for step in 0..=64 {
        let angle = 0.8 * std::f32::consts::PI * step as f32 / 64.0;
        let place = 0.5 * LENGTH * Vec3::new(1.0 + 0.7 * angle.cos(), 0.0, 0.7 * angle.sin());
        let start = Vec3::X * LENGTH;
        let to = start.lerp(place, (step as f32 / 16.0).min(1.0));
        change::<Transform>(&mut app, hands[1], |hand| {
            *hand = Transform::from_translation(to);
        });
        tick(&mut app, 1);
    }
    app.world_mut()
        .entity_mut(sheet)
        .remove::<ClothAttachments>();
    tick(&mut app, 128);
    assert!(app.world().get::<ClothFault>(sheet).is_none());
    (app, sheet)
}

/// How far apart its ends are, in parts of its length.
fn open(app: &App, sheet: Entity) -> f32 {
    let columns = particles(app, sheet).columns();
    let [a, b] = [0, columns - 1].map(|column| position(app, sheet, (2, column)));
    a.distance(b) / LENGTH
}

/// A sheet that creases stays folded, as long as it is the same sheet, wherever it is put. One that does not springs back.
#[test]
fn a_fold_made_by_hands_stays() {
    let (app, sheet) = folded(None);
    let flat = open(&app, sheet);
    let (mut app, sheet) = folded(Some(CREASING));
    let creased = open(&app, sheet);
    change::<Transform>(&mut app, sheet, |place| {
        *place = Transform::from_xyz(3.0, 1.0, 0.0).with_rotation(Quat::from_rotation_x(2.0));
    });
    app.world_mut().entity_mut(sheet).insert(ClothTeleport);
    tick(&mut app, 64);
    let turned = open(&app, sheet);
    change::<ClothMaterial>(&mut app, sheet, |paper| paper.bend_rigidity = 5.0e-4);
    tick(&mut app, 128);
    let stiffened = open(&app, sheet);
    println!("flat {flat:.3}, creased {creased:.3}, turned {turned:.3}, stiffened {stiffened:.3}");
    assert!(flat > 0.97, "{flat}");
    assert!(creased < 0.8, "{creased}");
    assert!((turned - creased).abs() < 0.02, "{turned} {creased}");
    assert!((stiffened - creased).abs() < 0.02, "{stiffened} {creased}");
}

/// A mesh stays folded as a grid does. It is bent to 16/m at most, as an elastica of 0.4 m whose ends are 0.12 m apart, and keeps
/// 10/m there. A mesh keeps that to 2.5 % of 16/m, or to 4 % of the 2 rad that its fold is left with. So its ends are nearer or farther by
/// 0.03 of its length, and by half of that for the particles of its border.
#[test]
fn a_fold_of_a_mesh_stays() {
    let open = |(app, sheet): &(App, Entity)| {
        let rest = surface(app, *sheet).rest_positions();
        let end = |is_there: fn(f32) -> bool| {
            let own = rest.iter().zip(particles(app, *sheet).positions());
            let own: Vec<Vec3> = own
                .filter(|(rest, _)| is_there(rest.x))
                .map(|(_, place)| place)
                .collect();
            own.iter().sum::<Vec3>() / own.len() as f32
        };
        end(|x| x < 1.0e-4).distance(end(|x| x > LENGTH - 1.0e-4)) / LENGTH
    };
    let flat = open(&folded_mesh(None));
    let creased = open(&folded_mesh(Some(CREASING)));
    let of_grid = open(&folded(Some(CREASING)));
    println!("flat {flat:.3}, creased {creased:.3}, of a grid {of_grid:.3}");
    assert!(flat > 0.97, "{flat}");
    assert!((creased - of_grid).abs() < 0.045, "{creased} {of_grid}");
}

/// Without the component it springs back, and so does a sheet that is built anew.
#[test]
fn creases_end_with_the_component_and_with_the_surface() {
    let (mut app, sheet) = folded(Some(CREASING));
    app.world_mut().entity_mut(sheet).remove::<ClothCreasing>();
    tick(&mut app, 192);
    let without = open(&app, sheet);
    let (mut app, sheet) = folded(Some(CREASING));
    change::<Cloth>(&mut app, sheet, |cloth| {
        *cloth = Cloth::new(17, 5, LENGTH / 16.0);
    });
    tick(&mut app, 192);
    let anew = open(&app, sheet);
    println!("without {without:.3}, anew {anew:.3}");
    assert!(without > 0.97, "{without}");
    assert!(anew > 0.97, "{anew}");
}

/// A slit along the fold makes the grid a mesh, and one across tears that mesh. Four cells of the fold remain, of which the slits weaken
/// those at their sides: it opens by less than a third of what it has left. Mended, it is a grid without creases: it opens until
/// it yields no more. Folded over a column, or over a row.
#[test]
fn a_torn_sheet_stays_folded() {
    for is_tall in [false, true] {
        // Of a place along the sheet and one across it.
        let at = |along: usize, across: usize| match is_tall {
            true => along * 5 + across,
            false => across * 21 + along,
        };
        let open = |app: &App, sheet: Entity| {
            let place = |along| {
                particles(app, sheet)
                    .position(at(along, 2))
                    .expect("it exists")
            };
            place(0).distance(place(20)) / LENGTH
        };
        let (mut app, sheet) = folded_along(Some(CREASING), is_tall);
        let whole = open(&app, sheet);
        assert!(whole < 0.8, "{whole}");
        app.world_mut()
            .entity_mut(sheet)
            .insert(ClothTears::default());
        for slit in [[(10, 0), (10, 1), (10, 2)], [(10, 2), (11, 2), (12, 2)]] {
            let particles = slit.map(|(along, across)| at(along, across) as u32);
            change::<ClothTears>(&mut app, sheet, |tears| {
                tears.tear_all([[particles[0], particles[1]], [particles[1], particles[2]]]);
            });
            tick(&mut app, 192);
            assert!(app.world().get::<ClothFault>(sheet).is_none());
            let torn = open(&app, sheet);
            println!("tall {is_tall}: whole {whole:.3}, torn {torn:.3}");
            assert!((torn - whole).abs() < (1.0 - whole) / 3.0, "{torn} {whole}");
        }
        change::<ClothTears>(&mut app, sheet, |tears| *tears = ClothTears::default());
        tick(&mut app, 192);
        let mended = open(&app, sheet);
        println!("mended {mended:.3}");
        assert!(mended > whole + 0.1, "{mended} {whole}");
    }
}

/// What is no curvature and no hardening is a fault that names it, and leaves other cloth alone. A good value mends it.
#[test]
fn bad_creasing_is_a_fault() {
    let mut app = app();
    let other = app.world_mut().spawn(Cloth::new(5, 5, 0.1)).id();
    let sheet = app
        .world_mut()
        .spawn((Cloth::new(5, 5, 0.1), CREASING))
        .id();
    tick(&mut app, 1);
    for (yield_curvature, hardening, name) in [
        (0.0, 0.1, "yield curvature"),
        (-1.0, 0.1, "yield curvature"),
        (f32::NAN, 0.1, "yield curvature"),
        (f32::INFINITY, 0.1, "yield curvature"),
        (5.0, -0.1, "hardening"),
        (5.0, 1.0, "hardening"),
        (5.0, f32::NAN, "hardening"),
    ] {
        let bad = ClothCreasing {
            yield_curvature,
            hardening,
        };
        app.world_mut().entity_mut(sheet).insert(bad);
        let before = [sheet, other].map(|cloth| position(&app, cloth, (4, 2)));
        tick(&mut app, 2);
        let fault = app.world().get::<ClothFault>(sheet).expect("a fault");
        assert!(fault.error.to_string().contains(name), "{}", fault.error);
        assert!(app.world().get::<ClothFault>(other).is_none());
        assert_eq!(position(&app, sheet, (4, 2)), before[0]);
        assert_ne!(position(&app, other, (4, 2)), before[1]);
    }
    app.world_mut().entity_mut(sheet).insert(CREASING);
    tick(&mut app, 2);
    assert!(app.world().get::<ClothFault>(sheet).is_none());
}

/// A material that bends freely has no creases, and what never yields moves bit for bit as without.
#[test]
fn nothing_stays_below_the_yield_curvature() {
    let hung = |rigidity: f32, creasing: Option<ClothCreasing>| {
        let mut app = app();
        let material = ClothMaterial {
            bend_rigidity: rigidity,
            ..ClothMaterial::COTTON
        };
        let pins = Pins::new([Pin::Corner(Corner::TopLeft)]);
        let cloth = (Cloth::new(12, 12, 0.05), material, pins);
        let cloth = app.world_mut().spawn(cloth).id();
        if let Some(creasing) = creasing {
            app.world_mut().entity_mut(cloth).insert(creasing);
        }
        tick(&mut app, 128);
        particles(&app, cloth).clone()
    };
    // A grid bends by at most 2 over its spacing, and √3 times as much in all directions at once.
    let beyond = ClothCreasing {
        yield_curvature: 100.0,
        hardening: 0.0,
    };
    for rigidity in [6.0e-6, 1.0e-3] {
        assert!(hung(rigidity, Some(beyond)) == hung(rigidity, None));
    }
    assert!(hung(0.0, Some(CREASING)) == hung(0.0, None));
    // It is far beyond 1/m where it hangs by its corner.
    let soon = ClothCreasing {
        yield_curvature: 1.0,
        hardening: 0.1,
    };
    assert!(hung(6.0e-6, Some(soon)) != hung(6.0e-6, None));
}
