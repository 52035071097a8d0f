//! The curvature of a face, from the faces beside it.

use bevy::math::{DMat3, DVec2, DVec3, Vec3, Vec3A};

use crate::cloth::{Grouped, MapInline};

/// Regularisation, as a fraction: edges with nearly the same information about a face's curvature don't make it
/// infinite.
const REGULAR: f64 = 1.0e-3;
/// Rest curvatures below this, times the size of a face, are none.
const FLAT: f64 = 1.0e-4;

/// The forces of a face that is curved at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RestFace {
    /// Its index among the faces on which the surface bends.
    pub face: u32,
    /// Its corners first.
    pub particles: [u32; 6],
    /// Force of its rest curvature on each (N), in the face's frame.
    pub forces: [[f32; 3]; 6],
}

/// The frame of a face with these corners: along its first edge, beside that, and its normal.
pub(super) fn frame([a, b, c]: [Vec3A; 3]) -> Option<[Vec3A; 3]> {
    let x = (b - a).try_normalize()?;
    let z = x.cross(c - a).try_normalize()?;
    Some([x, z.cross(x), z])
}

/// Calls `visit` with each row of the matrix of patches with these stiffnesses: its columns that are not zero, ascending, and
/// the sums of what the patches add there, in their order.
pub(super) fn for_each_row(
    patches: &[(Patch, f64)],
    rows: usize,
    mut visit: impl FnMut(u32, &[(u32, f64)]),
) {
    // The patches around each particle, and which of their particles it is.
    let around = Grouped::new(rows, || {
        let all = patches.iter().flat_map(|(patch, _)| patch.particles);
        let patches = 0..patches.len() as u32;
        all.zip(patches.flat_map(|patch| (0..6_u32).map(move |at| (patch, at))))
    });
    const NONE: u32 = u32::MAX;
    let mut numbers: Vec<(u32, f64)> = Vec::new();
    // Where the number of each column is.
    let mut place = vec![NONE; rows];
    for row in 0..rows as u32 {
        for &(patch, a) in around.of(row) {
            let (patch, stiffness) = &patches[patch as usize];
            for (b, column) in patch.particles.iter().enumerate() {
                let products = patch.curvature.iter().map(|of| of[a as usize] * of[b]);
                let product: f64 = products.sum();
                if product == 0.0 {
                    continue;
                }
                let place = &mut place[*column as usize];
                if *place == NONE {
                    *place = numbers.len() as u32;
                    numbers.push((*column, 0.0));
                }
                numbers[*place as usize].1 += stiffness * product;
            }
        }
        numbers.sort_unstable_by_key(|(column, _)| *column);
        visit(row, &numbers);
        for (column, _) in numbers.drain(..) {
            place[column as usize] = NONE;
        }
    }
}

/// A face and those beside it.
pub(super) struct Patch {
    /// Its corners, and the corners beyond its edges; where there is none, a corner again, with zeros.
    pub particles: [u32; 6],
    /// Contribution of each particle's position to `κ_xx`, `κ_yy` and `√2 κ_xy` (1/m²). Of a woven patch, x is along the
    /// warp, and each is scaled by the root of its rigidity over the mean one.
    pub curvature: [[f64; 6]; 3],
    /// m².
    pub area: f64,
}

impl Patch {
    pub fn new(corners: [u32; 3], beside: [Option<u32>; 3], places: &[DVec3]) -> Option<Self> {
        let place = |particle: u32| places[particle as usize];
        let [a, b, c] = corners.map_inline(place);
        let (x, normal) = ((b - a).normalize(), (b - a).cross(c - a));
        let area = normal.length() / 2.0;
        let y = normal.normalize().cross(x);
        let flat = |at: DVec3| DVec2::new((at - a).dot(x), (at - a).dot(y));
        let flat = [flat(a), flat(b), flat(c)];
        let mut particles = [corners[0]; 6];
        particles[..3].copy_from_slice(&corners);
        // H, and what it is of κ_xx, κ_yy and √2 κ_xy.
        let mut slopes = [[0.0; 6]; 3];
        let mut of_curvature = [DVec3::ZERO; 3];
        for (edge, beyond) in beside.into_iter().enumerate() {
            let Some(beyond) = beyond else {
                continue;
            };
            let [i, j, k] = [0, 1, 2].map_inline(|on| (edge + on) % 3);
            let along = flat[j] - flat[i];
            let length = along.length();
            let out = -DVec2::new(-along.y, along.x) / length;
            let height = -(flat[k] - flat[i]).dot(out);
            let foot = (flat[k] - flat[i]).dot(along) / (length * length);
            let (from, to) = (place(corners[i]), place(corners[j]));
            let foot_beyond = (place(beyond) - from).dot(to - from) / (length * length);
            let height_beyond = place(beyond).distance(from.lerp(to, foot_beyond));
            // Sliver beside sliver says nothing.
            if height.min(height_beyond) < 1.0e-4 * length {
                continue;
            }
            // Unfolded into the face's plane.
            let flat_beyond = flat[i] + along * foot_beyond + out * height_beyond;
            particles[3 + edge] = beyond;
            let slope = &mut slopes[edge];
            slope[3 + edge] = 1.0 / height_beyond;
            slope[k] = 1.0 / height;
            slope[i] = -(1.0 - foot) / height - (1.0 - foot_beyond) / height_beyond;
            slope[j] = -foot / height - foot_beyond / height_beyond;
            for (at, number) in [
                (flat[i], slope[i]),
                (flat[j], slope[j]),
                (flat[k], slope[k]),
                (flat_beyond, slope[3 + edge]),
            ] {
                let squares = DVec3::new(
                    at.x * at.x / 2.0,
                    at.y * at.y / 2.0,
                    at.x * at.y / std::f64::consts::SQRT_2,
                );
                of_curvature[edge] += number * squares;
            }
        }
        let curvature = smallest_curvature(&slopes, &of_curvature)?;
        Some(Self {
            particles,
            curvature,
            area,
        })
    }

