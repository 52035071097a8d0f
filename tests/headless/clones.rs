//! Clones of cloths, colliders and skeletons that live: each goes on by itself.

use bevy::{
    asset::RenderAssetUsages, ecs::entity::EntityCloner, mesh::PlaneMeshBuilder, prelude::*,
};
use bevy_drape::{
    plugin::{ClothBuilt, ClothMesh},
    prelude::*,
};

use crate::support::*;

fn mesh_of(app: &App, entity: Entity) -> Handle<Mesh> {
    let mesh = app.world().get::<Mesh3d>(entity);
    mesh.expect("it is drawn").0.clone()
}

fn sheet(app: &mut App) -> Handle<Mesh> {
    let mut sheet = PlaneMeshBuilder::new(Dir3::Z, Vec2::new(1.0, 1.0))
        .subdivisions(8)
        .build();
    sheet.asset_usage = RenderAssetUsages::default();
    app.world_mut().resource_mut::<Assets<Mesh>>().add(sheet)
}

fn clone(app: &mut App, entity: Entity) -> Entity {
    app.world_mut().entity_mut(entity).clone_and_spawn()
}

/// A falling grid and a falling mesh are cloned and put elsewhere. Each clone moves as its original, and draws in a mesh
/// of its own; neither minds that the other goes.
#[test]
fn a_clone_goes_on_by_itself() {
    let mut app = app_that_draws(FixedUpdate);
    let asset = sheet(&mut app);
    let place = Transform::from_xyz(0.0, 4.0, 0.0);
    let grid = (Cloth::new(9, 9, 0.1), place);
    let top = Pins::new([Pin::at_rest(|place| place.y > 0.49)]);
    let mesh = (Cloth::mesh(), Mesh3d(asset.clone()), top, place);
    let originals = [
        app.world_mut().spawn(grid).id(),
        app.world_mut().spawn(mesh).id(),
    ];
    tick(&mut app, 20);
    let clones = originals.map(|original| clone(&mut app, original));
    for clone in clones {
        change::<Transform>(&mut app, clone, |place| place.translation.z += 64.0);
    }
    for _ in 0..40 {
        tick(&mut app, 1);
        for (original, clone) in originals.into_iter().zip(clones) {
            assert!(app.world().get::<ClothFault>(clone).is_none());
            let pairs = particles(&app, original).positions();
            let apart = pairs.zip(particles(&app, clone).positions());
            let apart = apart.map(|(a, b)| a.distance(b)).fold(0.0, f32::max);
            // Frames are rounded otherwise at 64 m, by up to 2⁻¹⁹ m; swinging cloth makes that no more than some ten times as much.
            assert!(apart < 1.0e-4, "{apart}");
        }
    }
    for (original, clone) in originals.into_iter().zip(clones) {
        assert_ne!(mesh_of(&app, original), mesh_of(&app, clone));
        let surface = |cloth| {
            let built = app.world().get::<ClothBuilt>(cloth).expect("built");
            built.surface().rest_positions().to_vec()
        };
        assert_eq!(surface(original), surface(clone));
        let drawn = app.world().get::<ClothMesh>(clone).expect("it is drawn");
        assert_eq!(drawn.id(), mesh_of(&app, clone).id());
    }
    let source = app
        .world()
        .get::<ClothMesh>(clones[1])
        .and_then(ClothMesh::source);
    assert_eq!(source, Some(&asset));
    for original in originals {
        app.world_mut().despawn(original);
    }
    tick(&mut app, 10);
    for clone in clones {
        assert!(app.world().get::<ClothFault>(clone).is_none());
        app.world_mut().entity_mut(clone).remove::<Cloth>();
    }
    tick(&mut app, 1);
    // As its original would: a grid draws nothing, a mesh what it was made from.
    assert!(app.world().get::<Mesh3d>(clones[0]).is_none());
    assert_eq!(mesh_of(&app, clones[1]), asset);
}

