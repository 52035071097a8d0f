//! Where cells end, and what of a line is inside of a panel, in pixels.

use super::{Kind, Series};

/// Where the middles of cells are across and down (pixels).
pub fn cells_along(series: &[Series], pixel: &impl Fn([f64; 2]) -> [i32; 2]) -> [Vec<i32>; 2] {
    let cells = series.iter().filter(|series| series.kind == Kind::Cells);
    let places: Vec<[i32; 2]> = cells
        .flat_map(|series| &series.points)
        .map(|point| pixel(point.at))
        .collect();
    [0, 1].map(|axis| {
        let mut along: Vec<i32> = places.iter().map(|place| place[axis]).collect();
        along.sort_unstable();
        along.dedup_by(|a, b| *a - *b <= 2);
        along
    })
}

/// From where to where a cell goes: half-way to its neighbours.
pub fn ends_of_cell(along: &[i32], at: i32) -> [i32; 2] {
    let index = along.partition_point(|&place| place < at - 2);
    let half = |a: Option<&i32>, b: Option<&i32>| a.zip(b).map(|(a, b)| (b - a) as f32 / 2.0);
    let before = half(index.checked_sub(1).map(|i| &along[i]), along.get(index));
    let after = half(along.get(index), along.get(index + 1));
    // At a border it is as far as to the other side.
    let low = before.or(after).unwrap_or(20.0);
    let high = after.or(before).unwrap_or(20.0);
    [at as f32 - low, at as f32 + high].map(|end| end.round() as i32)
}

/// What of a line is between two corners, in parts.
pub fn clipped(points: &[[i32; 2]], [low, high]: [[i32; 2]; 2]) -> Vec<Vec<[i32; 2]>> {
    let mut parts: Vec<Vec<[i32; 2]>> = Vec::new();
    for pair in points.windows(2) {
        let from = pair[0].map(f64::from);
        let way = [0, 1].map(|axis| f64::from(pair[1][axis]) - from[axis]);
        // From which part of it to which it is inside (Liang and Barsky 1984).
        let (mut begin, mut end) = (0.0_f64, 1.0_f64);
        for axis in 0..2 {
            let (near, far) = (
                f64::from(low[axis]) - from[axis],
                f64::from(high[axis]) - from[axis],
            );
            if way[axis] == 0.0 {
                if near > 0.0 || far < 0.0 {
                    end = -1.0;
                }
                continue;
            }
            let (a, b) = (near / way[axis], far / way[axis]);
            (begin, end) = (begin.max(a.min(b)), end.min(a.max(b)));
        }
        if begin > end {
            continue;
        }
        let at = |part: f64| [0, 1].map(|axis| (from[axis] + part * way[axis]).round() as i32);
        match parts.last_mut() {
            Some(last) if last.last() == Some(&at(begin)) => last.push(at(end)),
            _ => parts.push(vec![at(begin), at(end)]),
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_meet_half_way() {
        let along = [10, 20, 40];
        assert_eq!(ends_of_cell(&along, 10), [5, 15]);
        assert_eq!(ends_of_cell(&along, 20), [15, 30]);
        assert_eq!(ends_of_cell(&along, 40), [30, 50]);
        assert_eq!(ends_of_cell(&[7], 7), [-13, 27]);
    }

    #[test]
    fn lines_end_at_the_edge() {
        let corners = [[0, 0], [10, 10]];
        assert_eq!(
            clipped(&[[-5, 5], [5, 5], [5, 25]], corners),
            [vec![[0, 5], [5, 5], [5, 10]]]
        );
        assert_eq!(
            clipped(&[[2, 2], [2, 30], [4, 30], [4, 4]], corners),
            [vec![[2, 2], [2, 10]], vec![[4, 10], [4, 4]]]
        );
        assert!(clipped(&[[-5, 0], [-5, 9]], corners).is_empty());
    }
}
