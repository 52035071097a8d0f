//! Mistakes in a scene that are no fault: each is one line of the log, by name, with the value and the remedy.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::{
    fuzz::random::Random,
    log::{lines_with, listen},
    support::*,
};

/// The one line with this text.
fn only_line(text: &str) -> String {
    let lines = lines_with(text);
    let [line] = &lines[..] else {
        panic!("one line of {text}: {lines:?}");
    };
    line.clone()
}

/// Long enough for what is gathered to be logged.
const GATHERED: usize = 48;

/// By what a curtain is moved.
#[derive(Debug, Clone, Copy)]
enum Carrier {
    Itself,
    Parent,
    Target,
}

const CARRIERS: [Carrier; 3] = [Carrier::Itself, Carrier::Parent, Carrier::Target];

/// A curtain of that name, and the entity that moves it.
fn curtain(app: &mut App, name: &str, carrier: Carrier) -> [Entity; 2] {
    let world = app.world_mut();
    let cloth = (Cloth::new(8, 6, 0.1), Name::new(name.to_string()));
    let cloth = world.spawn((cloth, Transform::default())).id();
    let mover = match carrier {
        Carrier::Itself => cloth,
        Carrier::Parent | Carrier::Target => world.spawn(Transform::default()).id(),
    };
    match carrier {
        Carrier::Itself => {}
        Carrier::Parent => {
            world.entity_mut(cloth).insert(ChildOf(mover));
        }
        Carrier::Target => {
            let attached = ClothAttachments::new([(Pin::Row(0), mover)]);
            world.entity_mut(cloth).insert((Pins::none(), attached));
        }
    }
    [cloth, mover]
}

fn jump(app: &mut App, mover: Entity, by: Vec3) {
    change::<Transform>(app, mover, |place| place.translation += by);
}

/// Once for each cloth, and its stretch is not logged besides.
#[test]
fn a_jump_that_drags_a_cloth_along_is_logged() {
    listen();
    for carrier in CARRIERS {
        let mut app = app();
        let name = format!("dragged by {carrier:?}");
        let [_, mover] = curtain(&mut app, &name, carrier);
        tick(&mut app, 20);
        jump(&mut app, mover, Vec3::new(3.0, 0.0, -4.0));
        tick(&mut app, GATHERED);
        let expected = format!(
            "cloth \"{name}\" was dragged along by a jump: 5.0 m in a tick (limit 2 m): insert `ClothTeleport` "
        );
        let line = only_line(&name);
        assert!(line.starts_with(&expected), "{line}");
        jump(&mut app, mover, Vec3::Y * 9.0);
        tick(&mut app, GATHERED);
        assert_eq!(only_line(&name), line);
    }
}

#[test]
fn cloths_that_are_dragged_along_together_are_one_line() {
    listen();
    let mut app = app();
    let bearer = app.world_mut().spawn(Transform::default()).id();
    for index in 0..5 {
        let name = Name::new(format!("ribbon {index}"));
        let place = Transform::from_xyz(index as f32, 0.0, 0.0);
        let cloth = (Cloth::new(6, 6, 0.1), name, place, ChildOf(bearer));
        app.world_mut().spawn(cloth);
    }
    tick(&mut app, 4);
    jump(&mut app, bearer, Vec3::X * 12.0);
    tick(&mut app, GATHERED);
    let line = only_line("ribbon");
    let expected = "5 cloths were dragged along by a jump, cloth \"ribbon ";
    assert!(line.starts_with(expected), "{line}");
}

