//! Bevy's pointers over cloth, without a window: rays instead of a camera's picture.

use bevy::{
    camera::{
        Camera, NormalizedRenderTarget,
        visibility::{RenderLayers, ViewVisibility},
    },
    picking::{
        InteractionPlugin, PickingPlugin, PickingSystems,
        backend::ray::{RayId, RayMap},
        pointer::{Location, PointerAction, PointerButton, PointerId, PointerInput},
    },
    prelude::*,
};
use bevy_drape::prelude::*;

use crate::{schedule::refuse_ambiguities, support::*};

/// The ray of the only pointer, if it is over the camera's picture.
#[derive(Resource)]
struct Ray(Option<Ray3d>);

#[derive(Resource)]
struct Eye(Entity);

/// The cloths that were clicked, and the faces.
#[derive(Resource, Default)]
struct Clicked(Vec<(Entity, usize)>);

fn look(mut rays: ResMut<RayMap>, ray: Res<Ray>, eye: Res<Eye>) {
    let id = RayId::new(eye.0, PointerId::Mouse);
    rays.map.clear();
    rays.map.extend(ray.0.map(|ray| (id, ray)));
}

fn note(click: On<Pointer<Press>>, mut clicked: ResMut<Clicked>) {
    let hit = click.hit.extra_as::<ClothHit>();
    clicked.0.extend(hit.map(|hit| (click.entity, hit.face)));
}

/// A hanging sheet in front of a pointer.
fn app_with_pointer(plugin: ClothPickingPlugin) -> (App, Entity) {
    let mut app = with_plugins((
        PickingPlugin,
        InteractionPlugin,
        DrapePlugins::default(),
        plugin,
    ));
    let eye = app.world_mut().spawn(Camera::default()).id();
    app.world_mut().spawn(PointerId::Mouse);
    let ray = Ray3d::new(Vec3::new(0.5, -0.5, 2.0), Dir3::NEG_Z);
    app.insert_resource(Ray(Some(ray)))
        .insert_resource(Eye(eye))
        .init_resource::<Clicked>()
        .add_systems(
            PreUpdate,
            look.in_set(PickingSystems::ProcessInput)
                .after(RayMap::repopulate),
        );
    let sheet = Cloth::new(21, 21, 0.05);
    let cloth = app.world_mut().spawn(sheet).observe(note).id();
    tick(&mut app, 16);
    (app, cloth)
}

/// Nothing of it runs in an order that Bevy picks.
#[test]
fn no_system_of_picking_is_ambiguous() {
    let (mut app, _) = app_with_pointer(ClothPickingPlugin::default());
    refuse_ambiguities(&mut app);
    point(&mut app, PointerAction::Press(PointerButton::Primary));
    assert_eq!(hands(&mut app), 1);
}

fn input(action: PointerAction) -> PointerInput {
    let location = Location {
        target: NormalizedRenderTarget::None {
            width: 100,
            height: 100,
        },
        position: Vec2::ZERO,
    };
    PointerInput::new(PointerId::Mouse, location, action)
}

fn point(app: &mut App, action: PointerAction) {
    app.world_mut().write_message(input(action));
    tick(app, 1);
}

fn shift(app: &mut App, by: Vec3) {
    let ray = app.world_mut().resource_mut::<Ray>().into_inner();
    ray.0 = ray.0.map(|ray| Ray3d::new(ray.origin + by, ray.direction));
}

fn hands(app: &mut App) -> usize {
    let mut hands = app.world_mut().query::<&ClothGrab>();
    hands.iter(app.world()).count()
}

fn middle(app: &App, cloth: Entity) -> Vec3 {
    position(app, cloth, (10, 10))
}

/// Pressed on a cloth, a pointer takes it along, at the same distance; released, it falls back.
#[test]
fn a_pointer_drags_cloth() {
    let (mut app, cloth) = app_with_pointer(ClothPickingPlugin::default());
    let start = middle(&app, cloth);
    point(&mut app, PointerAction::Press(PointerButton::Secondary));
    assert_eq!(hands(&mut app), 0, "another button");
    point(&mut app, PointerAction::Release(PointerButton::Secondary));
    point(&mut app, PointerAction::Press(PointerButton::Primary));
    assert_eq!(hands(&mut app), 1);
    let clicked = &app.world().resource::<Clicked>().0;
    assert!(clicked.iter().all(|(entity, _)| *entity == cloth));
    assert_eq!(clicked.len(), 2, "by either button");
    for _ in 0..20 {
        shift(&mut app, 0.01 * Vec3::Y);
        tick(&mut app, 1);
    }
    let risen = middle(&app, cloth) - start;
    assert!(risen.distance(0.2 * Vec3::Y) < 0.01, "{risen}");
    // Outside of the picture the hand stays where it is.
    let ray = app.world().resource::<Ray>().0;
    app.insert_resource(Ray(None));
    tick(&mut app, 8);
    assert!((middle(&app, cloth) - start).distance(risen) < 1.0e-3);
    app.insert_resource(Ray(ray));
    point(&mut app, PointerAction::Release(PointerButton::Primary));
    assert_eq!(hands(&mut app), 0);
    tick(&mut app, 256);
    assert!(middle(&app, cloth).distance(start) < 0.02);
}

