//! Bevy's pointers over cloth, without a window: rays instead of a camera's picture, or a picture that nobody draws.

use bevy::{
    asset::AssetPlugin,
    camera::{
        Camera, CameraProjection, CameraProjectionPlugin, ComputedCameraValues,
        NormalizedRenderTarget, RenderTargetInfo,
        visibility::{RenderLayers, ViewVisibility, VisibilityPlugin},
    },
    mesh::MeshPlugin,
    picking::{
        InteractionPlugin, PickingPlugin, PickingSystems,
        backend::ray::{RayId, RayMap},
        pointer::{Location, PointerAction, PointerButton, PointerId, PointerInput},
    },
    prelude::*,
    window::{PrimaryWindow, WindowRef},
};
use bevy_drape::prelude::*;

use crate::{
    meshes::sheets::{add, asset},
    schedule::refuse_ambiguities,
    shared_meshes::irregular,
    support::*,
};

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

/// Plugins that find what is below a pointer in a camera's picture, with Bevy's own hits of meshes or without.
struct PicturePlugin {
    hits_meshes: bool,
}

impl Plugin for PicturePlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((
            AssetPlugin::default(),
            MeshPlugin,
            VisibilityPlugin,
            CameraProjectionPlugin,
            PickingPlugin,
            InteractionPlugin,
            DrapePlugins::default(),
            ClothPickingPlugin::default(),
        ));
        if self.hits_meshes {
            app.add_plugins(MeshPickingPlugin);
        }
    }
}

/// The picture, in pixels, and the angle that it shows from top to bottom (rad).
const PICTURE: Vec2 = Vec2::new(800.0, 600.0);
const ANGLE: f32 = std::f32::consts::FRAC_PI_4;
/// How far the camera is from the cloth, and what it does not show (m).
const FAR: f32 = 2.0;
const NEAR: f32 = 0.1;

/// The entities that were pressed first, before a press goes on to what is above.
#[derive(Resource, Default)]
struct Pressed(Vec<Entity>);

/// An app with a window, a mouse, and a camera in front of the middle of a sheet that hangs at the origin. A renderer would
/// tell the camera the size of its picture.
fn app_with_camera(hits_meshes: bool) -> (App, Entity) {
    let mut app = with_plugins(PicturePlugin { hits_meshes });
    app.init_resource::<Pressed>().add_observer(
        |press: On<Pointer<Press>>, mut pressed: ResMut<Pressed>| {
            if press.original_event_target() == press.entity {
                pressed.0.push(press.entity);
            }
        },
    );
    let window = (Window::default(), PrimaryWindow);
    let window = app.world_mut().spawn(window).id();
    app.world_mut().spawn(PointerId::Mouse);
    let projection = PerspectiveProjection {
        fov: ANGLE,
        aspect_ratio: PICTURE.x / PICTURE.y,
        near: NEAR,
        ..default()
    };
    let camera = Camera {
        computed: ComputedCameraValues {
            clip_from_view: projection.get_clip_from_view(),
            target_info: Some(RenderTargetInfo {
                physical_size: PICTURE.as_uvec2(),
                scale_factor: 1.0,
            }),
            ..default()
        },
        ..default()
    };
    let place = Transform::from_xyz(0.5, -0.5, FAR);
    let projection = Projection::Perspective(projection);
    app.world_mut().spawn((camera, projection, place));
    (app, window)
}

/// Moves the mouse to a place in the picture, and does something there.
fn mouse(app: &mut App, window: Entity, at: Vec2, action: Option<PointerAction>) {
    let window = WindowRef::Primary.normalize(Some(window));
    let location = Location {
        target: NormalizedRenderTarget::Window(window.expect("a window")),
        position: at,
    };
    let there = PointerAction::Move { delta: Vec2::ZERO };
    for action in [there].into_iter().chain(action) {
        let input = PointerInput::new(PointerId::Mouse, location.clone(), action);
        app.world_mut().write_message(input);
    }
    tick(app, 1);
}

/// A press of the mouse on the middle of the picture, and whether a hand holds cloth then; it is released again.
fn press_takes(app: &mut App, window: Entity) -> bool {
    tick(app, 2);
    let middle = PICTURE / 2.0;
    let [press, release] =
        [PointerAction::Press, PointerAction::Release].map(|of| of(PointerButton::Primary));
    mouse(app, window, middle, Some(press));
    let takes = hands(app) > 0;
    mouse(app, window, middle, Some(release));
    assert_eq!(hands(app), 0);
    takes
}

