//! Copies of a garment: which cloths a seam finds.

use super::*;

/// A part of a garment as an artist paints it: an irregular mesh, whose upper or lower border is painted in one channel of its
/// vertex colour.
fn painted(app: &mut App, [width, height, spacing]: [f32; 3], channel: usize) -> Handle<Mesh> {
    let mesh = irregular(width, height, spacing, 0.2);
    let color = |place: &Vec3| {
        let is_painted = match channel {
            0 => is_top(*place),
            _ => is_bottom(*place, height),
        };
        let mut color = [0.0, 0.0, 0.0, 1.0];
        color[channel] = if is_painted { 1.0 } else { 0.0 };
        color
    };
    let colors: Vec<[f32; 4]> = mesh.positions.iter().map(color).collect();
    let mesh = asset(&mesh.positions, &mesh.triangles);
    add(
        app,
        mesh.with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colors),
    )
}

/// Height of a painted bodice (m).
const BODICE: f32 = 0.4;

/// Meshes of a bodice and of a sleeve.
fn painted_parts(app: &mut App) -> [Handle<Mesh>; 2] {
    let bodice = painted(app, [0.6, BODICE, 0.05], 1);
    [bodice, painted(app, [0.6, 0.3, 0.04], 0)]
}

/// A bodice that hangs from its upper border, a sleeve 5 cm below, and the seam that sews them by their names, all on entities
/// that exist, below the first of them.
fn lay_out(app: &mut App, parts: &[Handle<Mesh>; 2], entities: [Entity; 4], place: Vec3) {
    let [root, bodice, sleeve, seam] = entities;
    let root_parts = (Transform::from_translation(place), Visibility::default());
    app.world_mut().entity_mut(root).insert(root_parts);
    let below = Transform::from_xyz(0.0, -BODICE - 0.05, 0.0);
    let held = Pins::new([Pin::at_rest(is_top)]);
    let [first, second] = parts.clone().map(|mesh| (Cloth::mesh(), Mesh3d(mesh)));
    let bodice_parts = (Name::new("bodice"), first, held, Transform::default());
    let sleeve_parts = (Name::new("sleeve"), second, Pins::none(), below);
    let sides = ClothSeam::new(
        ("sleeve", Pin::color(0, 0.5)),
        ("bodice", Pin::color(1, 0.5)),
    );
    let world = app.world_mut();
    (world.entity_mut(bodice)).insert((bodice_parts, ChildOf(root)));
    (world.entity_mut(sleeve)).insert((sleeve_parts, ChildOf(root)));
    (world.entity_mut(seam)).insert((sides.closing_in(0.2), ChildOf(root)));
}

/// The gap between a bodice and a sleeve (m).
fn gap_of([_, bodice, sleeve, _]: [Entity; 4], app: &App) -> f32 {
    let hem = line(app, bodice, |rest| is_bottom(rest, BODICE), Vec3::X);
    apart(&line(app, sleeve, is_top, Vec3::X), &hem)
}

fn new_entities(app: &mut App) -> [Entity; 4] {
    [(); 4].map(|()| app.world_mut().spawn_empty().id())
}

/// Painted parts find each other by their names. Copies of the garment come later, some on entities of lower numbers: each seam
/// sews the parts beside it, and the first one never lets go of its own.
#[test]
fn copies_of_a_garment_are_sewn_each_by_itself() {
    let mut app = app_that_draws(FixedUpdate);
    let parts = painted_parts(&mut app);
    let low = new_entities(&mut app);
    let [first, high] = [(); 2].map(|()| new_entities(&mut app));
    lay_out(&mut app, &parts, first, Vec3::ZERO);
    tick(&mut app, 128);
    // A mesh's vertices are matched by length, which rounds at each of them.
    let most = 1.0e-3;
    assert!(gap_of(first, &app) < most, "{}", gap_of(first, &app));
    lay_out(&mut app, &parts, low, Vec3::X);
    lay_out(&mut app, &parts, high, 2.0 * Vec3::X);
    for _ in 0..128 {
        tick(&mut app, 1);
        assert!(gap_of(first, &app) < most, "{}", gap_of(first, &app));
    }
    for of in [first, low, high] {
        assert!(gap_of(of, &app) < most, "{}", gap_of(of, &app));
        for entity in of {
            assert!(app.world().get::<ClothFault>(entity).is_none());
        }
    }
}

