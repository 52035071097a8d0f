//! What of a mesh is pinned, and what it is attached to.

use bevy::{
    mesh::{MeshVertexAttribute, VertexFormat},
    prelude::*,
};
use bevy_drape::prelude::*;

use super::sheets::*;
use crate::support::*;

/// How stiff an artist has painted it.
const STIFFNESS: MeshVertexAttribute =
    MeshVertexAttribute::new("Stiffness", 917_431_254, VertexFormat::Float32);

/// A sheet of 5 × 5 whose last row has its own vertices twice: where they are first, a triangle's order makes other
/// particles of them. Colour and attribute are on vertices 10 and 29, which is 24 again.
fn painted() -> Mesh {
    let (mut positions, mut triangles) = sheet(5, 5);
    positions.extend_from_within(20..25);
    // The last row of cells has corners of its own; and the last triangle comes first.
    for corners in &mut triangles[24..] {
        *corners = corners.map(|corner| if corner >= 20 { corner + 5 } else { corner });
    }
    triangles.reverse();
    let red = |vertex: usize| if [10, 29].contains(&vertex) { 0.9 } else { 0.2 };
    let colors: Vec<_> = (0..30).map(|vertex| [0.1, red(vertex), 0.0, 1.0]).collect();
    let stiffness: Vec<_> = (0..30).map(red).collect();
    asset(&positions, &triangles)
        .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colors)
        .with_inserted_attribute(STIFFNESS, stiffness)
}

/// The vertices that stay where they are when all else falls, and what is wrong.
fn held(pins: Pins, place: Transform) -> (Vec<usize>, Option<ClothError>) {
    let mut app = app_that_draws(FixedUpdate);
    let handle = add(&mut app, painted());
    let cloth = spawn(&mut app, &handle, (pins, place));
    tick(&mut app, 20);
    if let Some(fault) = fault(&app, cloth) {
        assert!(particles(&app, cloth).is_empty());
        return (Vec::new(), Some(fault));
    }
    let surface = surface(&app, cloth);
    let stays = |vertex: &usize| {
        let particle = surface.particle_of_vertex(*vertex).expect("a particle");
        let stays =
            particles(&app, cloth).position(particle) == Some(surface.rest_positions()[particle]);
        assert_eq!(
            particles(&app, cloth).is_pinned(particle),
            Some(stays),
            "{vertex}"
        );
        stays
    };
    ((0..30).filter(stays).collect(), None)
}

#[test]
fn each_way_of_naming_pins_a_mesh() {
    let near = |point, radius| Pin::Near { point, radius };
    for (pin, vertices) in [
        (Pin::Vertex(0), vec![0]),
        (Pin::Vertex(7), vec![7]),
        // Either of two in one place.
        (Pin::Vertex(22), vec![22, 27]),
        (Pin::Vertex(27), vec![22, 27]),
        (near(Vec3::new(0.2, 0.0, 0.2), 0.05), vec![12]),
        (near(Vec3::new(0.2, 0.0, 0.2), 0.1), vec![7, 11, 12, 13, 17]),
        (
            Pin::at_rest(|place| place.x > 0.35 && place.z < 0.15),
            vec![4, 9],
        ),
        (Pin::at_rest(|_| false), vec![]),
        // The larger of what is in one place counts.
        (Pin::color(1, 0.5), vec![10, 24, 29]),
        (Pin::color(3, 0.5), (0..30).collect()),
        (Pin::attribute("Stiffness", 0, 0.5), vec![10, 24, 29]),
        // A mesh has no top.
        (Pin::Top, vec![]),
    ] {
        let found = held(Pins::new([pin.clone()]), Transform::IDENTITY);
        assert_eq!(found, (vertices, None), "{pin:?}");
    }
    let both = Pins::new([Pin::Vertex(3), Pin::color(1, 0.5)]);
    assert_eq!(held(both, Transform::IDENTITY).0, [3, 10, 24, 29]);
    assert!(held(Pins::default(), Transform::IDENTITY).0.is_empty());
}

/// Places are those of the asset, whatever the transform makes of them.
#[test]
fn places_are_before_the_scale() {
    let place = Transform::from_xyz(10.0, -3.0, 2.0)
        .with_rotation(Quat::from_rotation_y(1.0))
        .with_scale(Vec3::new(3.0, 2.0, -0.5));
    let point = Vec3::new(0.2, 0.0, 0.2);
    let near = Pins::new([Pin::Near { point, radius: 0.1 }]);
    assert_eq!(held(near, place), (vec![7, 11, 12, 13, 17], None));
    let corner = Pins::new([Pin::at_rest(|place| place.x > 0.35 && place.z < 0.15)]);
    assert_eq!(held(corner, place), (vec![4, 9], None));
}