/// A runner, a car, a jet that took its time, and teleports of all kinds.
#[test]
fn what_moves_fast_or_teleports_is_not_logged() {
    listen();
    for carrier in CARRIERS {
        for speed in [10.0, 60.0] {
            let mut app = app();
            let [_, mover] = curtain(&mut app, &format!("fast by {carrier:?}"), carrier);
            tick(&mut app, 4);
            for _ in 0..40 {
                jump(&mut app, mover, Vec3::Z * speed * TICK);
                tick(&mut app, 1);
            }
        }
        let mut app = app();
        let [_, mover] = curtain(&mut app, &format!("jet by {carrier:?}"), carrier);
        tick(&mut app, 4);
        for passed in 0..160 {
            let speed = 3.0 * passed.min(100) as f32;
            jump(&mut app, mover, Vec3::Z * speed * TICK);
            tick(&mut app, 1);
        }
        for (has_inertia, is_of_cloth) in [(true, false), (false, false), (false, true)] {
            let mut app = crate::support::app();
            let [cloth, mover] = curtain(&mut app, &format!("beamed by {carrier:?}"), carrier);
            if has_inertia {
                let inertia = ClothInertia::default();
                app.world_mut().entity_mut(mover).insert(inertia);
            }
            tick(&mut app, 4);
            jump(&mut app, mover, Vec3::X * 50.0);
            if !has_inertia {
                let marked = if is_of_cloth { cloth } else { mover };
                app.world_mut().entity_mut(marked).insert(ClothTeleport);
            }
            tick(&mut app, GATHERED);
        }
    }
    for text in ["fast by", "jet by", "beamed by"] {
        let lines = lines_with(text);
        let dragged = lines.iter().filter(|line| line.contains("dragged"));
        assert_eq!(dragged.count(), 0, "{lines:?}");
    }
}

/// Any jump, of anything that carries any cloth; and no honest speed.
#[test]
fn random_jumps_are_logged_and_random_speeds_are_not() {
    listen();
    let mut random = Random(7);
    for case in 0..24 {
        let mut app = app();
        let carrier = CARRIERS[case % 3];
        let names = ["leap", "trot"].map(|name| format!("{name} {case:02}"));
        let [leap, trot] = [0, 1].map(|index| curtain(&mut app, &names[index], carrier)[1]);
        tick(&mut app, 1 + random.below(10));
        let way = 2.2 + 60.0 * random.part();
        let direction = Vec3::from([0; 3].map(|_| random.part() - 0.5)).normalize_or(Vec3::X);
        jump(&mut app, leap, direction * way);
        let speed = 0.5 + 70.0 * random.part();
        for _ in 0..GATHERED {
            jump(&mut app, trot, direction * speed * TICK);
            tick(&mut app, 1);
        }
        let line = only_line(&names[0]);
        assert!(line.contains(&format!(": {way:.1} m in a tick")), "{line}");
        let lines = lines_with(&names[1]);
        assert!(
            !lines.iter().any(|line| line.contains("dragged")),
            "{lines:?}"
        );
    }
}

/// A free sheet of that name that touches cloth, at a place.
fn sheet(app: &mut App, name: &str, place: Transform) -> Entity {
    let layers = ClothSelfCollision::of_thickness(0.01);
    let sheet = Cloth::new(12, 10, 0.05).lying().centred();
    let name = Name::new(name.to_string());
    let spawned = (sheet, Pins::none(), layers, place, name);
    app.world_mut().spawn(spawned).id()
}

/// In the first tick, and never again.
#[test]
fn cloths_that_begin_inside_each_other_are_logged() {
    listen();
    let turned = Transform::from_xyz(0.02, 0.003, 0.03).with_rotation(Quat::from_rotation_y(0.7));
    for (case, place) in [Transform::default(), turned].into_iter().enumerate() {
        let mut app = app();
        let [lower, upper] = ["lower", "upper"].map(|name| format!("{name} duvet {case}"));
        sheet(&mut app, &lower, Transform::default());
        sheet(&mut app, &upper, place);
        tick(&mut app, 1);
        let text = format!("er duvet {case}\" begins inside cloth ");
        let line = only_line(&text);
        assert!(
            line.contains(" % of its particles are nearer than 5.0 mm: spawn them "),
            "{line}"
        );
        for name in [lower, upper] {
            assert!(line.contains(&format!("cloth \"{name}\"")), "{line}");
        }
        tick(&mut app, 20);
        assert_eq!(only_line(&text), line);
    }
    let mut app = app();
    for index in 0..4 {
        sheet(&mut app, &format!("pile {index}"), Transform::default());
    }
    tick(&mut app, 4);
    let line = only_line("\"pile ");
    assert!(line.contains(" (and 2 more likewise): "), "{line}");
}

