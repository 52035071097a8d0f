//! The same triangles in whatever form are the same cloth.

use bevy::{
    asset::RenderAssetUsages,
    mesh::{Indices, PrimitiveTopology},
    platform::collections::HashMap,
    prelude::*,
};
use bevy_drape::prelude::*;

use super::sheets::*;
use crate::support::*;

/// A sheet as one strip, with its rows stitched by triangles without an area, and its vertices numbered as they come.
fn strip(columns: u32, rows: u32) -> (Vec<Vec3>, Vec<u32>) {
    let mut cells = Vec::new();
    for row in 0..rows - 1 {
        if let Some(&last) = cells.last() {
            cells.extend([last, (row, 0)]);
        }
        cells.extend((0..columns).flat_map(|column| [(row, column), (row + 1, column)]));
    }
    let mut numbers = HashMap::new();
    let mut positions = Vec::new();
    let number = |&(row, column): &(u32, u32)| {
        *numbers.entry((row, column)).or_insert_with(|| {
            positions.push(Vec3::new(column as f32, 0.0, row as f32) * 0.1);
            positions.len() as u32 - 1
        })
    };
    let strip = cells.iter().map(number).collect();
    (positions, strip)
}

/// The triangles of a strip that have an area.
fn triangles(strip: &[u32]) -> Vec<[u32; 3]> {
    let windows = strip.array_windows::<3>().enumerate();
    let turned = windows.map(|(at, &[a, b, c])| if at % 2 == 0 { [a, b, c] } else { [b, a, c] });
    turned
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .collect()
}

fn with_normals(mesh: Mesh) -> Mesh {
    let normals = vec![Vec3::Y.to_array(); mesh.count_vertices()];
    mesh.with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
}

/// Where the particles of an asset's vertices are after a second: held by an edge, with a ball below. `expected` says how
/// many particles there are.
fn after_a_second(mesh: Mesh, expected: usize) -> Vec<Option<Vec3>> {
    let mut app = app_that_draws(FixedUpdate);
    let handle = add(&mut app, with_normals(mesh));
    let cloth = spawn(&mut app, &handle, by_its_edge());
    let ball = Transform::from_xyz(0.3, -0.35, 0.2);
    app.world_mut().spawn((ClothCollider::ball(0.2), ball));
    let mut touched = false;
    for _ in 0..64 {
        tick(&mut app, 1);
        touched |= stats(&app, cloth).contacts > 0;
    }
    assert!(touched);
    assert_eq!(fault(&app, cloth), None);
    assert_eq!(particles(&app, cloth).len(), expected);
    by_vertex(&app, cloth)
}

/// Indices of either width, a strip, a list without indices, triangles that run the other way round or some of each.
#[test]
fn every_form_of_a_mesh_is_the_same_cloth() {
    let (positions, strip) = strip(7, 6);
    let triangles = triangles(&strip);
    let indices = triangles.as_flattened();
    let mesh = || asset(&positions, &triangles);
    let count = positions.len();
    let truth = after_a_second(mesh(), count);
    assert!(truth.iter().all(Option::is_some));
    let narrow: Vec<u16> = indices.iter().map(|index| *index as u16).collect();
    let narrow = mesh().with_inserted_indices(Indices::U16(narrow));
    assert_eq!(after_a_second(narrow, count), truth, "indices of 16 bits");

    let mut stripped = Mesh::new(
        PrimitiveTopology::TriangleStrip,
        RenderAssetUsages::default(),
    );
    let places: Vec<_> = positions.iter().map(Vec3::to_array).collect();
    stripped.insert_attribute(Mesh::ATTRIBUTE_POSITION, places);
    stripped.insert_indices(Indices::U32(strip));
    assert_eq!(after_a_second(stripped, count), truth, "a strip");

    let corner = |index: &u32| positions[*index as usize].to_array();
    let corners: Vec<_> = indices.iter().map(corner).collect();
    let listed = Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, corners);
    let listed = after_a_second(listed, count);
    assert_eq!(listed.len(), indices.len());
    for (place, index) in listed.into_iter().zip(indices) {
        assert_eq!(place, truth[*index as usize], "without indices");
    }

    let turned = |turns: fn(usize) -> bool| -> Vec<[u32; 3]> {
        let all = triangles.iter().enumerate();
        all.map(|(at, &[a, b, c])| if turns(at) { [a, c, b] } else { [a, b, c] })
            .collect()
    };
    let reversed = asset(&positions, &turned(|_| true));
    assert_eq!(after_a_second(reversed, count), truth, "reversed");
    let mixed = asset(&positions, &turned(|at| at % 3 != 1));
    assert_eq!(after_a_second(mixed, count), truth, "mixed");
}

