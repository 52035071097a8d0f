//! Which part of a cloth is drawn by gizmos, and in which colours.

use bevy::{
    ecs::reflect::ReflectComponent,
    gizmos::{GizmoAsset, GizmoHandles},
    prelude::*,
    reflect::TypeRegistry,
};
use bevy_drape::prelude::*;

use crate::support::*;

/// The corners of all lines that were drawn of a cloth at rest, 1.5 m wide and high.
fn corners(show: ShowClothGizmos) -> Vec<Vec3> {
    let mut app = app_with_gizmos();
    app.insert_resource(ClothGravity(Vec3::ZERO));
    app.world_mut().spawn((Cloth::default(), show));
    tick(&mut app, 2);
    let handles = app.world().resource::<GizmoHandles>().handles();
    let assets = app.world().resource::<Assets<GizmoAsset>>();
    let handle = handles.get(&std::any::TypeId::of::<ClothGizmos>());
    let asset = handle
        .and_then(Option::as_ref)
        .and_then(|handle| assets.get(handle));
    asset.map_or_else(Vec::new, |asset| {
        let buffer = asset.buffer();
        let corners = buffer.list_positions.iter().chain(&buffer.strip_positions);
        // A strip ends with a position that is NaN.
        corners.copied().filter(|corner| !corner.is_nan()).collect()
    })
}

#[test]
fn half_of_a_cloth_is_drawn() {
    let [left, right] = [Rect::new(0.0, 0.0, 0.5, 1.0), Rect::new(0.5, 0.0, 1.0, 1.0)];
    for show in [ShowClothGizmos::level(4), ShowClothGizmos::springs()] {
        let all = corners(show.clone()).len();
        let left = corners(show.clone().within(left));
        let right = corners(show.clone().within(right));
        // Leaves have a radius of half a spacing and less; the middle of 16 columns is between two.
        assert!(left.iter().all(|corner| corner.x < 0.75), "{show:?}");
        assert!(right.iter().all(|corner| corner.x > 0.75), "{show:?}");
        assert!(!left.is_empty() && left.len() == right.len(), "{show:?}");
        let across = all - left.len() - right.len();
        assert_eq!(
            across == 0,
            show.levels.is_some(),
            "springs from half to half"
        );
    }
    let nowhere = ShowClothGizmos::level(4).within(Rect::new(2.0, 2.0, 3.0, 3.0));
    assert!(corners(nowhere).is_empty());
    assert!(corners(ShowClothGizmos::nothing()).is_empty());
}

/// Red and green, and told apart by brightness alone (WCAG's contrast for graphics).
#[test]
fn colours_are_told_apart_without_seeing_colour() {
    let look = ClothGizmos::default();
    let brightness = |color: Color| color.to_linear().luminance();
    let (bright, dark) = (brightness(look.untouched), brightness(look.touching));
    let contrast = (bright + 0.05) / (dark + 0.05);
    assert!(contrast >= 3.0, "{contrast}");
}

#[test]
fn what_editors_insert_is_reflected() {
    let mut registry = TypeRegistry::default();
    registry.register::<ShowClothGizmos>();
    let of = std::any::TypeId::of::<ShowClothGizmos>();
    assert!(registry.get_type_data::<ReflectComponent>(of).is_some());
}
