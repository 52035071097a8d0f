//! The panel, drawn without a window.

mod changes;

use bevy::{
    ecs::{change_detection::DetectChanges, system::SystemState},
    prelude::*,
};

use super::*;
use crate::{
    cloth::{Cloth, ClothStiffening, ClothWeft},
    plugin::{DrapePlugins, draw::ShowClothGizmos, state::ClothStats},
    solver::ClothSettings,
};

fn app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()))
        .init_resource::<ClothPanel>();
    app
}

/// Draws a frame in a window of this size. Returns the place that the panel takes, and all that is painted.
fn frame(
    app: &mut App,
    context: &egui::Context,
    size: egui::Vec2,
    events: Vec<egui::Event>,
) -> (egui::Rect, egui::FullOutput) {
    let mut state = SystemState::<Shown>::new(app.world_mut());
    let mut shown = state.get_mut(app.world_mut()).expect("the panel's data");
    context.begin_pass(egui::RawInput {
        screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, size)),
        events,
        ..Default::default()
    });
    let place = shown.draw(context);
    let output = context.end_pass();
    state.apply(app.world_mut());
    (place, output)
}

/// The place that the panel takes after some frames in a window of this size.
fn draw(app: &mut App, context: &egui::Context, size: egui::Vec2) -> egui::Rect {
    let places = (0..3).map(|_| frame(app, context, size, Vec::new()).0);
    places.last().expect("three frames")
}

const WINDOW: egui::Vec2 = egui::vec2(1280.0, 720.0);

/// A window in which all rows of a cloth can be seen.
const TALL: egui::Vec2 = egui::vec2(1280.0, 2400.0);

/// All texts that can be seen after some frames in a window of this size, each with its place.
fn texts_in(app: &mut App, context: &egui::Context, size: egui::Vec2) -> Vec<(String, egui::Rect)> {
    let frames = (0..3).map(|_| frame(app, context, size, Vec::new()).1);
    let output = frames.last().expect("three frames");
    let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size);
    let mut texts = Vec::new();
    for clipped in output.shapes {
        let seen = clipped.clip_rect.intersect(screen).expand(0.5);
        let mut shapes = vec![clipped.shape];
        while let Some(shape) = shapes.pop() {
            match shape {
                egui::Shape::Vec(more) => shapes.extend(more),
                egui::Shape::Text(text) => {
                    let place = text.visual_bounding_rect();
                    if seen.contains_rect(place) {
                        texts.push((text.galley.text().to_string(), place));
                    }
                }
                _ => {}
            }
        }
    }
    texts
}

/// Those in a window of 1280 × 720.
fn texts(app: &mut App, context: &egui::Context) -> Vec<(String, egui::Rect)> {
    texts_in(app, context, WINDOW)
}

/// Clicks the text.
fn click(app: &mut App, context: &egui::Context, text: &str) {
    click_beside(app, context, text, None, WINDOW);
}

/// Clicks the text, or the widget this far to the right of where it begins.
fn click_beside(
    app: &mut App,
    context: &egui::Context,
    text: &str,
    beside: Option<f32>,
    size: egui::Vec2,
) {
    let seen = texts_in(app, context, size);
    let found = seen.iter().find(|(each, _)| each == text);
    let pos = found.map(|(_, place)| match beside {
        Some(by) => egui::pos2(place.left() + by, place.center().y),
        None => place.center(),
    });
    let pos = pos.unwrap_or_else(|| panic!("{text} is not to be seen: {seen:?}"));
    press(app, context, pos, size);
}

fn press(app: &mut App, context: &egui::Context, pos: egui::Pos2, size: egui::Vec2) {
    let button = |pressed| egui::Event::PointerButton {
        pos,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::NONE,
    };
    for event in [egui::Event::PointerMoved(pos), button(true), button(false)] {
        frame(app, context, size, vec![event]);
    }
}

/// Spawns cloths by name, and a context in which headers open at once and a clash of ids shows in any build.
fn cloths(count: usize) -> (App, egui::Context) {
    let mut app = app();
    for number in 1..=count {
        let name = Name::new(format!("cloth {number}"));
        app.world_mut().spawn((Cloth::default(), name));
    }
    app.update();
    let context = egui::Context::default();
    context.options_mut(|options| options.warn_on_id_clash = true);
    context.all_styles_mut(|style| style.animation_time = 0.0);
    (app, context)
}

#[test]
fn no_two_widgets_share_an_id() {
    for (count, headers) in [
        (2, &["debugging"][..]),
        (3, &["cloth 1", "cloth 2"]),
        (3, &["debugging"]),
        (9, &["9 cloths", "cloth 1", "cloth 2"]),
    ] {
        let (mut app, context) = cloths(count);
        for header in headers {
            click(&mut app, &context, header);
        }
        let seen = texts(&mut app, &context);
        assert!(seen.iter().any(|(text, _)| text == "cotton") || headers == ["debugging"]);
        let clash = seen.iter().find(|(text, _)| text.contains("use of"));
        assert_eq!(clash, None, "{count} cloths, {headers:?} open");
    }
}