    /// From its curvatures to those along `warp`, along the weft and of twist, with the fourth root of the weft's rigidity over
    /// the warp's. The same ones without a warp.
    pub fn woven(&self, warp: Option<DVec3>, ratio: f64, places: &[DVec3]) -> [[f64; 3]; 3] {
        let Some(warp) = warp else {
            return DMat3::IDENTITY.to_cols_array_2d();
        };
        let [a, b, c] = [0, 1, 2].map_inline(|corner| places[self.particles[corner] as usize]);
        let x = (b - a).normalize();
        let y = (b - a).cross(c - a).normalize().cross(x);
        // Beside a turned diagonal, it is that of a face in nearly this plane.
        let along = DVec2::new(warp.dot(x), warp.dot(y)).normalize_or(DVec2::X);
        let (cos, sin) = (along.x, along.y);
        let beside = std::f64::consts::SQRT_2 * cos * sin;
        let (cos, sin) = (cos * cos, sin * sin);
        [
            [cos, sin, beside].map_inline(|number| number / ratio),
            [sin, cos, -beside].map_inline(|number| number * ratio),
            [-beside, beside, cos - sin],
        ]
    }

    /// Makes its curvatures those along `warp`, along the weft and of twist.
    pub fn weave(&mut self, warp: DVec3, ratio: f64, places: &[DVec3]) {
        let woven = self.woven(Some(warp), ratio, places);
        for particle in 0..6 {
            let own = DVec3::from(self.curvature.map_inline(|of| of[particle]));
            for (of, woven) in self.curvature.iter_mut().zip(woven) {
                of[particle] = own.dot(woven.into());
            }
        }
    }

    /// The forces of a face with this index, if it is curved at rest.
    pub fn rest(&self, face: u32, stiffness: f64, places: &[DVec3]) -> Option<RestFace> {
        let at = (self.particles).map_inline(|particle| places[particle as usize]);
        let bent = self.curvature.map_inline(|of| -> DVec3 {
            let each = of.iter().zip(&at);
            // From one corner, so that rounding stays below curvatures.
            each.map(|(number, place)| *number * (*place - at[0])).sum()
        });
        let largest = bent.iter().map(|of| of.length()).fold(0.0, f64::max);
        if largest * self.area.sqrt() < FLAT {
            return None;
        }
        let corners = [at[0], at[1], at[2]].map_inline(|corner| Vec3A::from(corner.as_vec3()));
        let [x, y, z] = frame(corners)?.map_inline(Vec3::from);
        let forces = std::array::from_fn(|particle| {
            let each = self.curvature.iter().zip(bent);
            let force: DVec3 = each.map(|(of, bent)| stiffness * of[particle] * bent).sum();
            let force = force.as_vec3();
            [x, y, z].map_inline(|axis| force.dot(axis))
        });
        Some(RestFace {
            face,
            particles: self.particles,
            forces,
        })
    }
}

/// The smallest curvature that fits the slopes at the edges, as factors of the six particles: Bᵀ (B Bᵀ + ε)⁻¹ H. `None` where
/// there is no slope.
fn smallest_curvature(slopes: &[[f64; 6]; 3], of_curvature: &[DVec3; 3]) -> Option<[[f64; 6]; 3]> {
    let mut gram = [[0.0; 3]; 3];
    for (row, one) in gram.iter_mut().zip(of_curvature) {
        for (number, other) in row.iter_mut().zip(of_curvature) {
            *number = one.dot(*other);
        }
    }
    let trace = gram[0][0] + gram[1][1] + gram[2][2];
    if trace.is_nan() || trace <= 0.0 {
        return None;
    }
    for (at, row) in gram.iter_mut().enumerate() {
        row[at] += REGULAR * trace / 3.0;
    }
    let inverse = DMat3::from_cols_array_2d(&gram).inverse();
    let mut curvature = [[0.0; 6]; 3];
    for particle in 0..6 {
        let of_edges = inverse * DVec3::from_array(slopes.map_inline(|slope| slope[particle]));
        for (component, of) in curvature.iter_mut().enumerate() {
            of[particle] = (0..3)
                .map(|edge| of_curvature[edge][component] * of_edges[edge])
                .sum();
        }
    }
    Some(curvature)
}
