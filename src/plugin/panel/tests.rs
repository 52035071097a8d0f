//! The panel, drawn without a window.

use bevy::{
    ecs::{change_detection::DetectChanges, system::SystemState},
    prelude::*,
};

use super::*;
use crate::{
    cloth::Cloth,
    plugin::{ClothStats, DrapePlugins, ShowClothGizmos},
    solver::ClothSettings,
};

fn app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()))
        .init_resource::<ClothPanel>();
    app
}

/// The place that the panel takes after some frames in a window of this size.
fn draw(app: &mut App, context: &egui::Context, size: egui::Vec2) -> egui::Rect {
    let mut state = SystemState::<Shown>::new(app.world_mut());
    let mut place = egui::Rect::NOTHING;
    for _ in 0..3 {
        let mut shown = state.get_mut(app.world_mut()).expect("the panel's data");
        let input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, size)),
            ..Default::default()
        };
        context.begin_pass(input);
        place = shown.draw(context);
        let _output = context.end_pass();
        state.apply(app.world_mut());
    }
    place
}

/// Whatever is shown in it, and however small the window is.
#[test]
fn its_width_does_not_jump() {
    let mut app = app();
    let context = egui::Context::default();
    let window = egui::vec2(1280.0, 720.0);
    let expected =
        egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(ClothPanel::WIDTH, 720.0));
    assert_eq!(draw(&mut app, &context, window), expected, "no cloth");
    let long =
        Name::new("a cloth whose name is much longer than the panel can be wide in any window");
    let speed = (long.clone(), ClothColliderSpeed(-12_345.678));
    app.world_mut().spawn(speed);
    let cloth = app.world_mut().spawn((Cloth::default(), long)).id();
    app.update();
    assert_eq!(draw(&mut app, &context, window), expected, "one cloth");
    let mut stats = app
        .world_mut()
        .get_mut::<ClothStats>(cloth)
        .expect("figures");
    stats.exceeded = Some(crate::solver::ClothLimit::Stretch);
    stats.contacts = usize::MAX;
    let mut material = app
        .world_mut()
        .get_mut::<ClothMaterial>(cloth)
        .expect("one");
    material.friction = 123_456.78;
    material.areal_density = 1.0e-30;
    assert_eq!(draw(&mut app, &context, window), expected, "large numbers");
    for _ in 0..40 {
        app.world_mut().spawn(Cloth::default());
    }
    app.update();
    assert_eq!(draw(&mut app, &context, window), expected, "it scrolls");
}

#[test]
fn showing_a_value_does_not_change_it() {
    let mut app = app();
    let odd = ClothMaterial {
        areal_density: 77.7,
        stretch_compliance: 0.123_456_79,
        shear_compliance: f32::INFINITY,
        bend_rigidity: 3.3e-9,
        stretch_damping: 0.0,
        damping: 0.999,
        friction: 7.0,
    };
    let cloth = app.world_mut().spawn((Cloth::default(), odd)).id();
    let speed = app.world_mut().spawn(ClothColliderSpeed(1.0e6)).id();
    app.insert_resource(ClothGravity(Vec3::new(1.0, 400.0, -3.0)));
    app.update();
    app.world_mut().clear_trackers();
    let settings = *app.world().get::<ClothSettings>(cloth).expect("settings");
    draw(
        &mut app,
        &egui::Context::default(),
        egui::vec2(800.0, 600.0),
    );
    let world = app.world();
    assert_eq!(world.get(cloth), Some(&odd));
    assert_eq!(world.get(cloth), Some(&settings));
    assert_eq!(world.get(speed), Some(&ClothColliderSpeed(1.0e6)));
    assert_eq!(
        world.resource::<ClothGravity>().0,
        Vec3::new(1.0, 400.0, -3.0)
    );
    assert!(
        !world
            .get_entity(cloth)
            .expect("the cloth")
            .contains::<ShowClothGizmos>()
    );
    let material = world.entity(cloth).get_ref::<ClothMaterial>().expect("one");
    assert!(!material.is_changed(), "not even marked as changed");
}

#[test]
fn the_rest_of_the_window_is_left_to_the_scene() {
    let mut panel = ClothPanel::default();
    let width = ClothPanel::WIDTH as u32;
    let viewport = panel.viewport(UVec2::new(1280, 720), 1.0).expect("one");
    assert_eq!(viewport.physical_position, UVec2::new(width, 0));
    assert_eq!(viewport.physical_size, UVec2::new(1280 - width, 720));
    let viewport = panel.viewport(UVec2::new(2560, 1440), 2.0).expect("one");
    assert_eq!(viewport.physical_position, UVec2::new(2 * width, 0));
    assert_eq!(viewport.physical_size, UVec2::new(2560 - 2 * width, 1440));
    for window in [UVec2::ZERO, UVec2::new(300, 200), UVec2::new(1280, 0)] {
        assert!(panel.viewport(window, 1.0).is_none(), "{window}");
    }
    panel.visible = false;
    assert!(panel.viewport(UVec2::new(1280, 720), 1.0).is_none());
}

/// Every widget is hovered, pressed and released, folded parts and menus that open on the way included.
#[test]
fn clicks_anywhere_leave_it_working() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    app.world_mut().spawn(ClothColliderSpeed(1.0));
    app.update();
    let context = egui::Context::default();
    let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(1280.0, 1400.0));
    let mut state = SystemState::<Shown>::new(app.world_mut());
    for column in [20.0, 60.0, 150.0, 190.0, 250.0] {
        for row in 1..110 {
            let pos = egui::pos2(column, 12.0 * row as f32);
            let button = |pressed| egui::Event::PointerButton {
                pos,
                button: egui::PointerButton::Primary,
                pressed,
                modifiers: egui::Modifiers::NONE,
            };
            let frames = [egui::Event::PointerMoved(pos), button(true), button(false)];
            for event in frames {
                let mut shown = state.get_mut(app.world_mut()).expect("the panel's data");
                context.begin_pass(egui::RawInput {
                    screen_rect: Some(screen),
                    events: vec![event],
                    ..Default::default()
                });
                let place = shown.draw(&context);
                let _output = context.end_pass();
                state.apply(app.world_mut());
                assert_eq!(place.width(), ClothPanel::WIDTH, "{pos}");
            }
        }
        app.update();
        let material = app.world().get::<ClothMaterial>(cloth).expect("one");
        assert_eq!(material.validate(), Ok(()), "{column}");
        assert!(app.world().get::<super::super::ClothFault>(cloth).is_none());
    }
    let material = app.world().get::<ClothMaterial>(cloth).expect("one");
    let shows = app.world().entity(cloth).contains::<ShowClothGizmos>();
    assert!(
        *material != ClothMaterial::default() && shows,
        "clicks reach widgets"
    );
}