/// Triangles without an area, triangles that are there twice, and vertices of no triangle change nothing; such vertices
/// are drawn where they are.
#[test]
fn what_is_nothing_changes_nothing() {
    let (positions, triangles) = sheet(6, 6);
    let truth = after_a_second(asset(&positions, &triangles), 36);
    let mut more = triangles.clone();
    let [a, b, c] = triangles[7];
    // The same triangle in other orders, last: of several the first one counts.
    more.extend([[a, b, c], [b, c, a], [a, c, b]]);
    // A corner twice, and three corners in a row.
    more.insert(3, [0, 0, 1]);
    more.insert(9, [0, 1, 2]);
    assert_eq!(after_a_second(asset(&positions, &more), 36), truth);

    let mut with_others = positions.clone();
    let unused = [Vec3::new(3.0, 4.0, 5.0), Vec3::new(-1.0, 2.0, 0.5)];
    with_others.extend(unused);
    let places = after_a_second(asset(&with_others, &triangles), 36);
    assert_eq!(places[..36], truth);
    assert_eq!(places[36..], [None, None]);
    let mut app = app_that_draws(FixedUpdate);
    let handle = add(&mut app, asset(&with_others, &triangles));
    let cloth = spawn(&mut app, &handle, ());
    tick(&mut app, 30);
    let drawn = crate::mesh::vertices(&app, cloth, Mesh::ATTRIBUTE_POSITION);
    assert_eq!(drawn[36..], unused);
    assert!(drawn[0].y < -0.5);
}

/// In one mesh a piece that is held and one that is not: the one hangs, the other falls, and either is touched.
#[test]
fn two_pieces_are_one_cloth() {
    let mut app = app_that_draws(FixedUpdate);
    let (held, triangles) = sheet(6, 6);
    let free = held.iter().map(|place| *place + Vec3::X * 2.0);
    let others = triangles
        .iter()
        .map(|corners| corners.map(|corner| corner + 36));
    let triangles: Vec<_> = triangles.iter().copied().chain(others).collect();
    let positions: Vec<_> = held.iter().copied().chain(free).collect();
    let handle = add(&mut app, asset(&positions, &triangles));
    let pins = Pins::new([Pin::at_rest(|place| place.z < 0.01 && place.x < 1.0)]);
    let cloth = spawn(&mut app, &handle, pins);
    // One in the way of each.
    let balls = [Vec3::new(0.25, -0.25, 0.3), Vec3::new(2.1, -1.0, 0.25)].map(|place| {
        let ball = (
            ClothCollider::ball(0.15),
            Transform::from_translation(place),
        );
        app.world_mut().spawn(ball).id()
    });
    let mut touched = [false; 2];
    for _ in 0..128 {
        tick(&mut app, 1);
        let contacts = app.world().get::<ClothContacts>(cloth).expect("contacts");
        for (ball, touched) in balls.into_iter().zip(&mut touched) {
            *touched |= contacts.with(ball).is_some();
        }
    }
    assert_eq!(touched, [true, true]);
    let places = by_vertex(&app, cloth);
    let lowest = |range: std::ops::Range<usize>| {
        let heights = places[range]
            .iter()
            .map(|place| place.expect("a particle").y);
        (
            heights.clone().fold(f32::MAX, f32::min),
            heights.fold(f32::MIN, f32::max),
        )
    };
    let (held, free) = (lowest(0..36), lowest(36..72));
    assert!(held.0 > -0.6 && held.1 < 0.05, "it hangs: {held:?}");
    assert!(free.1 < -0.8, "it has fallen: {free:?}");
    assert_eq!(fault(&app, cloth), None);
}

/// Three sheets that meet in one edge.
#[test]
fn an_edge_may_have_three_faces() {
    let mut app = app_that_draws(FixedUpdate);
    let (sheet, own) = sheet(5, 5);
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for turn in 0..3_u32 {
        let rotation = Quat::from_rotation_x(turn as f32 * 2.1);
        positions.extend(sheet.iter().map(|place| rotation * *place));
        triangles.extend(
            own.iter()
                .map(|corners| corners.map(|corner| corner + 25 * turn)),
        );
    }
    let handle = add(&mut app, asset(&positions, &triangles));
    let pins = Pins::new([Pin::Near {
        point: Vec3::ZERO,
        radius: 0.01,
    }]);
    let cloth = spawn(&mut app, &handle, pins);
    for _ in 0..128 {
        tick(&mut app, 1);
        assert_eq!(particles(&app, cloth).validate(), Ok(()));
    }
    assert_eq!(fault(&app, cloth), None);
    assert_eq!(particles(&app, cloth).len(), 65, "five are of all three");
    let stretch = stats(&app, cloth).stretch.structural;
    assert!(stretch < 0.1, "{stretch}");
    // What hangs by a corner hangs together.
    let places = by_vertex(&app, cloth).into_iter().flatten();
    let farthest = places.map(Vec3::length).fold(0.0, f32::max);
    assert!((0.3..0.7).contains(&farthest), "{farthest}");
}
