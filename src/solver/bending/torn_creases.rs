//! The creases of a cloth whose faces come apart.

use bevy::math::{DMat2, DVec2, Vec3A};

use super::patch::frame;
use crate::cloth::{ClothGrid, Surface};

/// Numbers of a face: three vectors.
const OF_FACE: usize = 9;

/// The rest curvatures of a surface, from those that it had before it was torn further. Faces of a mesh keep theirs, unless a tear
/// turned them. What becomes a grid again has none.
pub(crate) fn creases_of_torn(before: &Surface, after: &Surface, rest: &[f32]) -> Vec<f32> {
    if rest.is_empty() {
        return Vec::new();
    }
    match (before.as_grid(), after.as_grid()) {
        (Some(grid), None) if rest.len() == 3 * before.len() => of_grid(grid, before, after, rest),
        (None, None) => of_mesh(before, after, rest),
        _ => Vec::new(),
    }
}

fn of_mesh(before: &Surface, after: &Surface, rest: &[f32]) -> Vec<f32> {
    let [known, faces] = [before, after].map(|of| of.bending_faces().faces());
    if rest.len() != OF_FACE * faces.len() || known.len() != faces.len() {
        return Vec::new();
    }
    let mut creases = rest.to_vec();
    for ((known, face), crease) in known.iter().zip(faces).zip(creases.chunks_mut(OF_FACE)) {
        let was = known.map(|corner| before.origin_of(corner));
        if was != face.map(|corner| after.origin_of(corner)) {
            crease.fill(0.0);
        }
    }
    creases
}

/// A face gets the curvature across its edge along a column, that across its edge along a row, and the twist of its cell: so a fold
/// in one column stays in the faces beside it. With the curvature K along the grid's normal, in directions along its rows and columns,
/// a face with the axes x and y has xᵀ K x, yᵀ K y and √2 xᵀ K y, along its own normal.
fn of_grid(grid: &ClothGrid, before: &Surface, after: &Surface, rest: &[f32]) -> Vec<f32> {
    let columns = grid.columns();
    let place = |particle: u32| Vec3A::from(before.rest_positions()[particle as usize]);
    let number = |particle: u32, kind: usize| f64::from(rest[3 * particle as usize + kind]);
    let mut creases = Vec::with_capacity(OF_FACE * after.bending_faces().faces().len());
    for face in after.bending_faces().faces() {
        let corners = face.map(|corner| after.origin_of(corner));
        let cells = corners.map(|corner| [corner % columns, corner / columns]);
        let first = |along: usize| cells.map(|cell| cell[along]).into_iter().min().unwrap_or(0);
        let cell = first(1) * columns + first(0);
        // Of the two corners in one column, or in one row.
        let mean = |kind: usize| {
            let count = |at: u32| cells.iter().filter(|cell| cell[kind] == at).count();
            let on = cells.iter().zip(corners);
            let on = on.filter(|(cell, _)| count(cell[kind]) == 2);
            on.map(|(_, corner)| number(corner, kind)).sum::<f64>() / 2.0
        };
        let curvature =
            DMat2::from_cols_array_2d(&[[mean(0), number(cell, 2)], [number(cell, 2), mean(1)]]);
        let across = (place(cell + 1) - place(cell)).normalize();
        let down = (place(cell + columns) - place(cell)).normalize();
        let Some([x, y, z]) = frame(corners.map(place)) else {
            creases.extend([0.0; OF_FACE]);
            continue;
        };
        let [x, y] = [x, y].map(|axis| DVec2::new(axis.dot(across).into(), axis.dot(down).into()));
        let side = f64::from(z.dot(across.cross(down)).signum());
        let bent = [
            x.dot(curvature * x),
            y.dot(curvature * y),
            std::f64::consts::SQRT_2 * x.dot(curvature * y),
        ];
        for bent in bent {
            creases.extend([0.0, 0.0, (side * bent) as f32]);
        }
    }
    creases
}
