//! Clicks that change each setting.

use std::fmt::Debug;

use bevy::{
    prelude::*,
    reflect::{Typed, structs::Struct},
};

use super::{TALL, click_beside, cloths, press, row, texts_in};
use crate::{
    cloth::{Cloth, ClothMaterial},
    contact::NarrowPhase,
    hierarchy::SearchMethod,
    solver::ClothSettings,
};

/// Two thirds along the sliders, from where their names begin.
const SLIDER: Option<f32> = Some(row::NAME + 0.75 * row::SLIDER);

/// Clicks that change one field each of a component, and no other. There is one for each field.
fn each_field_changes<C: Component + Struct + Typed + Clone>(clicks: &[(&str, &str, Option<f32>)]) {
    let fields = C::type_info().as_struct().expect("a struct").field_names();
    let mut named: Vec<&str> = clicks.iter().map(|(field, ..)| *field).collect();
    named.sort_unstable();
    named.dedup();
    let mut all = fields.to_vec();
    all.sort_unstable();
    assert_eq!(named, all, "clicks for each field");
    for (changed, text, beside) in clicks {
        let (mut app, context) = cloths(1);
        let mut cloths = app.world_mut().query_filtered::<Entity, With<Cloth>>();
        let cloth = cloths.single(app.world()).expect("one");
        click_beside(&mut app, &context, "debugging", None, TALL);
        let before = app.world().get::<C>(cloth).expect("it has one").clone();
        click_beside(&mut app, &context, text, *beside, TALL);
        let after = app.world().get::<C>(cloth).expect("it has one");
        for field in fields {
            let [was, is] = [&before, after].map(|of| of.field(field).expect("it exists"));
            let is_same = was.reflect_partial_eq(is) == Some(true);
            assert_eq!(
                is_same,
                field != changed,
                "a click at “{text}”: {field} is {is:?}"
            );
        }
    }
}

#[test]
fn each_setting_can_be_changed() {
    each_field_changes::<ClothSettings>(&[
        ("substepping", "fixed", None),
        ("substepping", "tolerance", None),
        ("gravity", "own gravity", None),
        ("particle_radius", "radius, mm", SLIDER),
        ("tethers", "tethers", None),
        ("order", "Verlet as in the paper", None),
        ("sleeps", "sleeps at rest", None),
    ]);
    each_field_changes::<ClothMaterial>(&[
        ("areal_density", "mass, kg/m²", SLIDER),
        ("stretch_compliance", "stretch, m/N", SLIDER),
        ("shear_compliance", "shear, m/N", SLIDER),
        ("bend_rigidity", "bend, N·m", SLIDER),
        ("weft", "has a weft", None),
        ("stiffening", "stiffens", None),
        ("stretch_damping", "loss, s", SLIDER),
        ("damping", "damping D", SLIDER),
        ("friction", "friction μ", SLIDER),
    ]);
}

#[test]
fn each_search_and_contact_can_be_chosen() {
    let methods = SearchMethod::ALL;
    for (method, other) in methods.into_iter().zip(methods.into_iter().cycle().skip(1)) {
        choose_and_see("search", &method.to_string(), method, other);
    }
    let phases = NarrowPhase::ALL;
    for ((name, phase), (_, other)) in phases.into_iter().zip(phases.into_iter().cycle().skip(1)) {
        choose_and_see("contact by", name, phase, other);
    }
}

/// Chooses an entry of a menu, of a cloth that has another.
fn choose_and_see<C: Component + PartialEq + Debug>(
    menu: &str,
    entry: &str,
    expected: C,
    other: C,
) {
    let (mut app, context) = cloths(1);
    let mut cloth = app.world_mut().query_filtered::<Entity, With<Cloth>>();
    let cloth = cloth.single(app.world()).expect("one");
    app.world_mut().entity_mut(cloth).insert(other);
    click_beside(&mut app, &context, "debugging", None, TALL);
    click_beside(&mut app, &context, menu, SLIDER, TALL);
    let seen = texts_in(&mut app, &context, TALL);
    // The entry comes after the row that may show the same.
    let place = seen.iter().rfind(|(text, _)| text == entry);
    let place = place
        .unwrap_or_else(|| panic!("{entry} is not to be seen: {seen:?}"))
        .1;
    press(&mut app, &context, place.center(), TALL);
    let mut all = app.world_mut().query_filtered::<&C, With<Cloth>>();
    assert_eq!(
        all.single(app.world()).expect("one"),
        &expected,
        "{entry} of {menu}"
    );
}