#[test]
fn keys_are_in_sight_whatever_is_open() {
    for count in [0, 1, 2, 3, 8, 60] {
        let (mut app, context) = cloths(count);
        let keys = (0..14).map(|number| (format!("Key{number}"), format!("does {number}")));
        app.world_mut().resource_mut::<ClothPanel>().keys = keys.collect();
        for is_open in [false, true] {
            if is_open {
                click(&mut app, &context, "debugging");
            }
            let seen = texts(&mut app, &context);
            for number in 0..14 {
                for text in [format!("Key{number}"), format!("does {number}")] {
                    let is_seen = seen.iter().any(|(each, _)| *each == text);
                    assert!(is_seen, "{text} of {count} cloths, debugging: {is_open}");
                }
            }
        }
    }
}

#[test]
fn a_fabric_is_named_after_the_preset_it_was_made_from() {
    let cotton = ClothMaterial::COTTON;
    for (material, name) in [
        (cotton, "cotton"),
        (ClothMaterial::RUBBER, "rubber"),
        (
            ClothMaterial {
                damping: 0.03,
                ..cotton
            },
            "cotton, changed",
        ),
        (
            ClothMaterial {
                areal_density: 0.25,
                damping: 0.04,
                ..ClothMaterial::CANVAS
            },
            "canvas, changed",
        ),
        (
            ClothMaterial {
                shear_compliance: f32::INFINITY,
                ..ClothMaterial::SILK
            },
            "silk, changed",
        ),
    ] {
        let (mut app, context) = cloths(1);
        let mut materials = app.world_mut().query::<&mut ClothMaterial>();
        *materials.single_mut(app.world_mut()).expect("one cloth") = material;
        let seen = texts(&mut app, &context);
        assert!(
            seen.iter().any(|(text, _)| text == name),
            "{name}: {seen:?}"
        );
    }
}

#[test]
fn values_have_their_units_beside_them() {
    let (mut app, context) = cloths(1);
    app.world_mut().spawn(ClothColliderSpeed(2.5));
    let seen = texts(&mut app, &context);
    // A value and its unit are two texts, one after the other.
    for value in [["9.81", " m/s²"], ["2.50", " m/s"], ["50", " %"]] {
        let is_seen = seen.windows(2).any(|pair| {
            let [number, unit] = [&pair[0], &pair[1]];
            let is_beside = unit.1.left() - number.1.right() < 10.0;
            [&*number.0, &*unit.0] == value && is_beside
        });
        assert!(is_seen, "{value:?}: {seen:?}");
    }
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
        weft: Some(ClothWeft {
            stretch_compliance: 77.0,
            bend_rigidity: 0.0,
        }),
        stiffening: Some(ClothStiffening {
            strain: 9.0,
            factor: 1.0e9,
        }),
        stretch_damping: 0.0,
        damping: 0.999,
        friction: 7.0,
    };
    let settings = ClothSettings {
        particle_radius: 0.077_7,
        gravity: Some(Vec3::new(1.0, 400.0, -3.0)),
        ..default()
    };
    let cloth = (Cloth::default(), odd, settings);
    let cloth = app.world_mut().spawn(cloth).id();
    let speed = app.world_mut().spawn(ClothColliderSpeed(1.0e6)).id();
    app.insert_resource(ClothGravity(Vec3::new(1.0, 400.0, -3.0)));
    app.update();
    app.world_mut().clear_trackers();
    let context = egui::Context::default();
    click_beside(&mut app, &context, "debugging", None, TALL);
    draw(&mut app, &context, TALL);
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
    let settings = world.entity(cloth).get_ref::<ClothSettings>();
    assert!(!settings.expect("some").is_changed(), "nor its settings");
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
    let size = egui::vec2(1280.0, 1400.0);
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
                let (place, _) = frame(&mut app, &context, size, vec![event]);
                assert_eq!(place.width(), ClothPanel::WIDTH, "{pos}");
            }
        }
        app.update();
        let material = app.world().get::<ClothMaterial>(cloth).expect("one");
        assert_eq!(material.validate(), Ok(()), "{column}");
        assert!(
            app.world()
                .get::<crate::plugin::state::ClothFault>(cloth)
                .is_none()
        );
    }
    let material = app.world().get::<ClothMaterial>(cloth).expect("one");
    let shows = app.world().entity(cloth).contains::<ShowClothGizmos>();
    assert!(
        *material != ClothMaterial::default() && shows,
        "clicks reach widgets"
    );
}
