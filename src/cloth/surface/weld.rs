//! Finds vertices at the same position.

use bevy::{math::Vec3, platform::collections::HashMap};

/// The first vertex at each position, and the position of each vertex: the first within `weld`.
pub(crate) fn same_places(positions: &[Vec3], weld: f32) -> (Vec<u32>, Vec<u32>) {
    // With cells this large, most vertices need only their own cell.
    let size = 8.0 * weld;
    // −0 becomes 0.
    let cell = |place: Vec3| -> [u32; 3] {
        // Far from the origin, neighbouring cells may coincide: this adds comparisons and misses nothing.
        let coarse = (place / size).floor();
        let cell = if weld > 0.0 { coarse } else { place };
        (cell + Vec3::ZERO).to_array().map(f32::to_bits)
    };
    // The last position in each cell, and the one before it.
    let mut cells: HashMap<[u32; 3], u32> = HashMap::default();
    let mut before: Vec<Option<u32>> = Vec::new();
    cells.reserve(positions.len());
    let mut first: Vec<u32> = Vec::new();
    let mut place_of = Vec::with_capacity(positions.len());
    for (vertex, &position) in positions.iter().enumerate() {
        let is_same = |place: &u32| {
            let other = positions[first[*place as usize] as usize];
            other == position || other.distance_squared(position) <= weld * weld
        };
        let mut found = None;
        let (low, high) = (position - weld, position + weld);
        let ends = [low, high];
        for corner in 0..8 {
            let end = |axis: usize| ends[(corner >> axis) & 1][axis];
            let near = Vec3::new(end(0), end(1), end(2));
            let of_cell =
                std::iter::successors(cells.get(&cell(near)).copied(), |at| before[*at as usize]);
            for known in of_cell.filter(is_same) {
                // The earliest of several, so that the order of cells does not matter.
                found = Some(found.map_or(known, |found: u32| found.min(known)));
            }
            if corner == 0 && cell(low) == cell(high) {
                break;
            }
        }
        place_of.push(found.unwrap_or_else(|| {
            let place = first.len() as u32;
            first.push(vertex as u32);
            before.push(cells.insert(cell(position), place));
            place
        }));
    }
    (first, place_of)
}
