//! No pair of near features of a torn cloth is lost.

use std::{collections::HashSet, sync::Arc};

use bevy::math::{DVec3, Vec3};

use super::{
    Sheeted, participants,
    search::{Brute, Feature, ROUNDING, feature, near_features, nearest, places},
    settings,
    thrown::Draw,
};
use crate::contact::layers::{MutualContact, intersections, intersections::passes};

/// Distance that features keep, as a fraction of the thickness for edges, and of the distance at rest.
const OF_EDGES: f64 = 0.5;
pub(super) const OF_REST: f64 = 0.5;

/// The distance of two features in one plane that do not cross: it is at a corner of one of them.
pub(super) fn in_plane(first: &[DVec3], second: &[DVec3]) -> f64 {
    let from = |corners: &[DVec3], of: &[DVec3]| {
        (corners.iter())
            .map(|at| nearest(of, *at).distance(*at))
            .fold(f64::INFINITY, f64::min)
    };
    from(first, second).min(from(second, first))
}

/// A sheet with this number of particles a side, torn along this part of its edges, as drawn.
fn torn(side: u32, is_mesh: bool, part: f32, draw: &mut Draw) -> Sheeted {
    let whole = Sheeted::of_kind(side, 1.0, is_mesh, |at| at);
    let mut edges = Brute::new(&whole).edges;
    edges.retain(|_| draw.next() < 2.0 * part - 1.0);
    let surface = whole.surface.torn(&edges).expect("edges");
    assert!(surface.len() > whole.surface.len() + 5, "cuts open");
    Sheeted::of_surface(Arc::new(surface), |at| at)
}

/// A place of a roll that closes (m).
pub(super) fn rolled(at: Vec3, time: f32) -> Vec3 {
    let turns = (9.0 * time).max(0.01);
    let (sin, cos) = (turns * at.z).sin_cos();
    let radius = (1.0 + 0.1 * at.z) / turns;
    Vec3::new(at.x, radius * (1.0 - cos), radius * sin)
}

/// Grids and meshes with slits, with holes and in single faces, in many steps: a roll closes, and each particle goes a way of its own.
/// So cuts open, and their sides pass through each other and others. All that is nearer than it is kept apart is
/// listed, and a contact.
#[test]
fn no_pair_of_a_torn_cloth_is_lost() {
    const STEPS: usize = 24;
    let thickness = 0.03;
    let reach = f64::from(thickness) - ROUNDING;
    let (mut met, mut across) = (0, 0);
    for (seed, side, is_mesh, part) in [
        (1, 7, false, 0.15),
        (2, 7, false, 0.4),
        (3, 5, false, 1.0),
        (4, 7, true, 0.15),
        (5, 7, true, 0.4),
        (6, 5, true, 1.0),
    ] {
        let mut draw = Draw(7919 * seed);
        let mut cloths = vec![torn(side, is_mesh, part, &mut draw)];
        let brute = Brute::new(&cloths[0]);
        let rest: Vec<Vec3> = cloths[0].particles.positions().collect();
        let at_rest = places(&cloths[0]);
        let surface = cloths[0].surface.clone();
        // Otherwise they would begin inside each other, and be left alone.
        assert_eq!(intersections(&[(&surface, rest.clone())]), 0, "{seed}");
        let ways: Vec<Vec3> = rest.iter().map(|_| 0.1 * draw.vector()).collect();
        let mut contact = MutualContact::default();
        for step in 0..STEPS {
            let time = step as f32 / STEPS as f32;
            for (index, (at, way)) in rest.iter().zip(&ways).enumerate() {
                let place = rolled(*at, time) + (9.0 * time).sin() * *way;
                let set = cloths[0].particles.set_position(index, place);
                set.expect("it exists");
            }
            let of = participants(&mut cloths, settings(thickness));
            if step == 0 {
                contact.begin(&of, |_, _| true);
                continue;
            }
            contact.counts.work = usize::MAX;
            contact.motion.read(&of);
            contact.motion.measure_all();
            contact.motion.measure(&of);
            contact.look(&of, |_, _| true).expect("not too much work");
            let listed: HashSet<Feature> = contact.near.all().map(feature).collect();
            let contacts = near_features(&contact);
            contact.motion.pass(&of, 0.05 * thickness);
            contact.near.pass(&of, &contact.motion);
            brute.near(&places(&cloths[0]), reach, |feature, apart| {
                let name = || format!("step {step} of {seed}: {feature:?}, {apart} m apart");
                let [first, second] = [&feature.0, &feature.1].map(|of| {
                    of.iter()
                        .map(|at| at_rest[*at as usize])
                        .collect::<Vec<_>>()
                });
                let of_both = if first.len() == 2 { OF_EDGES } else { 1.0 };
                let kept = (of_both * reach).min(OF_REST * in_plane(&first, &second) - ROUNDING);
                if apart < kept {
                    met += 1;
                    assert!(listed.contains(&feature), "not listed: {}", name());
                    assert!(contacts.contains(&feature), "no contact: {}", name());
                }
                let was = |at: &u32| surface.origin_of(*at);
                let is_across = |at: &u32| feature.1.iter().any(|of| was(of) == was(at));
                across += usize::from(feature.0.iter().any(is_across));
            });
        }
    }
    assert!(met > 100, "{met} contacts");
    assert!(across > 100, "{across} near pairs across cuts");
}

