//! Ropes along paths and along the edges of meshes.

use super::*;

/// Along a path with a sharp turn, it hangs between its ends as a chain does: the path is forgotten.
#[test]
fn one_along_a_path_hangs_as_a_chain_does() {
    let points = [Vec3::ZERO, Vec3::new(0.6, 0.8, 0.0), Vec3::X * 1.2];
    let rope = Cloth::rope_along(points, 0.03, 0.01);
    let between = Pins::new([Pin::at_rest(|place| place.y < 1.0e-3)]);
    let mut app = app();
    let rope = spawn(&mut app, (rope, between, damped()));
    let begin = places(&app, rope);
    assert_eq!(begin.len(), 68);
    assert!(begin.iter().any(|place| place.y > 0.75), "{begin:?}");
    tick(&mut app, 1500);
    let all = places(&app, rope);
    let sag = all.iter().map(|place| -place.y).fold(0.0, f32::max);
    let [radius, truth] = catenary(2.0, 1.2);
    // As in the test above, and the corner may cut off half of a spacing.
    let spacing = 2.0 / 67.0_f32;
    let lowest = (spacing * spacing / (8.0 * radius)).min(2.0e-3 * truth);
    let tolerance = truth * (1.0 / 67.0_f32).powi(2) + lowest;
    assert!((sag - truth).abs() < tolerance, "{sag} m, {truth} m");
    assert!((length(&all) - 2.0).abs() < 2.0e-3);
}

/// An upright path falls over. One with another path is built anew, even of the same length; one with another spacing keeps its place.
#[test]
fn one_along_a_path_falls_over_and_changes() {
    let upright = [Vec3::ZERO, Vec3::Y];
    let mut app = app();
    let rope = spawn(&mut app, (Cloth::rope_along(upright, 0.05, 0.01), damped()));
    let end = |app: &App| *places(app, rope).last().expect("an end");
    // Its last part is folded up for long.
    tick(&mut app, 2100);
    let hung = end(&app);
    assert!(hung.distance(Vec3::NEG_Y) < 0.01, "{hung}");
    let change_to = |app: &mut App, path: [Vec3; 2], spacing| {
        let other = Cloth::rope_along(path, spacing, 0.01);
        app.world_mut().entity_mut(rope).insert(other);
        tick(app, 1);
    };
    change_to(&mut app, upright, 0.025);
    assert_eq!(places(&app, rope).len(), 41);
    assert!(end(&app).distance(hung) < 1.0e-3);
    change_to(&mut app, [Vec3::ZERO, Vec3::Z], 0.025);
    assert!(end(&app).distance(Vec3::Z) < 0.01);
    // Mirrored, it is as long as before.
    change::<Transform>(&mut app, rope, |place| place.scale.z = -1.0);
    tick(&mut app, 30);
    let other = Cloth::rope_along([Vec3::ZERO, Vec3::Z], 0.05, 0.01);
    app.world_mut().entity_mut(rope).insert(other);
    tick(&mut app, 1);
    assert!(end(&app).distance(-Vec3::Z) < 0.01);
}

/// A path that doubles back, so that neighbours begin in one place: it unfolds and hangs down. A flat one stands on its fold, like a pole.
#[test]
fn one_that_doubles_back_unfolds() {
    let path = [Vec3::ZERO, Vec3::NEG_Y, Vec3::ZERO];
    for (parts, is_flat) in [(15.0, false), (15.0, true), (16.0, false)] {
        let mut app = app();
        let rope = Cloth::rope_along(path, 2.0 / parts, 0.01);
        let rope = if is_flat { rope.flat() } else { rope };
        let rope = spawn(&mut app, (rope, damped()));
        let mut longest = 0.0_f32;
        for _ in 0..1200 {
            tick(&mut app, 1);
            longest = longest.max(length(&places(&app, rope)) / 2.0 - 1.0);
        }
        assert_eq!(app.world().get::<ClothFault>(rope), None);
        assert!(longest < 0.1, "{longest}");
        let end = *places(&app, rope).last().expect("an end");
        let hangs = end.distance(2.0 * Vec3::NEG_Y) < 0.01;
        assert!(hangs || is_flat, "{parts}: {end}");
    }
}

