//! Colours and rest lengths.

use super::*;
use crate::cloth::recipe::Cloth;
use bevy::math::Vec3;
use std::collections::HashSet;

/// Fails if springs of one colour share a particle, or one is there twice. Returns all pairs of ends.
fn check_colours(springs: &Springs) -> HashSet<(u32, u32)> {
    let mut seen = HashSet::new();
    let mut particles = HashSet::new();
    springs.for_each(|colour, spring| {
        let [a, b] = spring.ends;
        for end in [a, b] {
            assert!(
                particles.insert((colour, end)),
                "colour {colour}: {spring:?}"
            );
        }
        assert!(seen.insert((a.min(b), a.max(b))), "twice: {spring:?}");
    });
    seen
}

#[test]
fn colours_share_no_particle_and_no_spring_is_missing_or_twice() {
    for (columns, rows) in [
        (2, 2),
        (2, 3),
        (3, 2),
        (5, 7),
        (8, 8),
        (13, 4),
        (16, 16),
        (41, 6),
        (50, 3),
    ] {
        let grid = Cloth::new(columns, rows, 0.1)
            .grid(Vec3::ONE)
            .expect("a valid grid");
        let springs = Springs::of_grid(&grid, &ClothMaterial::COTTON);
        let seen = check_colours(&springs);
        let (c, r) = (columns as usize, rows as usize);
        let structural = (c - 1) * r + c * (r - 1);
        let shear = 2 * (c - 1) * (r - 1);
        assert_eq!(springs.len(), structural + shear);
        assert_eq!(seen.len(), springs.len());
    }
}

#[test]
fn rest_lengths_are_those_of_the_cloth_at_rest() {
    let grid = Cloth::new(6, 5, 0.25)
        .grid(Vec3::new(2.0, -3.0, 1.0))
        .expect("a valid grid");
    let springs = Springs::of_grid(&grid, &ClothMaterial::COTTON);
    let positions: Vec<Vec3> = grid
        .cells()
        .map(|(r, c)| grid.rest_position(r, c))
        .collect();
    springs.for_each(|_, spring| {
        let [a, b] = spring.ends.map(|end| positions[end as usize]);
        let length = a.distance(b);
        assert!(
            (length - spring.rest_length).abs() < 1e-5,
            "{length} {spring:?}"
        );
    });
}

#[test]
fn an_infinite_compliance_leaves_its_springs_out() {
    let grid = Cloth::new(6, 5, 0.25)
        .grid(Vec3::ONE)
        .expect("a valid grid");
    let material = ClothMaterial {
        shear_compliance: f32::INFINITY,
        ..ClothMaterial::COTTON
    };
    let springs = Springs::of_grid(&grid, &material);
    assert!(springs.has(SpringKind::Structural));
    assert!(!springs.has(SpringKind::Shear));
}

/// Springs in any order, all of them at random, and thirty to forty at one particle.
#[test]
fn a_list_is_coloured_and_no_spring_is_lost() {
    let mut ends = HashSet::new();
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) % 40
    };
    while ends.len() < 300 {
        let (a, b) = (random(), random());
        if a != b {
            ends.insert((a.min(b), a.max(b)));
        }
    }
    ends.extend((1..40).map(|end| (0, end)));
    let spring = |&(a, b): &(u32, u32)| Spring {
        kind: SpringKind::Structural,
        ends: [a, b],
        rest_length: 1.0,
        compliance: 0.0,
    };
    let list: Vec<Spring> = ends.iter().map(spring).collect();
    let springs = Springs::of_list(&list, 40).expect("valid springs");
    assert_eq!(check_colours(&springs), ends);

    for bad in [
        Spring {
            ends: [3, 40],
            ..list[0]
        },
        Spring {
            ends: [3, 3],
            ..list[0]
        },
        Spring {
            rest_length: 0.0,
            ..list[0]
        },
        Spring {
            compliance: f32::NAN,
            ..list[0]
        },
    ] {
        let mut list = list.clone();
        list[7] = bad;
        assert!(matches!(
            Springs::of_list(&list, 40),
            Err(SpringError::Invalid { index: 7, .. })
        ));
    }
}

#[test]
fn a_hub_of_more_springs_than_colours_is_coloured_too() {
    let list: Vec<Spring> = (1..100)
        .map(|end| Spring {
            kind: SpringKind::Structural,
            ends: [0, end],
            rest_length: 1.0,
            compliance: 0.0,
        })
        .collect();
    let springs = Springs::of_list(&list, 100).expect("valid springs");
    assert_eq!(check_colours(&springs).len(), 99);
}