#[test]
fn cloths_that_begin_beside_each_other_are_not_logged() {
    listen();
    let mut app = app();
    // A thickness apart.
    sheet(&mut app, "fleece", Transform::default());
    sheet(&mut app, "fleece", Transform::from_xyz(0.02, 0.01, 0.01));
    // Thinner ones, a little more than their thickness apart.
    for height in [0.0, 0.0035] {
        let thin = sheet(&mut app, "fleece", Transform::from_xyz(20.0, height, 0.0));
        let thickness = ClothFactor::of(0.3);
        app.world_mut().entity_mut(thin).insert(ClothMaterialMap {
            thickness,
            ..default()
        });
    }
    // They share a seam.
    for place in [0.0, 0.45] {
        sheet(&mut app, "fleece", Transform::from_xyz(4.0, 0.0, place));
    }
    // They do not meet.
    for _ in 0..2 {
        let sheet = sheet(&mut app, "fleece", Transform::from_xyz(8.0, 0.0, 0.0));
        app.world_mut().entity_mut(sheet).insert(ClothLayers::NONE);
    }
    // The game puts them into each other later.
    let [still, put] = [12.0, 16.0].map(|x| {
        let place = Transform::from_xyz(x, 0.0, 0.0);
        sheet(&mut app, "fleece", place)
    });
    tick(&mut app, 4);
    let there = *app.world().get::<Transform>(still).expect("a place");
    app.world_mut()
        .entity_mut(put)
        .insert((there, ClothTeleport));
    tick(&mut app, 4);
    assert_eq!(lines_with("\"fleece\" begins"), Vec::<String>::new());
}

/// Any two in one place, however they are turned.
#[test]
fn random_cloths_in_one_place_are_logged() {
    listen();
    let mut random = Random(11);
    for case in 0..12 {
        let mut app = app();
        let place = Transform::from_translation(Vec3::from([0; 3].map(|_| random.part())))
            .with_rotation(Quat::from_rotation_z(3.0 * random.part()));
        sheet(&mut app, &format!("quilt {case:02}"), place);
        let [along, across] = [0; 2].map(|_| 0.1 * random.part());
        let other = Transform::from_xyz(along, 0.004 * random.part(), across)
            .with_rotation(Quat::from_rotation_y(6.0 * random.part()));
        sheet(&mut app, &format!("other quilt {case:02}"), place * other);
        tick(&mut app, 2);
        only_line(&format!("quilt {case:02}\": "));
    }
}

/// Half of what each collider of [`pull_out_between`] measures towards the other (m).
const HALF_JAW: f32 = 0.25;

fn cuboids() -> [ClothCollider; 2] {
    [0; 2].map(|_| ClothCollider::cuboid(1.4, 0.4, 2.0 * HALF_JAW))
}

fn balls() -> [ClothCollider; 2] {
    [0; 2].map(|_| ClothCollider::ball(HALF_JAW))
}

