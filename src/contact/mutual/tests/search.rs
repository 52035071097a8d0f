//! The search loses no pair, and what is passed over whole can't touch itself.

use std::collections::HashSet;

use bevy::math::{DVec3, Vec3, Vec3A};

use super::{Scene, Sheeted, participants, settings};
use crate::contact::mutual::{
    LONGEST_WAIT,
    bounds::Tangents,
    search::{Found, Search},
};

/// What a square of 1 m is bent into: flat, rolled up more and more, folded, wavy, crumpled.
fn shapes() -> Vec<(&'static str, fn(Vec3) -> Vec3)> {
    vec![
        ("flat", |at| at),
        ("wavy", |at| {
            at + Vec3::Y * 0.08 * (9.0 * at.x).sin() * (7.0 * at.z).cos()
        }),
        ("rolled", |at| {
            let angle = 14.0 * (at.z + 0.5);
            let radius = 0.05 + 0.002 * angle;
            Vec3::new(at.x, radius * angle.sin(), radius * angle.cos())
        }),
        ("folded", |at| {
            if at.z > 0.0 {
                Vec3::new(at.x + 0.011, 0.006 + 0.3 * at.z * at.x.abs(), -at.z)
            } else {
                at
            }
        }),
        ("crumpled", |at| {
            let turn = |k: f32| (k * at.x + 3.0 * at.z).sin();
            Vec3::new(
                0.2 * turn(17.0),
                0.2 * turn(23.0),
                0.2 * turn(29.0) + 0.1 * at.z,
            )
        }),
    ]
}

type Feature = (Vec<u32>, Vec<u32>);

/// A pair, whichever way its features are named.
fn named(first: &[u32], second: &[u32]) -> Feature {
    let sorted = |of: &[u32]| {
        let mut of = of.to_vec();
        of.sort_unstable();
        of
    };
    let (first, second) = (sorted(first), sorted(second));
    if (first.len(), &first) <= (second.len(), &second) {
        (first, second)
    } else {
        (second, first)
    }
}

/// The distance of two features, by looking at all of both: in f64, by alternating projections, which ends in the nearest points
/// of two convex sets.
fn distance(first: &[DVec3], second: &[DVec3]) -> f64 {
    let onto = |of: &[DVec3], point: DVec3| -> DVec3 {
        let segment = |a: DVec3, b: DVec3| {
            let along = b - a;
            a + along * ((point - a).dot(along) / along.length_squared()).clamp(0.0, 1.0)
        };
        match *of {
            [a] => a,
            [a, b] => segment(a, b),
            [a, b, c] => {
                let normal = (b - a).cross(c - a);
                let flat = point - normal * ((point - a).dot(normal) / normal.length_squared());
                let side = |p: DVec3, q: DVec3| (q - p).cross(flat - p).dot(normal) >= 0.0;
                if side(a, b) && side(b, c) && side(c, a) {
                    return flat;
                }
                [segment(a, b), segment(b, c), segment(c, a)]
                    .into_iter()
                    .min_by(|p, q| {
                        p.distance_squared(point)
                            .total_cmp(&q.distance_squared(point))
                    })
                    .expect("three")
            }
            _ => unreachable!("a vertex, an edge or a face"),
        }
    };
    let mut point = first[0];
    for _ in 0..400 {
        point = onto(first, onto(second, point));
    }
    onto(second, point).distance(point)
}

#[test]
fn no_pair_is_lost() {
    for (name, shape) in shapes() {
        let mut cloths = vec![Sheeted::new(11, 1.0, shape)];
        let (thickness, margin) = (0.03, 0.025);
        let surface = cloths[0].surface.clone();
        let places: Vec<DVec3> = cloths[0]
            .particles
            .positions()
            .map(Vec3::as_dvec3)
            .collect();
        let mut search = Search::default();
        let participants = participants(&mut cloths, settings(thickness));
        assert!(search.find(&participants, |_, _| true, margin, &mut usize::MAX.clone()));
        let found = &search.found;
        let pair = |found: &Found| {
            let (first, second) = found.particles.split_at(found.split);
            named(first, second)
        };
        let known: HashSet<Feature> = found.iter().map(pair).collect();
        assert_eq!(known.len(), found.len(), "{name}: each once");
        let faces = surface.triangles();
        let mut edges: Vec<[u32; 2]> = faces
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        edges.sort_unstable();
        edges.dedup();
        let at = |of: &[u32]| {
            of.iter()
                .map(|&each| places[each as usize])
                .collect::<Vec<_>>()
        };
        let mut near = 0;
        let mut check = |first: &[u32], second: &[u32], reach: f64| {
            if first.iter().any(|each| second.contains(each)) {
                return;
            }
            let apart = distance(&at(first), &at(second));
            let is_known = known.contains(&named(first, second));
            if apart < reach - 1.0e-4 {
                near += 1;
                assert!(
                    is_known,
                    "{name}: {first:?} and {second:?}, {apart} m apart"
                );
            } else if apart > reach + 1.0e-4 {
                assert!(
                    !is_known,
                    "{name}: {first:?} and {second:?}, {apart} m apart"
                );
            }
        };
        for vertex in 0..surface.len() as u32 {
            for face in faces {
                check(&[vertex], face, 0.055);
            }
        }
        for (index, first) in edges.iter().enumerate() {
            for second in &edges[index + 1..] {
                check(first, second, 0.04);
            }
        }
        assert_eq!(
            near == 0,
            ["flat", "wavy"].contains(&name),
            "{name}: {near}"
        );
    }
}