/// Presses the mouse on the middle of the picture, moves it 60 pixels up, and releases it: the cloth's middle goes with it, and
/// falls back.
fn drags(app: &mut App, window: Entity, cloth: Entity) {
    let start = middle(app, cloth);
    let at = |pixels: f32| PICTURE / 2.0 - pixels * Vec2::Y;
    mouse(app, window, at(0.0), None);
    let press = PointerAction::Press(PointerButton::Primary);
    mouse(app, window, at(0.0), Some(press));
    assert_eq!(hands(app), 1);
    for pixels in 1..=20 {
        mouse(app, window, at(3.0 * pixels as f32), None);
    }
    tick(app, 4);
    // A ray begins where the camera begins to show, and the hand stays as far along it as at first. `slope` is its slope upwards.
    let slope = (ANGLE / 2.0).tan() * 60.0 / (PICTURE.y / 2.0);
    let ray = Vec3::new(0.0, slope, -1.0);
    let expected = ray * NEAR + ray.normalize() * (FAR - NEAR) + Vec3::Z * FAR;
    let moved = middle(app, cloth) - start;
    // The hand keeps its particle to rounding, and the cloth hangs to a millimetre in the plane of the origin.
    assert!(moved.distance(expected) < 2.0e-3, "{moved} {expected}");
    let release = PointerAction::Release(PointerButton::Primary);
    mouse(app, window, at(60.0), Some(release));
    assert_eq!(hands(app), 0);
    tick(app, 256);
    assert!(middle(app, cloth).distance(start) < 0.02);
}

/// A mouse over a camera's picture drags the cloth below it, whether Bevy's own backend hits meshes, too, or not.
#[test]
fn a_mouse_drags_cloth_in_a_picture() {
    for hits_meshes in [false, true] {
        let (mut app, window) = app_with_camera(hits_meshes);
        let cloth = app.world_mut().spawn(Cloth::new(21, 21, 0.05)).id();
        tick(&mut app, 16);
        drags(&mut app, window, cloth);
        assert_eq!(app.world().resource::<Pressed>().0, [cloth]);
        // Beside it is nothing to take.
        let press = PointerAction::Press(PointerButton::Primary);
        mouse(&mut app, window, Vec2::new(20.0, 300.0), Some(press));
        assert_eq!(hands(&mut app), 0);
    }
}

/// A hidden cloth is dragged by the fine mesh that it drives. By Bevy's own backend it is the mesh that is pressed, which is in
/// front. If no camera shows the mesh, or pointers ignore it or the cloth, there is nothing to take.
#[test]
fn a_hidden_cloth_is_dragged_by_its_mesh() {
    for hits_meshes in [false, true] {
        let (mut app, window) = app_with_camera(hits_meshes);
        let sheet = (Cloth::new(21, 21, 0.05), Visibility::Hidden);
        let cloth = app.world_mut().spawn(sheet).id();
        tick(&mut app, 2);
        assert!(!press_takes(&mut app, window), "nothing is shown");
        let mesh = irregular(1.0, 1.0, 0.04, 0.2);
        let mesh = add(&mut app, asset(&mesh.positions, &mesh.triangles));
        let place = Transform::from_xyz(0.0, 0.0, 0.02);
        let fine = (ClothRenderMesh { cloth }, Mesh3d(mesh), place);
        let fine = app.world_mut().spawn((fine, Visibility::default())).id();
        tick(&mut app, 16);
        assert!(app.world().get::<ClothFault>(fine).is_none());
        app.world_mut().resource_mut::<Pressed>().0.clear();
        drags(&mut app, window, cloth);
        let expected = if hits_meshes { fine } else { cloth };
        assert_eq!(app.world().resource::<Pressed>().0, [expected]);

        change::<Visibility>(&mut app, fine, |own| *own = Visibility::Hidden);
        assert!(!press_takes(&mut app, window), "hidden");
        change::<Visibility>(&mut app, fine, |own| *own = Visibility::Inherited);
        assert!(press_takes(&mut app, window), "shown again");
        let mut mesh = app.world_mut().entity_mut(fine);
        mesh.insert(RenderLayers::layer(3));
        assert!(!press_takes(&mut app, window), "in other layers");
        let mut mesh = app.world_mut().entity_mut(fine);
        mesh.remove::<RenderLayers>();
        for ignored in [fine, cloth] {
            let mut entity = app.world_mut().entity_mut(ignored);
            entity.insert(Pickable::IGNORE);
            assert!(!press_takes(&mut app, window), "ignored");
            app.world_mut().entity_mut(ignored).remove::<Pickable>();
        }
        assert!(press_takes(&mut app, window), "as at first");
        // A mesh whose cloth is gone is no cloth.
        app.world_mut().despawn(cloth);
        assert!(!press_takes(&mut app, window), "gone");
    }
}
