//! Messages that tell of tears.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::{support::*, tears::*};

/// Where a particle is in the world, by the place of its entity.
fn in_world(app: &App, cloth: Entity, particle: u32) -> Vec3 {
    let place: &Transform = app.world().get(cloth).expect("a place");
    let particle = particles(app, cloth).position(particle as usize);
    place.transform_point(particle.expect("it exists"))
}

/// A turned cloth moves by 1 m a tick. The place of its tear is that of the first new particle as the tick ends, or the middle of an edge
/// that opens nothing, and of one that is mended. Places up to 9 m away are turned twice and rounded by some 10⁻⁶ m each time.
#[test]
fn a_tear_of_moving_cloth_is_where_the_tick_leaves_it() {
    // At the border, and inside.
    for (edge, opens) in [([36, 37], true), ([40, 41], false)] {
        let mut app = app();
        let place = Transform::from_rotation(Quat::from_euler(EulerRot::XYZ, 0.4, 1.1, -0.7));
        let parts = (Cloth::new(9, 9, 0.1), place, ClothTears::default());
        let cloth = app.world_mut().spawn(parts).id();
        let go_on = |app: &mut App| {
            change::<Transform>(app, cloth, |place| place.translation.x += 1.0);
            tick(app, 1);
        };
        (0..5).for_each(|_| go_on(&mut app));
        let expect = |app: &mut App, edges: usize, place: Vec3| {
            let told = messages::<ClothTorn>(app);
            assert_eq!(told.len(), 1);
            assert_eq!(
                (told[0].cloth, told[0].edges, told[0].pieces),
                (cloth, edges, 1)
            );
            let off = told[0].place.distance(place);
            assert!(off < 2.0e-5, "{edge:?}: {off} m");
        };
        let middle =
            |app: &App| (in_world(app, cloth, edge[0]) + in_world(app, cloth, edge[1])) / 2.0;
        assert_eq!(tear(&mut app, cloth, [edge]), 1);
        go_on(&mut app);
        assert_eq!(particles(&app, cloth).len(), 81 + usize::from(opens));
        let place = if opens {
            assert_eq!(surface(&app, cloth).origin_of(81), edge[0]);
            in_world(&app, cloth, 81)
        } else {
            middle(&app)
        };
        expect(&mut app, 1, place);
        change::<ClothTears>(&mut app, cloth, |tears| *tears = ClothTears::none());
        go_on(&mut app);
        let place = middle(&app);
        expect(&mut app, 0, place);
    }
}

/// The last cloth that may tear loses its tears: a message says so in that tick, and not later, when another cloth may tear.
#[test]
fn the_last_mending_is_told_in_its_tick() {
    let mut app = app();
    let spawn = |app: &mut App| {
        let parts = (Cloth::new(9, 9, 0.1), ClothTears::default());
        app.world_mut().spawn(parts).id()
    };
    let cloth = spawn(&mut app);
    tick(&mut app, 2);
    assert!(cut_at(&mut app, -0.43) > 7);
    tick(&mut app, 1);
    let told = messages::<ClothTorn>(&mut app);
    assert_eq!((told.len(), told[0].pieces), (1, 2));
    app.world_mut().entity_mut(cloth).remove::<ClothTears>();
    tick(&mut app, 1);
    let told = messages::<ClothTorn>(&mut app);
    assert_eq!(told.len(), 1);
    assert_eq!(
        (told[0].cloth, told[0].edges, told[0].pieces),
        (cloth, 0, 1)
    );
    spawn(&mut app);
    tick(&mut app, 3);
    assert!(messages::<ClothTorn>(&mut app).is_empty());
}
