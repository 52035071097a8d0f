//! Neighbouring patches that are proved apart cannot touch.

use std::{
    collections::{HashMap, HashSet},
    f32::consts::TAU,
    sync::Arc,
};

use bevy::math::{DVec3, Vec3, Vec3A, Vec3Swizzles};

use super::{
    Sheeted, participants,
    search::{Brute, Feature, ROUNDING, distance, named, near_features, places, shapes},
    settings,
    thrown::Draw,
    torn::rolled,
};
use crate::{
    cloth::{Cloth, Surface, TriangleMesh},
    contact::layers::{MutualContact, bounds::Bounds, flattened::Scratch, sheet::Sheet},
    hierarchy::QuadTree,
};

/// Distance at which features touch, as a fraction of that at rest.
const OF_REST: f32 = 0.5;

/// Lower bounds of the distance of features without a common particle in a window, and of how far they are from touching at this
/// thickness (m).
fn bounds(sheet: &Sheet, window: usize, places: &[Vec3A], thickness: f32) -> Option<[f32; 2]> {
    let flattened = sheet.windows().flattened(window)?;
    let unfolded = flattened.unfolded(places, &mut Scratch::default());
    let slack = flattened.slack(unfolded, thickness, OF_REST);
    Some([unfolded * flattened.closest, slack])
}

/// The features of each patch, by their particles.
fn features(sheet: &Sheet) -> Vec<Vec<Vec<u32>>> {
    let patches = 0..sheet.patch_count() as u32;
    let of = patches.map(|patch| {
        let particles = sheet.particles_of(patch);
        let named = |of: &[u16]| of.iter().map(|&at| particles[usize::from(at)]).collect();
        let vertices = (0..sheet.owned_of(patch)).map(|vertex| named(&[vertex]));
        let edges = sheet.edges_of(patch).iter().map(|of| named(of));
        let faces = sheet.faces_of(patch).iter().map(|of| named(of));
        vertices.chain(edges).chain(faces).collect()
    });
    of.collect()
}

/// The distance of the boxes around two features (m).
fn gap(places: &[Vec3A], first: &[u32], second: &[u32]) -> f32 {
    let box_of = |of: &[u32]| {
        let add = |bounds: Bounds, at: &u32| bounds.with(places[*at as usize]);
        of.iter().fold(Bounds::EMPTY, add)
    };
    box_of(first).distance_squared(&box_of(second)).sqrt()
}

/// A tube of rings around the y axis with this radius (m), which narrows below.
fn tube(around: u32, down: u32, radius: f32) -> TriangleMesh {
    let place = |index: u32| {
        let (ring, part) = (index / around, index % around);
        let angle = TAU * part as f32 / around as f32;
        let radius = radius * (1.0 - 0.02 * ring as f32);
        Vec3::new(
            radius * angle.cos(),
            -0.08 * ring as f32,
            radius * angle.sin(),
        )
    };
    let cells = (0..down - 1).flat_map(|ring| (0..around).map(move |part| [ring, part]));
    let triangles = cells.flat_map(|[ring, part]| {
        let at = |ring: u32, part: u32| ring * around + part % around;
        let [a, b] = [at(ring, part), at(ring, part + 1)];
        let [c, d] = [at(ring + 1, part), at(ring + 1, part + 1)];
        [[a, b, c], [b, d, c]]
    });
    TriangleMesh {
        positions: (0..around * down).map(place).collect(),
        triangles: triangles.collect(),
        ..TriangleMesh::default()
    }
}

/// A square with a bay: its sides are not convex.
fn bay(side: u32) -> TriangleMesh {
    let spacing = 1.0 / (side - 1) as f32;
    let place = |index: u32| {
        let at = Vec3::new((index % side) as f32, 0.0, (index / side) as f32);
        at * spacing - Vec3::new(0.5, 0.0, 0.5)
    };
    let cells = (0..side - 1).flat_map(|row| (0..side - 1).map(move |column| [row, column]));
    let is_left = |[row, column]: &[u32; 2]| *row < side / 3 || !(2..side - 3).contains(column);
    let triangles = cells.filter(is_left).flat_map(|[row, column]| {
        let a = row * side + column;
        [[a, a + side, a + 1], [a + 1, a + side, a + side + 1]]
    });
    let triangles: Vec<[u32; 3]> = triangles.collect();
    let mut of: Vec<u32> = triangles.iter().flatten().copied().collect();
    of.sort_unstable();
    of.dedup();
    let index = |at: u32| of.binary_search(&at).expect("a corner") as u32;
    TriangleMesh {
        positions: of.iter().map(|&at| place(at)).collect(),
        triangles: triangles.iter().map(|face| face.map(index)).collect(),
        ..TriangleMesh::default()
    }
}

