//! What can hardly be meant and is no fault is logged: by name, once.

use bevy::prelude::*;
use bevy_drape::{cloth::RestPredicate, plugin::ClothMesh, prelude::*};

use crate::{
    log::{lines_with, listen},
    meshes::sheets::{add, sheet, sheet_asset},
    support::*,
};

/// The only line with this text.
fn line_with(text: &str) -> String {
    let lines = lines_with(text);
    let [line] = &lines[..] else {
        panic!("once: {lines:?}");
    };
    line.clone()
}

/// Places at rest are the cloth's own, not the world's: this one hangs from y = 2 in the world.
#[test]
fn a_predicate_that_holds_for_no_particle_is_logged() {
    listen();
    let mut app = app();
    let at = Transform::from_xyz(0.0, 2.0, 0.0);
    let above = Pins::new([
        Pin::Corner(Corner::TopLeft),
        Pin::at_rest(|place| place.y > 1.0),
    ]);
    let cloth = (Cloth::new(5, 4, 0.1), above, at, Name::new("skirt"));
    let cloth = app.world_mut().spawn(cloth).id();
    let column = Pins::filter(|_, column| column == 5);
    let other = (Cloth::new(5, 4, 0.1), column, Name::new("sash"));
    let other = app.world_mut().spawn(other).id();
    tick(&mut app, 64);
    let line = lines_with("skirt").concat();
    assert_eq!(
        line,
        "cloth \"skirt\": `Pin::at_rest` holds for no particle, so it pins nothing. Its closure is given places at rest in the \
         entity's frame, from [0.00, -0.30, 0.00] to [0.40, 0.00, 0.00] m; scene files don't hold closures"
    );
    for cloth in [cloth, other] {
        assert!(app.world().get::<ClothFault>(cloth).is_none());
        assert!(position(&app, cloth, (3, 4)).y < -0.35, "it falls");
    }
    // A game may release a cloth by a predicate.
    change::<Pins>(&mut app, cloth, |pins| *pins = Pins::filter(|_, _| false));
    change::<Cloth>(&mut app, other, |cloth| *cloth = Cloth::new(5, 5, 0.1));
    tick(&mut app, 5);
    assert_eq!(
        (lines_with("skirt").len(), lines_with("sash").len()),
        (1, 1)
    );
}

/// Pins that are attached are named by predicates, too.
#[test]
fn an_attachment_that_holds_nothing_is_logged() {
    listen();
    let mut app = app();
    let pole = app.world_mut().spawn(Transform::default()).id();
    let attached = ClothAttachments::new([(Pin::at_rest(|place| place.x < 0.0), pole)]);
    let ensign = (Cloth::default(), attached, Name::new("ensign"));
    app.world_mut().spawn(ensign);
    tick(&mut app, 5);
    assert!(line_with("\"ensign\"").contains("`Pin::at_rest` holds for no particle"));
}

#[test]
fn a_predicate_of_rows_and_columns_is_logged() {
    listen();
    let mut app = app();
    let pins = Pins::filter(|_, column| column == 5);
    let cloth = (Cloth::new(5, 4, 0.1), pins, Name::new("veil"));
    app.world_mut().spawn(cloth);
    tick(&mut app, 5);
    assert_eq!(
        line_with("\"veil\""),
        "cloth \"veil\": `Pin::filter` holds for no particle, so it pins nothing. Its closure is given (row, column) of 5 columns × 4 rows, \
         counted from 0; scene files don't hold closures"
    );
}

/// As a scene file has it, whose closure was not written.
#[test]
fn a_predicate_that_was_not_saved_is_logged() {
    listen();
    let mut app = app();
    let pins = Pins::new([Pin::AtRest(RestPredicate::default())]);
    let cloth = (Cloth::default(), pins, Name::new("shroud"));
    app.world_mut().spawn(cloth);
    // No pins at all are meant.
    let free = (Cloth::default(), Pins::none(), Name::new("kerchief"));
    app.world_mut().spawn(free);
    let held = Pins::new([Pin::at_rest(|place| place.y > -0.01)]);
    let held = (Cloth::default(), held, Name::new("kerchief too"));
    app.world_mut().spawn(held);
    tick(&mut app, 5);
    assert!(line_with("\"shroud\"").contains("`Pin::at_rest` holds for no particle"));
    assert!(lines_with("kerchief").is_empty());
}

