//! What is logged: by name, once, many in one line.

use std::sync::{Mutex, Once, PoisonError};

use bevy::{
    log::{
        tracing::{self, Event, Subscriber, field::Visit},
        tracing_subscriber::{
            Registry,
            layer::{Context, Layer, SubscriberExt},
        },
    },
    prelude::*,
};
use bevy_drape::prelude::*;

use crate::support::*;

static LINES: Mutex<Vec<String>> = Mutex::new(Vec::new());

struct Capture;

impl<S: Subscriber> Layer<S> for Capture {
    fn on_event(&self, event: &Event, _: Context<S>) {
        struct Message(String);
        impl Visit for Message {
            fn record_debug(&mut self, field: &tracing::field::Field, value: &dyn std::fmt::Debug) {
                if field.name() == "message" {
                    self.0 = format!("{value:?}");
                }
            }
        }
        let mut message = Message(String::new());
        event.record(&mut message);
        let lines = LINES.lock();
        lines
            .unwrap_or_else(PoisonError::into_inner)
            .push(message.0);
    }
}

/// Begins to listen to the log of this whole program.
pub fn listen() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let listener = Registry::default().with(Capture);
        tracing::subscriber::set_global_default(listener).expect("nobody else listens");
    });
}

/// The lines so far with a text that only one test has.
pub fn lines_with(text: &str) -> Vec<String> {
    let lines = LINES.lock().unwrap_or_else(PoisonError::into_inner);
    let has_text = |line: &&String| line.contains(text);
    lines.iter().filter(has_text).cloned().collect()
}

/// What its sub-steps do not hold.
fn overstretched() -> impl Bundle {
    let settings = ClothSettings {
        tethers: false,
        sleeps: false,
        ..ClothSettings::substeps(3)
    };
    let pins = Pins::new([Pin::Corner(Corner::TopLeft)]);
    (Cloth::new(32, 32, 0.05), pins, settings, solved_once())
}

/// The limit is 15 % and the 2.8 % that cotton gives under four times this cloth's weight, hung by one particle.
#[test]
fn a_limit_is_logged_by_name_with_figures_in_per_cent() {
    listen();
    let mut app = app();
    app.world_mut()
        .spawn((overstretched(), Name::new("banner")));
    tick(&mut app, 128);
    let lines = lines_with("banner");
    let [line] = &lines[..] else {
        panic!("once: {lines:?}");
    };
    assert!(
        line.starts_with("cloth \"banner\" is overstretched: ")
            && line.contains(" % (limit 17.8 %): more sub-steps"),
        "{line}"
    );
}

#[test]
fn sixty_cloths_are_one_line() {
    listen();
    let mut app = app();
    for index in 0..60 {
        let name = Name::new(format!("pennant {index}"));
        app.world_mut().spawn((overstretched(), name));
    }
    tick(&mut app, 128);
    assert_eq!(messages::<ClothLimitExceeded>(&mut app).len(), 60);
    let lines = lines_with("pennant");
    let [line] = &lines[..] else {
        panic!("one line: {lines:?}");
    };
    assert!(
        line.starts_with("60 cloths are overstretched, cloth \"pennant "),
        "{line}"
    );
}

#[test]
fn faults_are_logged_by_name_and_those_alike_in_one_line() {
    listen();
    let mut app = app();
    let bad = |spacing| Cloth::new(4, 4, spacing);
    app.world_mut().spawn((bad(-0.1), Name::new("sail")));
    tick(&mut app, 5);
    let lines = lines_with("\"sail\"");
    let [line] = &lines[..] else {
        panic!("once: {lines:?}");
    };
    assert_eq!(
        line,
        "cloth \"sail\" is left out of the cloth simulation: spacing (m) must be positive, not -0.1"
    );
    for index in 0..60 {
        let name = Name::new(format!("awning {index}"));
        app.world_mut().spawn((bad(-0.1), name));
    }
    tick(&mut app, 5);
    let lines = lines_with("awning");
    assert!(
        matches!(&lines[..], [line] if line.contains("and 59 more are left out")),
        "{lines:?}"
    );
}

/// Gravity, material and settings that change in every tick silence nothing and repeat nothing.
#[test]
fn what_is_animated_silences_no_warning() {
    listen();
    let mut app = app();
    let animate = |mut cloths: Query<(&mut ClothSettings, &mut ClothMaterial)>,
                   mut gravity: ResMut<ClothGravity>,
                   mut up: Local<bool>| {
        *up = !*up;
        let some = if *up { 1.0e-4 } else { 0.0 };
        gravity.0.y = -9.81 - some;
        for (mut settings, mut material) in &mut cloths {
            settings.particle_radius = 0.01 + some;
            material.damping = 0.01 + some;
        }
    };
    app.add_systems(FixedFirst, animate);
    app.world_mut()
        .spawn((overstretched(), Name::new("streamer")));
    tick(&mut app, 256);
    assert_eq!(messages::<ClothLimitExceeded>(&mut app).len(), 1);
    assert_eq!(lines_with("streamer").len(), 1);
}