/// Cloth that is crumpled, but does not intersect itself, is torn anywhere. As its sides are moved apart, faces beside a torn edge never
/// pass each other. Others may, which meet in a point alone, but not in the milder half. In a second step, sides of the first are a
/// little apart already, and are parted as if they were not: of these cloths fewer than one in a hundred crosses beside an edge.
#[test]
fn sides_of_a_cut_part_without_crossing() {
    let (mut mild, mut wild, mut in_two_steps, mut crossed) = (0, 0, 0, 0);
    for seed in 1..=4_000 {
        let mut draw = Draw(7919 * seed);
        let whole = Sheeted::of_kind(4, 1.0, seed % 2 == 0, |at| at);
        let rest: Vec<Vec3> = whole.particles.positions().collect();
        let strength = 0.5 * (1.0 + draw.next());
        let places: Vec<Vec3> = (rest.iter())
            .map(|at| *at + strength * draw.vector())
            .collect();
        if intersections(&[(&whole.surface, places.clone())]) > 0 {
            continue;
        }
        let mut edges = Brute::new(&whole).edges;
        edges.retain(|_| draw.next() < -0.4);
        // In one step, or in two.
        let first = edges.len() / (1 + seed as usize / 2 % 2);
        let (mut before, mut parted) = (whole.surface.clone(), places);
        for edges in [&edges[..first], &edges] {
            let surface = Arc::new(before.torn(edges).expect("edges"));
            let parents = surface.parents_in(&before).expect("one whole surface");
            let copied: Vec<Vec3> = (parents.iter())
                .map(|parent| parted[*parent as usize])
                .collect();
            parted = surface.parted(&copied, |particle| parents[particle as usize]);
            before = surface;
        }
        let surface = before;
        if surface.len() == rest.len() {
            continue;
        }
        let origin = |particle| surface.origin_of(particle);
        // Of 0.6 spacings.
        if strength < 0.2 && first == edges.len() {
            assert_eq!(intersections(&[(&surface, parted)]), 0, "{seed}");
            mild += 1;
            continue;
        }
        let is_whole = first == edges.len();
        let mut has_passed = false;
        let faces = surface.triangles();
        for (index, a) in faces.iter().enumerate() {
            for b in &faces[..index] {
                let common = |of: &&u32| b.iter().any(|other| origin(*other) == origin(**of));
                let is_torn = a.iter().filter(common).count() == 2;
                let corners = [a, b].map(|face| face.map(|of| parted[of as usize].as_dvec3()));
                let is_passed = is_torn
                    && a.iter().all(|of| !b.contains(of))
                    && [[0, 1], [1, 0]].iter().any(|[own, other]| {
                        let [p, q, r] = corners[*own];
                        let mut edges = [[p, q], [q, r], [r, p]].into_iter();
                        edges.any(|edge| passes(edge, corners[*other]))
                    });
                assert!(!is_passed || !is_whole, "{seed}: {a:?} {b:?}");
                has_passed |= is_passed;
            }
        }
        wild += usize::from(is_whole);
        in_two_steps += usize::from(!is_whole);
        crossed += usize::from(has_passed);
    }
    println!("{mild} {wild} {in_two_steps}: {crossed}");
    assert!(mild > 250 && wild > 150 && in_two_steps > 400);
    assert!(100 * crossed < in_two_steps);
}