/// The grid is drawn, and the game's mesh comes back with its removal. A mesh that is the plugin's, or the cloth's own, is not logged.
#[test]
fn a_grid_beside_a_mesh_is_logged() {
    listen();
    let mut app = app_that_draws(FixedUpdate);
    let asset = add(&mut app, sheet_asset(5, 4));
    let name = Name::new;
    let mesh = || Mesh3d(asset.clone());
    let both = (Cloth::new(6, 6, 0.1), mesh(), name("banderole"));
    let both = app.world_mut().spawn(both).id();
    let (positions, triangles) = sheet(4, 4);
    let triangles = Cloth::triangles(positions, triangles);
    app.world_mut()
        .spawn((triangles, mesh(), name("pennon of triangles")));
    let grid = (Cloth::new(6, 6, 0.1), name("gonfalon"));
    let grid = app.world_mut().spawn(grid).id();
    app.world_mut()
        .spawn((Cloth::mesh(), mesh(), name("gonfalon of an asset")));
    tick(&mut app, 3);
    assert_eq!(
        line_with("banderole"),
        "cloth \"banderole\": it is a grid and is drawn in place of its `Mesh3d`: use `Cloth::mesh()` to make the cloth from \
         that mesh, or put the `Mesh3d` on another entity with a `ClothRenderMesh`"
    );
    let drawn = |app: &App| app.world().get::<Mesh3d>(both).expect("a mesh").0.clone();
    assert_ne!(drawn(&app), asset);
    // Brought along by a clone, and by scenes with and without what says that the mesh is the plugin's.
    app.world_mut().entity_mut(grid).clone_and_spawn();
    app.world_mut().entity_mut(both).clone_and_spawn();
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    for is_told in [true, false] {
        let scene = {
            let registry = registry.read();
            let builder = DynamicWorldBuilder::from_world(app.world(), &registry)
                .deny_all()
                .allow_component::<Cloth>()
                .allow_component::<Name>()
                .allow_component::<Mesh3d>();
            let builder = match is_told {
                true => builder.allow_component::<ClothMesh>(),
                false => builder,
            };
            builder.extract_entities([grid].into_iter()).build()
        };
        let mut map = default();
        scene
            .write_to_world(app.world_mut(), &mut map)
            .expect("it is spawned");
        tick(&mut app, 3);
        assert_eq!(particles(&app, map[&grid]).len(), 36);
    }
    assert!(lines_with("gonfalon").is_empty());
    assert_eq!(lines_with("banderole").len(), 1);
    // One that comes later is drawn instead.
    let own = drawn(&app);
    app.world_mut().entity_mut(both).insert(mesh());
    tick(&mut app, 2);
    assert_eq!(drawn(&app), asset);
    app.world_mut().entity_mut(both).insert(Mesh3d(own));
    app.world_mut().entity_mut(both).remove::<Cloth>();
    tick(&mut app, 1);
    assert_eq!(drawn(&app), asset);
}

/// 64,770 springs in 300 sub-steps, and 4,641 of a mesh that bends in 1,000.
#[test]
fn a_cloth_that_no_tick_has_time_for_is_logged() {
    listen();
    let mut app = app();
    let grid = Cloth::new(128, 128, 0.01);
    let settings = ClothSettings::substeps(300);
    app.world_mut()
        .spawn((grid.clone(), settings, Name::new("mainsail")));
    tick(&mut app, 2);
    assert_eq!(
        line_with("mainsail"),
        "cloth \"mainsail\": 16384 particles in 300 sub-steps take at least 19 ms a tick, and a tick lasts 15.6 ms: use fewer particles or \
         sub-steps; a `ClothRenderMesh` draws a fine mesh on a coarse cloth"
    );
    let mut app = self::app();
    let (positions, triangles) = sheet(40, 40);
    let mesh = (
        Cloth::triangles(positions, triangles),
        ClothSettings::substeps(1000),
        Name::new("topsail"),
    );
    app.world_mut().spawn(mesh);
    tick(&mut app, 2);
    let line = line_with("topsail");
    assert!(
        line.contains("1600 particles in 1000 sub-steps take at least 28 ms"),
        "{line}"
    );
}

#[test]
fn ordinary_cloth_is_not_logged() {
    listen();
    let mut app = app();
    let name = Name::new("staysail");
    app.world_mut()
        .spawn((Cloth::new(64, 64, 0.02), name.clone()));
    let (positions, triangles) = sheet(64, 64);
    app.world_mut()
        .spawn((Cloth::triangles(positions, triangles), name));
    tick(&mut app, 3);
    assert!(lines_with("staysail").is_empty());
}
