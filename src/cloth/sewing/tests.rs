//! Which particles seams join.

use bevy::math::Vec3;

use super::*;
use crate::{
    cloth::{Cloth, Pin, PinError, Surface},
    meshes::irregular,
};

fn grid(columns: u32, rows: u32, spacing: f32) -> Surface {
    let cloth = Cloth::new(columns, rows, spacing);
    cloth.surface(Vec3::ONE).expect("a valid grid")
}

fn side(surface: &Surface, pins: &[Pin]) -> SewnSide {
    SewnSide::of(surface, pins).expect("particles")
}

/// The particles of its only line, and whether that is a ring.
fn line(side: &SewnSide) -> (&[u32], bool) {
    let [line] = side.lines() else {
        panic!("{} lines", side.lines().len());
    };
    (&line.particles, line.is_ring)
}

/// The distance of each stitch's two points (m).
fn gaps(all: &[Stitch], places: [&[Vec3]; 2]) -> Vec<f32> {
    let gap = |stitch: &Stitch| {
        let others = places[1 - stitch.side as usize];
        let each = stitch.onto.iter().zip(stitch.weights);
        let there: Vec3 = each.map(|(&of, weight)| weight * others[of as usize]).sum();
        there.distance(places[stitch.side as usize][stitch.point as usize])
    };
    all.iter().map(gap).collect()
}

#[test]
fn rows_borders_and_lists_are_lines() {
    let surface = grid(5, 4, 0.1);
    assert_eq!(
        line(&side(&surface, &[Pin::Row(0)])),
        (&[0, 1, 2, 3, 4][..], false)
    );
    assert_eq!(
        line(&side(&surface, &[Pin::Row(2)])),
        (&[10, 11, 12, 13, 14][..], false)
    );
    assert_eq!(
        line(&side(&surface, &[Pin::Column(4)])),
        (&[4, 9, 14, 19][..], false)
    );
    let list = [7, 3, 12].map(Pin::Index);
    assert_eq!(line(&side(&surface, &list)), (&[7, 3, 12][..], false));
    // All around.
    let border = Pin::filter(|row, column| row == 0 || row == 3 || column == 0 || column == 4);
    let all = side(&surface, &[border]);
    let (particles, is_ring) = line(&all);
    assert!(is_ring && particles.len() == 14, "{particles:?}");
    for ends in particles.windows(2) {
        let step = ends[0].abs_diff(ends[1]);
        assert!(step == 1 || step == 5, "{particles:?}");
    }
    // Two lines, and a region.
    let columns = side(&surface, &[Pin::Column(0), Pin::Column(4)]);
    assert_eq!(columns.lines().len(), 2);
    let whole = side(&surface, &[Pin::at_rest(|_| true)]);
    assert_eq!(whole, SewnSide::Region(surface.triangles().to_vec()));
    let nothing = SewnSide::of(&surface, &[Pin::at_rest(|_| false)]);
    assert!(matches!(nothing, Err(PinError::FindsNothing { .. })));
    assert!(SewnSide::of(&surface, &[]).is_err());
    assert!(SewnSide::of(&surface, &[Pin::Row(4)]).is_err());
}

/// Of an irregular mesh the upper border is a line from left to right, and so matches a grid of another resolution.
#[test]
fn the_border_of_a_mesh_is_sewn_to_a_grid() {
    let mesh = irregular(1.0, 0.6, 0.05, 0.3);
    let cloth = Cloth::triangles(mesh.positions, mesh.triangles);
    let surface = cloth.surface(Vec3::ONE).expect("a mesh");
    let highest = surface
        .rest_positions()
        .iter()
        .map(|place| place.y)
        .fold(f32::MIN, f32::max);
    let upper = side(
        &surface,
        &[Pin::at_rest(move |place| place.y > highest - 1.0e-3)],
    );
    let (particles, is_ring) = line(&upper);
    assert!(!is_ring && particles.len() > 10);
    for columns in [4, 15, 60] {
        let grid = grid(columns, 3, 1.0 / (columns - 1) as f32);
        let row = side(&grid, &[Pin::Row(2)]);
        // The row lies on the border.
        let rest = surface.rest_positions();
        let ends = [particles[0], particles[particles.len() - 1]].map(|end| rest[end as usize]);
        let left = ends[0].min(ends[1]);
        let row_left = grid.rest_positions()[2 * columns as usize];
        let moved: Vec<Vec3> = grid
            .rest_positions()
            .iter()
            .map(|place| *place - row_left + left)
            .collect();
        for sides in [[&upper, &row], [&row, &upper]] {
            let places = match sides[0] == &upper {
                true => [rest, &moved[..]],
                false => [&moved[..], rest],
            };
            let all = stitches(sides, places, 0.1);
            assert_eq!(all.len(), particles.len().max(columns as usize));
            let shares: f32 = all.iter().map(|stitch| stitch.share).sum();
            assert!((shares - 1.0).abs() < 1.0e-3, "{shares}");
            let widest = gaps(&all, places).into_iter().fold(0.0, f32::max);
            assert!(widest < 1.0e-3, "{columns}: {widest} m");
        }
    }
}

/// Rings are turned until they are nearest, whichever way their particles go, and a patch is sewn to the faces below.
#[test]
fn rings_and_patches_are_sewn_where_they_are() {
    let ring = |count: u32, turn: f32, way: f32| {
        let angle =
            move |index: u32| way * (index as f32 / count as f32) * std::f32::consts::TAU + turn;
        let each = (0..count).map(|index| Vec3::new(angle(index).cos(), angle(index).sin(), 0.0));
        let places: Vec<Vec3> = each.collect();
        let line = line::Line::new((0..count).collect(), true, &places);
        (SewnSide::Lines(vec![line]), places)
    };
    let (first, places) = ring(24, 0.0, 1.0);
    for (count, turn, way) in [
        (24, 0.0, 1.0),
        (24, 1.0, 1.0),
        (48, 2.0, -1.0),
        (9, -0.5, -1.0),
    ] {
        let (second, others) = ring(count, turn, way);
        let all = stitches([&first, &second], [&places, &others], 0.1);
        let widest = gaps(&all, [&places, &others])
            .into_iter()
            .fold(0.0, f32::max);
        // Half a step of the finer one, and the chord of the coarser one.
        let most = std::f32::consts::PI / 24.0_f32.max(count as f32) + 0.07;
        assert!(widest < most, "{count} {turn} {way}: {widest}");
    }
    let (flag, patch) = (grid(21, 21, 0.05), grid(8, 8, 0.03));
    let border = Pin::filter(|row, column| row % 7 == 0 || column % 7 == 0);
    let sides = [
        side(&patch, &[border]),
        side(&flag, &[Pin::at_rest(|_| true)]),
    ];
    let shift = Vec3::new(0.31, -0.42, 0.001);
    let places: Vec<Vec3> = patch
        .rest_positions()
        .iter()
        .map(|place| *place + shift)
        .collect();
    let places = [&places[..], flag.rest_positions()];
    let all = stitches([&sides[0], &sides[1]], places, 0.1);
    assert_eq!(all.len(), 28);
    for gap in gaps(&all, places) {
        assert!((gap - 0.001).abs() < 1.0e-5, "{gap}");
    }
}
