//! No pair of near features is lost, and patches that are skipped cannot touch.

use std::collections::{HashMap, HashSet};

use bevy::math::{DVec3, Vec3};

use super::{
    Scene, Sheeted, participants, settings,
    thrown::Draw,
    torn::{OF_REST, in_plane},
};
use crate::contact::layers::{MutualContact, patch_pair::Candidate};

/// What a square of 1 m is bent into: flat, rolled up more and more, folded, wavy, crumpled.
pub(super) fn shapes() -> Vec<(&'static str, fn(Vec3) -> Vec3)> {
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

pub(super) type Feature = (Vec<u32>, Vec<u32>);

/// The distance of each vertex from the nearest of its faces (m).
fn nearest_faces<'a>(of: impl Iterator<Item = &'a Candidate>) -> HashMap<u32, f32> {
    let mut nearest = HashMap::new();
    for candidate in of.filter(|of| of.is_vertex_with_face()) {
        let known = nearest
            .entry(candidate.particles[0])
            .or_insert(f32::INFINITY);
        *known = known.min(candidate.nearest.distance);
    }
    nearest
}

/// All features that are near each other. Those that are no contacts are left out since others push them: of each vertex the
/// nearest face is pushed.
pub(super) fn near_features(contact: &MutualContact) -> HashSet<Feature> {
    let near = &contact.near;
    let contacts = || {
        let all = near.contacts(&contact.motion);
        all.map(|(index, _)| near.candidate(index))
    };
    let known: HashSet<Feature> = contacts().map(feature).collect();
    for left_out in near.near().filter(|of| !known.contains(&feature(of))) {
        assert!(!left_out.is_pushed && !left_out.may_pass, "{left_out:?}");
    }
    let pushed = nearest_faces(contacts().filter(|contact| contact.is_pushed));
    assert_eq!(nearest_faces(near.near()), pushed);
    near.near().map(feature).collect()
}