/// A sheet that hangs between two colliders, which close on it to a gap (m) and stay as its pins are pulled up.
fn pull_out_between(
    app: &mut App,
    name: &str,
    place: Transform,
    (colliders, gap): ([ClothCollider; 2], f32),
) {
    app.insert_resource(ClothGravity(place.rotation * Vec3::NEG_Y * GRAVITY));
    let name = Name::new(name.to_string());
    let cloth = (Cloth::new(12, 12, 0.08).centred(), name, place);
    let cloth = app.world_mut().spawn(cloth).id();
    let [left, right] = colliders;
    let jaws = [(left, "left jaw"), (right, "right jaw")];
    let jaws = jaws.map(|(jaw, name)| app.world_mut().spawn((jaw, Name::new(name))).id());
    for passed in 0_u8..90 {
        let open = gap + 0.5 * (1.0 - f32::from(passed.min(31)) / 31.0);
        for (jaw, side) in jaws.into_iter().zip([-1.0, 1.0]) {
            let z = side * (HALF_JAW + open / 2.0);
            let there = place * Transform::from_xyz(0.0, 0.0, z);
            app.world_mut().entity_mut(jaw).insert(there);
        }
        if passed > 40 {
            jump(app, cloth, place.rotation * Vec3::Y * 1.5 * TICK);
        }
        tick(app, 1);
    }
}

/// The sub-steps are not the cause, and are not named.
#[test]
fn a_cloth_that_is_caught_between_colliders_says_so() {
    listen();
    for (name, colliders, gap) in [("boxes", cuboids(), 0.002), ("balls", balls(), -0.1)] {
        let mut app = app();
        let name = format!("caught between {name}");
        pull_out_between(&mut app, &name, Transform::default(), (colliders, gap));
        let line = only_line(&format!("cloth \"{name}\" is "));
        assert!(
            line.contains(" is overstretched: ")
                && line.contains(": caught between cloth collider \"")
                && line.contains("left jaw\"")
                && line.contains("right jaw\"")
                && line.contains(": move them apart, ")
                && !line.contains("sub-steps"),
            "{line}"
        );
    }
}

/// Wherever they are and however they are turned.
#[test]
fn random_cloths_that_are_caught_between_colliders_say_so() {
    listen();
    let mut random = Random(5);
    let mut logged = 0;
    for case in 0..4 {
        let mut app = app();
        let name = format!("caught at random {case}");
        let mut part = || random.part();
        let place = Transform::from_xyz(part(), part(), part()).with_rotation(Quat::from_euler(
            EulerRot::XYZ,
            part(),
            part(),
            part(),
        ));
        let gap = -0.02 - 0.08 * part();
        pull_out_between(&mut app, &name, place, (cuboids(), gap));
        let lines = lines_with(&format!("cloth \"{name}\" is "));
        let are_caught = lines.iter().all(|line| line.contains(": caught between "));
        assert!(are_caught, "{lines:?}");
        logged += lines.len();
    }
    // Some slip out before they are stretched for long.
    assert!((2..=4).contains(&logged), "{logged}");
}

/// The sub-steps do not hold a cloth that lies in the corner of a room: nothing catches it.
#[test]
fn a_cloth_that_touches_two_colliders_is_not_caught() {
    listen();
    let mut app = app();
    let settings = ClothSettings {
        tethers: false,
        sleeps: false,
        ..ClothSettings::substeps(3)
    };
    let pins = Pins::new([Pin::Corner(Corner::TopLeft)]);
    let name = Name::new("in a corner");
    let cloth = (
        Cloth::new(32, 32, 0.05),
        pins,
        settings,
        solved_once(),
        name,
    );
    let cloth = app.world_mut().spawn(cloth).id();
    let floor = Transform::from_xyz(0.0, -1.6, 0.0);
    let wall = Transform::from_xyz(0.0, 0.0, -0.005)
        .with_rotation(Quat::from_rotation_x(std::f32::consts::FRAC_PI_2));
    for place in [floor, wall] {
        app.world_mut().spawn((ClothCollider::plane(), place));
    }
    let mut touched = 0;
    for _ in 0..128 {
        tick(&mut app, 1);
        let contacts = app.world().get::<ClothContacts>(cloth).expect("contacts");
        touched = touched.max(contacts.iter().len());
    }
    assert_eq!(touched, 2);
    let line = only_line("in a corner");
    assert!(line.contains(" % (limit 17.8 %): more sub-steps"), "{line}");
}