/// The edges of a mesh without faces, in any order and direction. It begins at the end with the lower index.
#[test]
fn edges_of_a_mesh_are_a_rope() {
    let place = |vertex: usize| Vec3::new(0.1 * vertex as f32, (vertex % 2) as f32, 0.0);
    // Where each vertex of the mesh is along the chain.
    let order = [4, 0, 6, 2, 5, 1, 3];
    let mesh = |topology, indices: &[u32]| {
        let places: Vec<Vec3> = order.map(place).to_vec();
        Mesh::new(topology, default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, places)
            .with_inserted_indices(Indices::U32(indices.to_vec()))
    };
    let vertex = |at: usize| {
        order
            .iter()
            .position(|of| *of == at)
            .expect("each is there") as u32
    };
    let chain: Vec<u32> = (0..7).map(vertex).collect();
    let list: Vec<u32> = [2, 5, 0, 3, 1, 4]
        .into_iter()
        .flat_map(|at| [chain[at + at % 2], chain[at + 1 - at % 2]])
        .collect();
    let reversed: Vec<u32> = chain.iter().rev().copied().collect();
    let points = |mesh: &Mesh| match Cloth::rope_of(mesh, 0.1, 0.01).map(|rope| rope.shape) {
        Ok(ClothShape::RopePath(path)) => Ok(path.points),
        Ok(other) => panic!("{other:?}"),
        Err(error) => Err(error),
    };
    let expected: Vec<Vec3> = (0..7).map(place).collect();
    for mesh in [
        mesh(PrimitiveTopology::LineList, &list),
        mesh(PrimitiveTopology::LineStrip, &chain),
        mesh(PrimitiveTopology::LineStrip, &reversed),
    ] {
        assert_eq!(points(&mesh).expect("a chain"), expected);
    }
    let refused = |indices: &[u32]| points(&mesh(PrimitiveTopology::LineList, indices));
    let no_chain = |vertex, edges| Err(RopeError::NotAChain { vertex, edges });
    // A branch, a ring, a chain beside a ring, a vertex without edges, one that does not exist, and no edges.
    assert_eq!(
        refused(&[0, 1, 1, 2, 1, 3, 3, 4, 4, 5, 5, 6]),
        no_chain(1, 3)
    );
    assert_eq!(
        refused(&[0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 0]),
        no_chain(0, 2)
    );
    assert_eq!(
        refused(&[0, 1, 1, 2, 3, 4, 4, 5, 5, 6, 6, 3]),
        no_chain(3, 2)
    );
    assert_eq!(refused(&[0, 1, 1, 2, 2, 3, 3, 4, 4, 5]), no_chain(6, 0));
    assert_eq!(
        refused(&[0, 1, 1, 0, 2, 3, 3, 4, 4, 5, 5, 6]),
        no_chain(0, 2)
    );
    assert_eq!(
        refused(&[0, 0, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6]),
        no_chain(0, 2)
    );
    let none_such = RopeError::NoSuchVertex {
        vertex: 9,
        vertices: 7,
    };
    assert_eq!(refused(&[0, 1, 1, 9]), Err(none_such));
    assert_eq!(refused(&[]), no_chain(0, 0));
    assert_eq!(refused(&[0, 1, 1]), Err(RopeError::Unpaired { indices: 3 }));
    let faces = points(&mesh(PrimitiveTopology::TriangleList, &[0, 1, 2]));
    assert!(matches!(faces, Err(RopeError::Topology { .. })));
    let empty = Mesh::new(PrimitiveTopology::LineList, default());
    assert_eq!(
        points(&empty),
        Err(RopeError::Mesh(MeshError::WithoutPositions))
    );
    let none: Vec<Vec3> = Vec::new();
    let none = empty.with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, none);
    assert_eq!(points(&none), Ok(Vec::new()));
}