/// A fine mesh on a coarse cloth: its clone is bound to the asset, not to what was drawn as it was cloned.
#[test]
fn a_clone_of_a_driven_mesh_is_driven() {
    let mut app = app_that_draws(FixedUpdate);
    let asset = sheet(&mut app);
    let cloth = Cloth::new(6, 6, 0.2).centred();
    let cloth = app.world_mut().spawn(cloth).id();
    let fine = (ClothRenderMesh { cloth }, Mesh3d(asset.clone()));
    let fine = app.world_mut().spawn(fine).id();
    tick(&mut app, 60);
    let copy = clone(&mut app, fine);
    tick(&mut app, 2);
    assert!(app.world().get::<ClothFault>(copy).is_none());
    let meshes = app.world().resource::<Assets<Mesh>>();
    let places = |entity| {
        let mesh = meshes.get(&mesh_of(&app, entity)).expect("a mesh");
        let places = mesh.attribute(Mesh::ATTRIBUTE_POSITION);
        let places = places.and_then(|places| places.as_float3());
        places.expect("positions").to_vec()
    };
    assert_ne!(mesh_of(&app, fine), mesh_of(&app, copy));
    assert_eq!(places(fine), places(copy));
    app.world_mut().entity_mut(copy).remove::<ClothRenderMesh>();
    tick(&mut app, 1);
    assert_eq!(mesh_of(&app, copy), asset);
    assert_ne!(mesh_of(&app, fine), asset);
}

/// What is attached stays attached, the clone with the offset that it has from where it is.
#[test]
fn a_clone_is_attached_as_its_original() {
    let mut app = app();
    let hand = app.world_mut().spawn(Transform::default()).id();
    let attached = ClothAttachments::new([(Pin::Row(0), hand)]);
    let cloth = (Cloth::new(6, 6, 0.1), Pins::none(), attached);
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 10);
    let copy = clone(&mut app, cloth);
    change::<Transform>(&mut app, copy, |place| place.translation.z = 2.0);
    tick(&mut app, 2);
    change::<Transform>(&mut app, hand, |place| place.translation.y = 0.05);
    tick(&mut app, 2);
    for each in [cloth, copy] {
        let corner = position(&app, each, (0, 0));
        assert!(corner.distance(Vec3::Y * 0.05) < 1.0e-5, "{corner}");
    }
}

/// Colliders on the bones of a skeleton: one each, also of a clone, and each skeleton takes away its own.
#[test]
fn skeletons_have_colliders_of_their_own() {
    let mut app = app();
    let bone = (Name::new("hips"), Transform::from_xyz(0.0, 1.0, 0.0));
    let bones = ClothBones::new([ClothBone::ball("hips", 0.2)]);
    let hero = (Transform::default(), bones, children![bone]);
    let hero = app.world_mut().spawn(hero).id();
    let colliders = |app: &mut App| {
        let mut all = app.world_mut().query::<&ClothCollider>();
        all.iter(app.world()).count()
    };
    tick(&mut app, 3);
    assert_eq!(colliders(&mut app), 1);
    let twin = app.world_mut().spawn_empty().id();
    let mut cloner = EntityCloner::build_opt_out(app.world_mut());
    cloner.linked_cloning(true);
    cloner.clone_entity(hero, twin);
    tick(&mut app, 3);
    assert_eq!(colliders(&mut app), 2);
    // A clone without its bones has none, and takes none away.
    let ghost = clone(&mut app, hero);
    tick(&mut app, 3);
    app.world_mut().despawn(ghost);
    let ghost = clone(&mut app, hero);
    app.world_mut().entity_mut(ghost).remove::<ClothBones>();
    tick(&mut app, 3);
    assert_eq!(colliders(&mut app), 2);
    app.world_mut().entity_mut(twin).remove::<ClothBones>();
    tick(&mut app, 3);
    assert_eq!(colliders(&mut app), 1);
}