/// A pair, whichever way its features are named.
pub(super) fn named(first: &[u32], second: &[u32]) -> Feature {
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

/// The point of a feature that is nearest to a point, in f64.
pub(super) fn nearest(of: &[DVec3], point: DVec3) -> DVec3 {
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
}

/// The distance of two features, by looking at all of both: by alternating projections, which ends in the nearest points of two
/// convex sets.
pub(super) fn distance(first: &[DVec3], second: &[DVec3]) -> f64 {
    let mut point = first[0];
    for _ in 0..400 {
        point = nearest(first, nearest(second, point));
    }
    nearest(second, point).distance(point)
}

/// The features of a surface, and which of them are near each other, by brute force.
pub(super) struct Brute {
    faces: Vec<[u32; 3]>,
    pub edges: Vec<[u32; 2]>,
    vertices: u32,
}

impl Brute {
    pub fn new(cloth: &Sheeted) -> Self {
        let faces = cloth.surface.triangles().to_vec();
        let sides = faces
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .map(|[a, b]| [a.min(b), a.max(b)]);
        let mut edges: Vec<[u32; 2]> = sides.collect();
        edges.sort_unstable();
        edges.dedup();
        Self {
            faces,
            edges,
            vertices: cloth.surface.len() as u32,
        }
    }

    /// Calls `near` with all features of which a vertex is nearer than `reach` to a face, or an edge nearer than half of
    /// that to another.
    pub fn near(&self, places: &[DVec3], reach: f64, mut near: impl FnMut(Feature, f64)) {
        let at =
            |of: &[u32]| -> Vec<DVec3> { of.iter().map(|&each| places[each as usize]).collect() };
        let mut check = |first: &[u32], second: &[u32], reach: f64| {
            let box_of = |of: &[u32]| {
                let places = at(of);
                let low = places
                    .iter()
                    .copied()
                    .reduce(DVec3::min)
                    .expect("a feature");
                (
                    low,
                    places.into_iter().reduce(DVec3::max).expect("a feature"),
                )
            };
            let ((low, high), (from, to)) = (box_of(first), box_of(second));
            let is_far = (low - reach).cmpgt(to).any() || (high + reach).cmplt(from).any();
            if is_far || first.iter().any(|each| second.contains(each)) {
                return;
            }
            let apart = distance(&at(first), &at(second));
            if apart < reach {
                near(named(first, second), apart);
            }
        };
        for vertex in 0..self.vertices {
            for face in &self.faces {
                check(&[vertex], face, reach);
            }
        }
        for (index, first) in self.edges.iter().enumerate() {
            for second in &self.edges[index + 1..] {
                check(first, second, 0.5 * reach);
            }
        }
    }
}

pub(super) fn feature(candidate: &Candidate) -> Feature {
    let (first, second) = candidate.particles.split_at(candidate.split as usize);
    named(first, second)
}

pub(super) fn places(cloth: &Sheeted) -> Vec<DVec3> {
    let places = cloth.particles.positions();
    places.map(Vec3::as_dvec3).collect()
}

/// Rounding in f32 of distances of a metre.
pub(super) const ROUNDING: f64 = 1.0e-5;

#[test]
fn no_pair_is_lost() {
    for (name, shape) in shapes() {
        for is_mesh in [false, true] {
            let mut cloths = vec![Sheeted::of_kind(11, 1.0, is_mesh, shape)];
            let thickness = 0.03;
            let brute = Brute::new(&cloths[0]);
            let places = places(&cloths[0]);
            let mut contact = MutualContact::default();
            contact.begin(&participants(&mut cloths, settings(thickness)), |_, _| true);
            let known: HashSet<Feature> = contact.near.all().map(feature).collect();
            assert_eq!(known.len(), contact.near.len(), "{name}: each once");
            let mut near = 0;
            brute.near(
                &places,
                f64::from(thickness) - ROUNDING,
                |feature, apart| {
                    near += 1;
                    assert!(
                        known.contains(&feature),
                        "{name}: {feature:?}, {apart} m apart"
                    );
                },
            );
            assert_eq!(
                near == 0,
                ["flat", "wavy"].contains(&name),
                "{name}: {near}"
            );
        }
    }
}

/// In each of many steps of any motion, everything that is near is a contact: folds, flaps and tears that nothing stops.
#[test]
fn no_pair_is_lost_on_the_way() {
    let thickness = 0.03;
    for (side, is_mesh, speed, is_turned, is_thinner) in [
        (9, false, 1.0, false, false),
        (9, false, 4.0, true, false),
        (8, false, 4.0, false, false),
        (7, false, 1.0, true, false),
        (5, false, 1.0, true, false),
        (9, true, 1.0, false, false),
        (9, true, 4.0, true, false),
        (9, false, 0.1, false, false),
        (8, false, 0.02, true, false),
        (9, true, 0.1, true, false),
        (9, true, 0.02, false, false),
        (9, false, 1.0, false, true),
        (9, true, 4.0, true, true),
        (9, true, 0.1, true, true),
    ] {
        let sheet = Sheeted::of_kind(side, 1.0, is_mesh, |at| at);
        let sheet = if is_thinner {
            sheet.of_drawn_thickness(&mut Draw(7))
        } else {
            sheet
        };
        let factors = sheet.factors.clone();
        let factor = |of: &[u32]| -> f64 {
            let each = of
                .iter()
                .map(|&at| factors.as_ref().map_or(1.0, |all| all.each()[at as usize]));
            f64::from(each.sum::<f32>()) / of.len() as f64
        };
        let mut cloths = vec![sheet];
        let brute = Brute::new(&cloths[0]);
        let rest: Vec<Vec3> = cloths[0].particles.positions().collect();
        let mut contact = MutualContact::default();
        let mut met = 0;
        let (steps, begin) = if speed < 1.0 {
            // Shortly before it closes.
            (400, 0.7 - speed * 200.0 / 60.0)
        } else {
            (60, 0.0)
        };
        for step in 0..steps {
            let time = begin + speed * step as f32 / 60.0;
            // A roll that closes, flaps on it, and a drift of all.
            let bent = |at: Vec3| {
                let at = if is_turned {
                    Vec3::new(at.z, at.y, at.x)
                } else {
                    at
                };
                let turns = (9.0 * time).clamp(0.01, 14.0);
                let angle = turns * at.z;
                let radius = (1.0 + 0.1 * at.z) / turns;
                let flap = 0.05 * (20.0 * time + 11.0 * at.x).sin();
                let rolled = Vec3::new(0.0, radius * (1.0 - angle.cos()), radius * angle.sin());
                rolled + Vec3::X * (at.x + flap) + 4.0 * time * Vec3::new(1.0, -1.0, 1.0)
            };
            for (index, &at) in rest.iter().enumerate() {
                let set = cloths[0].particles.set_position(index, bent(at));
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
            let known = near_features(&contact);
            contact.motion.pass(&of, 0.05 * thickness);
            contact.near.pass(&of, &contact.motion);
            let places = places(&cloths[0]);
            brute.near(
                &places,
                f64::from(thickness) - ROUNDING,
                |feature, apart| {
                    let [first, second] = [&feature.0, &feature.1].map(|of| {
                        let each = of.iter().map(|at| rest[*at as usize].as_dvec3());
                        each.collect::<Vec<_>>()
                    });
                    // Features of one cloth may be nearer than that if they are at rest.
                    let part = if first.len() == 2 { 0.5 } else { 1.0 };
                    let own = part * (factor(&feature.0) + factor(&feature.1)) / 2.0;
                    let of_rest = OF_REST * in_plane(&first, &second);
                    if apart >= of_rest.min(own * f64::from(thickness)) - ROUNDING {
                        return;
                    }
                    met += 1;
                    assert!(
                        known.contains(&feature),
                        "step {step} at {speed} of {side}², mesh {is_mesh}: {feature:?}, {apart} m apart"
                    );
                },
            );
        }
        println!("{side}², mesh {is_mesh}, speed {speed}, turned {is_turned}: {met} met");
        assert!(met > 500, "{met} of {side}² at {speed}");
    }
}

/// What has been folded by something else since the last tick, without a word, is found.
#[test]
fn no_pair_is_lost_after_a_sudden_fold() {
    let thickness = 0.03;
    let mut cloths = vec![Sheeted::new(11, 1.0, |at| at)];
    let mut contact = MutualContact::default();
    contact.begin(&participants(&mut cloths, settings(thickness)), |_, _| true);
    assert_eq!(contact.near.all().count(), 0, "flat");
    // A sharp fold between neighbouring patches.
    let folded = Sheeted::new(11, 1.0, |at| {
        Vec3::new(at.x, 0.2 * at.z.abs(), at.z.abs() + 0.02 * at.x)
    });
    cloths[0].particles.copy_from(&folded.particles);
    contact.begin(&participants(&mut cloths, settings(thickness)), |_, _| true);
    let known: HashSet<Feature> = contact.near.all().map(feature).collect();
    let mut near = 0;
    Brute::new(&cloths[0]).near(
        &places(&cloths[0]),
        f64::from(thickness) - ROUNDING,
        |feature, apart| {
            near += 1;
            assert!(known.contains(&feature), "{feature:?}, {apart} m apart");
        },
    );
    assert!(near > 0);
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
            if contact.lost() == scene.step.substeps {
                assert_eq!(contact.pairs(), 0);
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