/// Surfaces by name: flat and round, whole and torn, convex and not.
fn surfaces() -> Vec<(&'static str, Arc<Surface>)> {
    let mesh = |of: &TriangleMesh| Surface::of_mesh(of, 0.0, Vec3::ONE).expect("a surface");
    let grid = Sheeted::new(9, 1.0, |at| at).surface;
    let slit: Vec<[u32; 2]> = (36..42).map(|at| [at, at + 1]).collect();
    let torn = grid.torn(&slit).expect("edges");
    vec![
        ("grid", grid),
        (
            "irregular mesh",
            Sheeted::of_kind(9, 1.0, true, |at| at).surface,
        ),
        ("tube", Arc::new(mesh(&tube(16, 9, 0.2)))),
        ("bay", Arc::new(mesh(&bay(12)))),
        ("torn", Arc::new(torn)),
    ]
}

/// Long grids and strips need no search: all patches that share particles are proved apart.
#[test]
fn long_sheets_are_proved_flat() {
    for [columns, rows] in [
        [64, 32],
        [32, 64],
        [64, 8],
        [8, 64],
        [30, 20],
        [24, 32],
        [7, 100],
    ] {
        let cloth = Cloth::new(columns, rows, 0.04).lying();
        let surface = Surface::of_grid(&cloth.grid(Vec3::ONE).expect("a valid grid"));
        let surface = Arc::new(surface);
        let sheet = Sheet::new(&surface, &QuadTree::of_surface(&surface, true));
        let bent = surface.rest_positions().iter();
        let bent = bent.map(|at| Vec3A::from(*at + 0.01 * (7.0 * at.x).sin() * Vec3::Y));
        let places: Vec<Vec3A> = bent.collect();
        for window in 0..sheet.windows().count() {
            let bound = bounds(&sheet, window, &places, 0.005);
            assert!(
                bound.is_some_and(|of| of[0] > 0.01),
                "{columns} × {rows}: {window}"
            );
        }
    }
}

/// All patches that share a particle are neighbours. Windows are laid flat but for those at a border that is not convex, as those of the
/// irregular mesh are not.
#[test]
fn patches_that_share_a_particle_are_neighbours() {
    for (name, surface) in surfaces() {
        let sheet = Sheet::new(&surface, &QuadTree::of_surface(&surface, true));
        for a in 0..sheet.patch_count() as u32 {
            for b in a..sheet.patch_count() as u32 {
                let others = sheet.particles_of(b);
                let are_joined = sheet.particles_of(a).iter().any(|own| others.contains(own));
                let pair = sheet.windows().pair_of([a, b]);
                assert_eq!(are_joined, pair.is_some(), "{name}: {a} and {b}");
                let has_both = |window: &u32| {
                    let (_, patches) = sheet.windows().patches_in(*window as usize);
                    patches.contains(&a) && patches.contains(&b)
                };
                let windows = pair.map(|pair| sheet.windows().with_pair(pair));
                assert!(windows.is_none_or(|of| !of.is_empty() && of.iter().all(has_both)));
            }
        }
        let windows = 0..sheet.windows().count();
        let laid = windows
            .clone()
            .filter(|&of| sheet.windows().flattened(of).is_some());
        let part = laid.count() as f32 / windows.len() as f32;
        let least = match name {
            "grid" => 1.0,
            "torn" => 0.58,
            "tube" => 0.5,
            "bay" => 0.35,
            _ => 0.3,
        };
        assert!(part >= least, "{name}: {part} of the windows are laid flat");
    }
}