/// Of cloths of one name, a seam takes those with the nearest common ancestor: first of its own arm, then of its own figure.
#[test]
fn a_seam_prefers_the_cloths_beside_it() {
    let mut app = app_that_draws(FixedUpdate);
    let parts = painted_parts(&mut app);
    let arms: Vec<[Entity; 4]> = (0..4).map(|_| new_entities(&mut app)).collect();
    // Two figures 3 m apart, each with two arms 5 cm apart.
    for (of, pair) in arms.chunks(2).enumerate() {
        let place = Transform::from_xyz(3.0 * of as f32, 0.0, 0.0);
        let figure = (place, Visibility::default());
        let figure = app.world_mut().spawn(figure).id();
        for (index, arm) in pair.iter().enumerate() {
            lay_out(&mut app, &parts, *arm, 0.05 * index as f32 * Vec3::Z);
            app.world_mut().entity_mut(arm[0]).insert(ChildOf(figure));
        }
    }
    tick(&mut app, 128);
    for arm in &arms {
        assert!(gap_of(*arm, &app) < 1.0e-3, "{}", gap_of(*arm, &app));
    }
    // Without a sleeve of its own, an arm takes the other one of its figure, though those of the first figure came earlier.
    let [_, bodice, sleeve, seam] = arms[3];
    app.world_mut().despawn(sleeve);
    tick(&mut app, 64);
    assert!(app.world().get::<ClothFault>(seam).is_none());
    let gap_to = |other: [Entity; 4]| gap_of([other[0], bodice, other[2], seam], &app);
    // Both hems pull at one sleeve: nearer than they were, and not by the sleeve of another figure.
    assert!(gap_to(arms[2]) < 0.01, "{}", gap_to(arms[2]));
    assert!(gap_to(arms[0]) > 2.5, "{}", gap_to(arms[0]));
}

/// A cloth of the same name that comes later, on an entity of a lower number, does not take a seam over. Once the cloth that is
/// sewn has lost the name, it does.
#[test]
fn a_seam_keeps_a_cloth_while_that_has_its_name() {
    let mut app = app();
    let early = app.world_mut().spawn_empty().id();
    let upper = app.world_mut().spawn(Cloth::new(12, 12, 0.05)).id();
    let named = Name::new("lower");
    let below = Transform::from_xyz(0.0, -0.55, 0.0);
    let lower = (Cloth::new(12, 12, 0.05), Pins::none(), below);
    let lower = app.world_mut().spawn((lower, named.clone())).id();
    let seam = ClothSeam::new((upper, Pin::Row(11)), ("lower", Pin::Row(0)));
    let seam = sew(&mut app, seam);
    let gap_to = |app: &App, other: Entity| gap(&row(app, upper, 11), &row(app, other, 0));
    tick(&mut app, 8);
    // Near enough for the hem to come to it.
    let beside = Transform::from_xyz(0.0, -0.5, 0.1);
    let other = (Cloth::new(12, 12, 0.05), beside, named);
    app.world_mut().entity_mut(early).insert(other);
    for _ in 0..32 {
        tick(&mut app, 1);
        assert!(gap_to(&app, lower) < IN_A_SUBSTEP);
    }
    // One that is disabled for a while keeps its place, and the seam waits.
    app.world_mut().entity_mut(lower).insert(Disabled);
    tick(&mut app, 2);
    assert!(app.world().get::<ClothFault>(seam).is_some());
    app.world_mut().entity_mut(lower).remove::<Disabled>();
    tick(&mut app, 64);
    assert!(app.world().get::<ClothFault>(seam).is_none());
    assert!(gap_to(&app, lower) < IN_A_SUBSTEP);
    (app.world_mut().entity_mut(lower)).insert(Name::new("another"));
    tick(&mut app, 64);
    assert!(app.world().get::<ClothFault>(seam).is_none());
    let gap = gap_to(&app, early);
    assert!(gap < IN_A_SUBSTEP, "{gap}");
    // A free fall of a second is 4.9 m, less its damping.
    assert!(gap_to(&app, lower) > 1.0);
}