/// Beside a cloth there is nothing to take. A cloth that pointers ignore, or that is not to be dragged, stays.
#[test]
fn a_pointer_takes_nothing_else() {
    let (mut app, cloth) = app_with_pointer(ClothPickingPlugin::default());
    shift(&mut app, 3.0 * Vec3::X);
    point(&mut app, PointerAction::Press(PointerButton::Primary));
    assert_eq!(hands(&mut app), 0);
    point(&mut app, PointerAction::Release(PointerButton::Primary));
    shift(&mut app, -3.0 * Vec3::X);
    app.world_mut().entity_mut(cloth).insert(Pickable::IGNORE);
    point(&mut app, PointerAction::Press(PointerButton::Primary));
    assert_eq!(hands(&mut app), 0);
    assert!(app.world().resource::<Clicked>().0.is_empty());
    let (mut app, _) = app_with_pointer(ClothPickingPlugin { button: None });
    point(&mut app, PointerAction::Press(PointerButton::Primary));
    assert_eq!(hands(&mut app), 0);
    assert_eq!(app.world().resource::<Clicked>().0.len(), 1);
}

/// Released and pressed again in one frame, the pointer holds on by a new hand; pressed and released, by none.
#[test]
fn a_pointer_may_be_quick() {
    let (mut app, _) = app_with_pointer(ClothPickingPlugin::default());
    let [press, release] =
        [PointerAction::Press, PointerAction::Release].map(|of| of(PointerButton::Primary));
    let both = |app: &mut App, actions: [PointerAction; 2]| {
        let [first, second] = actions;
        app.world_mut().write_message(input(first));
        point(app, second);
        hands(app)
    };
    point(&mut app, press);
    assert_eq!(both(&mut app, [release, press]), 1);
    point(&mut app, release);
    assert_eq!(hands(&mut app), 0);
    assert_eq!(both(&mut app, [press, release]), 0);
}

/// A cloth that no camera shows, or that is in other layers than the camera, is not hit. One that lets pointers through does
/// not hide the one behind it.
#[test]
fn pointers_hit_visible_cloth() {
    let (mut app, cloth) = app_with_pointer(ClothPickingPlugin { button: None });
    let clicks = |app: &mut App| {
        point(app, PointerAction::Press(PointerButton::Primary));
        point(app, PointerAction::Release(PointerButton::Primary));
        std::mem::take(&mut app.world_mut().resource_mut::<Clicked>().0).len()
    };
    assert_eq!(clicks(&mut app), 1);
    app.world_mut()
        .entity_mut(cloth)
        .insert(ViewVisibility::HIDDEN);
    assert_eq!(clicks(&mut app), 0);
    app.world_mut().entity_mut(cloth).remove::<ViewVisibility>();
    app.world_mut()
        .entity_mut(cloth)
        .insert(RenderLayers::layer(3));
    assert_eq!(clicks(&mut app), 0);
    app.world_mut()
        .entity_mut(cloth)
        .insert(RenderLayers::layer(0));
    let through = Pickable {
        should_block_lower: false,
        is_hoverable: true,
    };
    let curtain = (Cloth::new(21, 21, 0.05), Transform::from_xyz(0.0, 0.0, 0.5));
    let curtain = app.world_mut().spawn(curtain).observe(note).id();
    tick(&mut app, 8);
    assert_eq!(clicks(&mut app), 1);
    app.world_mut().entity_mut(curtain).insert(through);
    assert_eq!(clicks(&mut app), 2);
}

/// A hand whose cloth has gone goes too, and a cancelled touch lets go.
#[test]
fn a_pointers_hand_does_not_stay() {
    let (mut app, cloth) = app_with_pointer(ClothPickingPlugin::default());
    let count = app.world().entities().count_spawned();
    point(&mut app, PointerAction::Press(PointerButton::Primary));
    point(&mut app, PointerAction::Cancel);
    assert_eq!(app.world().entities().count_spawned(), count);
    point(&mut app, PointerAction::Release(PointerButton::Primary));
    point(&mut app, PointerAction::Press(PointerButton::Primary));
    assert_eq!(hands(&mut app), 1);
    app.world_mut().entity_mut(cloth).insert(ClothTeleport);
    tick(&mut app, 3);
    assert_eq!(app.world().entities().count_spawned(), count);
}