/// Whatever a patch is bent into, no two of its points are nearer than the bound says.
#[test]
fn what_is_hardly_bent_keeps_its_points_apart() {
    let mut has_bound = 0;
    for (name, shape) in shapes() {
        for scale in [1.0, 0.4, 0.1] {
            let shape = move |at: Vec3| shape(at * scale) / scale;
            let cloth = Sheeted::new(9, 1.0, shape);
            let places: Vec<Vec3A> = cloth.particles.positions().map(Vec3A::from).collect();
            let mut tangents = Vec::new();
            cloth.sheet.tangents(&places, &mut tangents);
            let bound = f64::from(tangents[0].unfolded());
            let whole = cloth.sheet.tangents_of_all(&cloth.particles);
            let whole = whole.map_or(0.0, |tangents: Tangents| tangents.unfolded());
            assert!(
                (f64::from(whole) - bound).abs() < 1.0e-5,
                "{name}: {whole}, {bound}"
            );
            if bound <= 0.0 {
                continue;
            }
            has_bound += 1;
            let rest = cloth.surface.rest_positions();
            for a in 0..places.len() {
                for b in a + 1..places.len() {
                    let apart = f64::from((places[a] - places[b]).length());
                    let at_rest = f64::from(rest[a].distance(rest[b]));
                    assert!(
                        apart >= bound * at_rest,
                        "{name}: {apart} of {at_rest}, {bound}"
                    );
                }
            }
        }
    }
    assert!(has_bound > 5, "{has_bound}");
}

/// A search ends, however many features are near each other, and finds no more than it may: of a sheet that is crammed into a tenth of a
/// spacing or thrown asunder, and of one so thick that everything is near. It is said that layers were not kept apart, and what comes
/// back into shape is kept apart again.
#[test]
fn what_is_too_much_to_look_for_is_let_go() {
    let scattered = |size: f32| {
        move |at: Vec3| {
            let turn = |k: f32| (k * at.x + 1.7 * k * at.z).sin();
            size * Vec3::new(turn(1.0e3), turn(2.3e3), turn(3.1e3))
        }
    };
    let side = 24;
    let particles = (side * side) as usize;
    for (name, size, thickness) in [
        ("crammed", 0.003, 0.01),
        ("asunder", 1.0e6, 0.01),
        ("thick", 1.0, 30.0),
    ] {
        let mut scene = Scene::new(vec![Sheeted::new(side, 1.0, scattered(size))], thickness);
        for _ in 0..3 {
            let cloth = &mut scene.cloths[0];
            for index in 0..particles {
                // In each tick others are where none had been.
                let at = cloth.particles.position(index).expect("it exists");
                let at = at + Vec3::splat(0.37);
                let at = Vec3::new(at.y, at.z, at.x);
                cloth.particles.set_position(index, at).expect("finite");
            }
            scene.tick(|_, _, _| {});
            let contact = &scene.contact;
            let substeps = scene.step.substeps;
            if contact.lost() == substeps {
                assert!(contact.searches() <= 1 + substeps / LONGEST_WAIT, "{name}");
                assert!(contact.pairs() == 0 && contact.search.found.is_empty());
            }
        }
        assert!(name == "asunder" || scene.contact.lost() > 0, "{name}");
        let again = Sheeted::new(side, 1.0, |at| at);
        scene.cloths[0].particles.copy_from(&again.particles);
        // As the plugin does where particles are put elsewhere.
        scene.contact.forget();
        scene.settings = settings(0.01);
        scene.tick(|_, _, _| {});
        assert_eq!(scene.contact.lost(), 0, "{name}");
    }
}