#[test]
fn a_pin_that_is_wrong_is_named() {
    let fault = |pin: Pin| held(Pins::new([pin]), Transform::IDENTITY).1;
    for pin in [
        Pin::Row(0),
        Pin::Column(0),
        Pin::Cell(0, 0),
        Pin::Corner(Corner::TopLeft),
        Pin::filter(|_, _| true),
    ] {
        let named = format!("{pin:?}");
        assert_eq!(
            fault(pin),
            Some(ClothError::Pin(PinError::NeedsGrid { pin: named }))
        );
    }
    let cloth = "25 particles of 30 vertices".to_string();
    for pin in [Pin::Vertex(30), Pin::Index(25)] {
        let expected = ClothError::Pin(PinError::OutOfRange {
            pin: format!("{pin:?}"),
            cloth: cloth.clone(),
        });
        assert_eq!(fault(pin), Some(expected));
    }
    for pin in [Pin::attribute("Weight", 0, 0.5), Pin::color(4, 0.5)] {
        let Some(ClothError::Pin(PinError::NoSuchAttribute {
            pin: named,
            attributes,
        })) = fault(pin.clone())
        else {
            panic!("{pin:?}");
        };
        assert_eq!(named, format!("{pin:?}"));
        assert!(
            attributes.contains("Stiffness") && attributes.contains("Vertex_Color"),
            "{attributes}"
        );
    }
    let nowhere = Pin::Near {
        point: Vec3::splat(5.0),
        radius: 0.5,
    };
    for pin in [
        nowhere,
        Pin::color(1, 0.95),
        Pin::attribute("Stiffness", 1, 0.0),
    ] {
        let named = format!("{pin:?}");
        assert_eq!(
            fault(pin),
            Some(ClothError::Pin(PinError::FindsNothing { pin: named }))
        );
    }
}

/// A vertex that is no particle can't be pinned, and mending the pin is enough.
#[test]
fn a_vertex_of_no_triangle_is_out_of_range() {
    let mut app = app();
    let (mut positions, triangles) = sheet(3, 3);
    positions.push(Vec3::splat(4.0));
    let cloth = (
        Cloth::triangles(positions, triangles),
        Pins::new([Pin::Vertex(9)]),
    );
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 2);
    let fault = fault(&app, cloth);
    assert!(
        matches!(fault, Some(ClothError::Pin(PinError::OutOfRange { .. }))),
        "{fault:?}"
    );
    change::<Pins>(&mut app, cloth, |pins| *pins = Pins::new([Pin::Vertex(8)]));
    tick(&mut app, 20);
    assert_eq!(super::sheets::fault(&app, cloth), None);
    assert_eq!(by_vertex(&app, cloth)[8], Some(Vec3::new(0.2, 0.0, 0.2)));
}

/// Where a cloth's vertex is in the world.
fn in_world(app: &App, cloth: Entity, vertex: usize) -> Vec3 {
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    frame.to_world(by_vertex(app, cloth)[vertex].expect("a particle"))
}

/// A target by its name may come later, in another tick than its name, be renamed and replaced: the cloth waits, and
/// follows.
#[test]
fn a_target_is_known_by_its_name() {
    let mut app = app_that_draws(FixedUpdate);
    let handle = add(&mut app, painted());
    let pin = Pin::color(1, 0.5);
    let attached = ClothAttachments::new([(pin.clone(), "shoulders")]);
    let cloth = spawn(&mut app, &handle, attached);
    tick(&mut app, 3);
    let missing = Some(ClothError::Target(TargetError::NoTargetNamed {
        pin: format!("{pin:?}"),
        name: "shoulders".into(),
    }));
    assert_eq!(fault(&app, cloth), missing);
    // One that is nowhere is none.
    let target = app.world_mut().spawn(Name::new("shoulders")).id();
    tick(&mut app, 2);
    assert_eq!(fault(&app, cloth), missing);
    let start = Transform::from_xyz(1.0, 1.0, 0.0);
    app.world_mut().entity_mut(target).insert(start);
    tick(&mut app, 20);
    assert_eq!(fault(&app, cloth), None);
    let [held, free] = [10, 4].map(|vertex| in_world(&app, cloth, vertex));
    assert_eq!(held, Vec3::new(0.0, 0.0, 0.2));
    assert!(free.y < -0.02, "{free}");
    change::<Transform>(&mut app, target, |place| place.translation.y += 0.05);
    tick(&mut app, 1);
    assert!(in_world(&app, cloth, 10).distance(held + Vec3::Y * 0.05) < 1.0e-6);

    // Another of that name does not take it away.
    let other = (Name::new("shoulders"), Transform::from_xyz(9.0, 9.0, 9.0));
    let other = app.world_mut().spawn(other).id();
    tick(&mut app, 2);
    assert!(in_world(&app, cloth, 10).distance(held + Vec3::Y * 0.05) < 1.0e-6);

    // Renamed both, there is none; and it is found again.
    for entity in [target, other] {
        app.world_mut().entity_mut(entity).insert(Name::new("feet"));
    }
    tick(&mut app, 2);
    assert_eq!(fault(&app, cloth), missing);
    app.world_mut()
        .entity_mut(target)
        .insert(Name::new("shoulders"));
    tick(&mut app, 2);
    assert_eq!(fault(&app, cloth), None);
    change::<Transform>(&mut app, target, |place| place.translation.y += 0.05);
    tick(&mut app, 1);
    let place = in_world(&app, cloth, 10);
    assert!(place.distance(held + Vec3::Y * 0.1) < 1.0e-6, "{place}");
}