/// Bent into anything, no two features of two patches are nearer than the bound says, but for those with a common particle. None is nearer to touching than the slack says. Distances are in f64, by brute force.
#[test]
fn what_is_hardly_bent_keeps_its_features_apart() {
    const DRAWN: u32 = 12;
    let mut draw = Draw(3);
    let mut bounded = HashMap::new();
    for (name, surface) in surfaces() {
        let sheet = Sheet::new(&surface, &QuadTree::of_surface(&surface, true));
        let features = features(&sheet);
        let rest = surface.rest_positions();
        let named_shapes = shapes().into_iter().flat_map(|(_, shape)| {
            let scaled = move |scale: f32| rest.iter().map(move |at| shape(*at * scale) / scale);
            [1.0, 0.4, 0.1].map(|scale| scaled(scale).collect::<Vec<Vec3>>())
        });
        let drawn = (0..DRAWN).map(|of| {
            let bend = 0.5 * of as f32 / DRAWN as f32;
            let [along, phase] = [draw.vector() * 12.0, draw.vector() * TAU];
            let at =
                |at: &Vec3| *at + bend * (along * at.x + phase + along.yzx() * at.z).map(f32::sin);
            rest.iter().map(at).collect()
        });
        let mut at_rest: HashMap<Feature, f64> = HashMap::new();
        for places in named_shapes.chain(drawn.collect::<Vec<_>>()) {
            let thickness = 0.03;
            let aligned: Vec<Vec3A> = places.iter().map(|at| Vec3A::from(*at)).collect();
            let apart = |of: &[Vec3], first: &[u32], second: &[u32]| {
                let at = |all: &[u32]| -> Vec<DVec3> {
                    all.iter().map(|at| of[*at as usize].as_dvec3()).collect()
                };
                distance(&at(first), &at(second))
            };
            for window in 0..sheet.windows().count() {
                let Some([bound, slack]) = bounds(&sheet, window, &aligned, thickness) else {
                    continue;
                };
                if bound <= 0.0 {
                    continue;
                }
                *bounded.entry(name).or_insert(0) += 1;
                let (_, patches) = sheet.windows().patches_in(window);
                let of = patches.iter().flat_map(|&patch| &features[patch as usize]);
                let of: Vec<&Vec<u32>> = of.collect();
                for (at, first) in of.iter().enumerate() {
                    for second in &of[at + 1..] {
                        let are_pair =
                            matches!([first.len(), second.len()], [1, 3] | [3, 1] | [2, 2]);
                        if !are_pair || first.iter().any(|each| second.contains(each)) {
                            continue;
                        }
                        let reach = bound.max(slack + thickness);
                        if gap(&aligned, first, second) > reach {
                            continue;
                        }
                        let is = apart(&places, first, second);
                        assert!(
                            is >= f64::from(bound) - ROUNDING,
                            "{name}: {is} m, {bound} m"
                        );
                        let was = at_rest
                            .entry(named(first, second))
                            .or_insert_with(|| apart(rest, first, second));
                        let touch = f64::from(thickness).min(f64::from(OF_REST) * *was);
                        assert!(is - touch >= f64::from(slack) - ROUNDING, "{name}: {is} m");
                    }
                }
            }
        }
    }
    for (name, count) in &bounded {
        assert!(*count > 40, "{name}: {count}");
    }
    assert_eq!(bounded.len(), 5);
}

/// A roll that closes and opens again, in many ticks, after a cloth that does not touch itself: all that is near is a contact. Windows
/// fold and unfold, what they use is measured from zero in each tick, and those of the other cloth stand before them.
#[test]
fn what_folds_and_unfolds_is_found() {
    const STEPS: usize = 150;
    let thickness = 0.03;
    for is_mesh in [false, true] {
        let first = Sheeted::of_kind(6, 0.5, !is_mesh, |at| at + 3.0 * Vec3::Y);
        let before = first.particles.len() as u32;
        let mut cloths = vec![first, Sheeted::of_kind(9, 1.0, is_mesh, |at| at)];
        let brute = Brute::new(&cloths[1]);
        let rest: Vec<Vec3> = cloths[1].particles.positions().collect();
        let mut contact = MutualContact::default();
        let (mut near, mut pairs) = (Vec::new(), Vec::new());
        for step in 0..STEPS {
            let time = 0.5 - 0.5 * (6.0 * TAU * step as f32 / (2 * STEPS) as f32).cos();
            for (index, at) in rest.iter().enumerate() {
                let set = cloths[1].particles.set_position(index, rolled(*at, time));
                set.expect("it exists");
            }
            let mut of = participants(&mut cloths, settings(thickness));
            of[0].settings.with_itself = false;
            if step == 0 {
                contact.begin(&of, |_, _| true);
                continue;
            }
            if step % 4 == 0 {
                contact.near.begin_tick(&of, &mut contact.motion);
            }
            contact.counts.work = usize::MAX;
            contact.motion.read(&of);
            contact.motion.measure_all();
            contact.motion.measure(&of);
            contact.look(&of, |_, _| true).expect("not too much work");
            let of_both = near_features(&contact).into_iter();
            let own = |of: Vec<u32>| -> Vec<u32> { of.iter().map(|at| at - before).collect() };
            let contacts: HashSet<Feature> = of_both.map(|(a, b)| (own(a), own(b))).collect();
            contact.motion.pass(&of, 0.05 * thickness);
            contact.near.pass(&of, &contact.motion);
            pairs.push(contact.pairs());
            let mut met = 0;
            let reach = f64::from(thickness) - ROUNDING;
            brute.near(&places(&cloths[1]), reach, |feature, apart| {
                met += 1;
                let is_known = contacts.contains(&feature);
                assert!(
                    is_known,
                    "step {step}, mesh {is_mesh}: {feature:?}, {apart} m"
                );
            });
            near.push(met);
        }
        let closed = near.windows(2).filter(|of| of[0] == 0 && of[1] > 0);
        assert_eq!(closed.count(), 3, "it closes three times");
        // Once it is open again, hardly anything is listed.
        let open = pairs[STEPS / 3 - 2..][..4].iter().min();
        let most = pairs.iter().max();
        assert!(open.zip(most).is_some_and(|(open, most)| 4 * open < *most));
    }
}
