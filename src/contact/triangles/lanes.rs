//! Tests eight triangles against a ball, in plain loops that the compiler vectorises.

use std::f32::consts::PI;

use bevy::math::Vec3;

use crate::{
    cloth::{DX, DY, DZ, LANES, Lanes, Layout, MapInline, View, W, X, Y, Z, larger, smaller},
    contact::{
        colliders::cap,
        particles::{LaneMotion, Sums},
    },
};

/// Largest push of a corner, relative to that of the triangle's point. With free corners and the masses of a grid, up
/// to four times each other's, it is at most 2.0.
pub(crate) const MAX_SHARE: f32 = 2.0;

/// Constants for all blocks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cells {
    pub layout: Layout,
    pub centre: [f32; 3],
    /// Radius of the ball and a particle (m).
    pub reach: f32,
    /// Largest displacement of anything in the sub-step, relative to the ball (m).
    pub fastest: f32,
    /// Largest push of particles in earlier passes (m).
    pub pushed: f32,
    /// Largest push before candidates may be missing (m), and the number of triangles that may push each particle.
    pub clearance: f32,
    pub max_faces: f32,
    /// Whether areas are wanted.
    pub is_measured: bool,
}

/// The nearest points of eight triangles to a point.
pub(crate) struct Nearest {
    /// Weights of the second and the third corner at the nearest point.
    pub parts: [Lanes; 2],
    /// Vector from the point (m).
    pub offset: [Lanes; 3],
    pub distance: Lanes,
    /// Twice the areas of the parts into which a point of the plane divides a triangle, times twice its own, and their
    /// sum.
    pub areas: [Lanes; 3],
    pub sum: Lanes,
    /// Squared lengths of the edges opposite the corners (m²).
    pub edges: [Lanes; 3],
    /// The smallest squared distance of a corner (m²).
    pub corner: Lanes,
}

impl Nearest {
    const NONE: Self = Self {
        parts: [[0.0; LANES]; 2],
        offset: [[0.0; LANES]; 3],
        distance: [0.0; LANES],
        areas: [[0.0; LANES]; 3],
        sum: [0.0; LANES],
        edges: [[0.0; LANES]; 3],
        corner: [0.0; LANES],
    };
}

/// From one corner to another, in a lane (m).
#[inline(always)]
fn between(a: &View, b: &View, l: usize) -> [f32; 3] {
    [X, Y, Z].map_inline(|axis| b[axis + l] - a[axis + l])
}

/// The nearest points of eight triangles, by their Voronoi regions (Ericson 2005, chapter 5).
#[inline(always)]
pub(crate) fn nearest_of_each(a: &View, b: &View, c: &View, [px, py, pz]: [f32; 3]) -> Nearest {
    let mut near = Nearest::NONE;
    for l in 0..LANES {
        let ([bx, by, bz], [cx, cy, cz]) = (between(a, b, l), between(a, c, l));
        let (x, y, z) = (px - a[X + l], py - a[Y + l], pz - a[Z + l]);
        let near_a = x * x + y * y + z * z;
        let d1 = bx * x + by * y + bz * z;
        let d2 = cx * x + cy * y + cz * z;
        let bb = bx * bx + by * by + bz * bz;
        let cc = cx * cx + cy * cy + cz * cz;
        let bc = bx * cx + by * cy + bz * cz;
        let (d3, d4) = (d1 - bb, d2 - bc);
        let (d5, d6) = (d1 - bc, d2 - cc);
        let of_c = d1 * d4 - d3 * d2;
        let of_b = d5 * d2 - d1 * d6;
        let of_a = d3 * d6 - d5 * d4;
        let sum = of_a + of_b + of_c;
        let (to_c, to_b) = (d4 - d3, d5 - d6);
        // The face, then the regions that take precedence: edges, and corners.
        let (v, w, whole) = (of_b, of_c, sum);
        let is_bc = (of_a <= 0.0) & (to_c >= 0.0) & (to_b >= 0.0);
        let v = if is_bc { to_b } else { v };
        let w = if is_bc { to_c } else { w };
        let whole = if is_bc { to_b + to_c } else { whole };
        let is_ac = (of_b <= 0.0) & (d2 >= 0.0) & (d6 <= 0.0);
        let v = if is_ac { 0.0 } else { v };
        let w = if is_ac { d2 } else { w };
        let whole = if is_ac { d2 - d6 } else { whole };
        let is_c = (d6 >= 0.0) & (d5 <= d6);
        let v = if is_c { 0.0 } else { v };
        let w = if is_c { 1.0 } else { w };
        let whole = if is_c { 1.0 } else { whole };
        let is_ab = (of_c <= 0.0) & (d1 >= 0.0) & (d3 <= 0.0);
        let v = if is_ab { d1 } else { v };
        let w = if is_ab { 0.0 } else { w };
        let whole = if is_ab { d1 - d3 } else { whole };
        let is_b = (d3 >= 0.0) & (d4 <= d3);
        let v = if is_b { 1.0 } else { v };
        let w = if is_b { 0.0 } else { w };
        let whole = if is_b { 1.0 } else { whole };
        let is_a = (d1 <= 0.0) & (d2 <= 0.0);
        let v = if is_a { 0.0 } else { v };
        let w = if is_a { 0.0 } else { w };
        let whole = if is_a { 1.0 } else { whole };
        let inverse = 1.0 / whole;
        let (v, w) = (v * inverse, w * inverse);
        let (x, y, z) = (
            v * bx + w * cx - x,
            v * by + w * cy - y,
            v * bz + w * cz - z,
        );
        near.parts[0][l] = v;
        near.parts[1][l] = w;
        near.offset[0][l] = x;
        near.offset[1][l] = y;
        near.offset[2][l] = z;
        near.distance[l] = (x * x + y * y + z * z).sqrt();
        near.areas[0][l] = of_a;
        near.areas[1][l] = of_b;
        near.areas[2][l] = of_c;
        near.sum[l] = sum;
        let to_b = near_a - 2.0 * d1 + bb;
        let to_c = near_a - 2.0 * d2 + cc;
        near.corner[l] = smaller(smaller(near_a, to_b), to_c);
        near.edges[0][l] = bb + cc - 2.0 * bc;
        near.edges[1][l] = cc;
        near.edges[2][l] = bb;
    }
    near
}

/// Displacement of the fastest corner of each triangle relative to the ball (m).
#[inline(always)]
pub(crate) fn speeds(corners: [&View; 3], [sx, sy, sz]: [f32; 3]) -> Lanes {
    let mut fastest = [0.0_f32; LANES];
    for view in corners {
        for l in 0..LANES {
            let (x, y, z) = (view[DX + l] - sx, view[DY + l] - sy, view[DZ + l] - sz);
            let square = x * x + y * y + z * z;
            fastest[l] = larger(square, fastest[l]);
        }
    }
    fastest.map_inline(f32::sqrt)
}

/// The pushes of eight triangles.
pub(crate) struct CornerPushes {
    pub normal: [Lanes; 3],
    /// Displacement of the point along the normal, and the part of it that becomes momentum (m).
    pub far: Lanes,
    pub stopped: Lanes,
    pub shares: [Lanes; 3],
}

/// Computes the pushes of penetrating triangles, and adds to the sums.
#[inline(always)]
pub(crate) fn pushes(
    corners: [&View; 3],
    near: &Nearest,
    is_pushed: &[bool; LANES],
    motion: &LaneMotion,
    cells: &Cells,
    sums: &mut Sums,
) -> CornerPushes {
    let zero = [0.0; LANES];
    let mut pushes = CornerPushes {
        normal: [zero; 3],
        far: zero,
        stopped: zero,
        shares: [zero; 3],
    };
    let [a, b, c] = corners;
    let radius = cells.reach - motion.particle_radius;
    let mut farthest = [0.0_f32; LANES];
    for l in 0..LANES {
        let (v, w) = (near.parts[0][l], near.parts[1][l]);
        let u = 1.0 - v - w;
        let (part_a, part_b, part_c) = (u * a[W + l], v * b[W + l], w * c[W + l]);
        let mobility = u * part_a + v * part_b + w * part_c;
        let largest = larger(larger(part_a, part_b), part_c);
        // A corner with a tiny weight beside pins cannot make up for them: it would be thrown away.
        let least = largest / MAX_SHARE;
        let mobility = larger(mobility, least);
        let is_pushed = is_pushed[l] & (mobility > 0.0);
        let distance = near.distance[l];
        let [x, y, z] = &near.offset;
        let (nx, ny, nz) = (x[l] / distance, y[l] / distance, z[l] / distance);
        let (ax, ay, az) = (nx * radius, ny * radius, nz * radius);
        let [mx, my, mz] = motion.of_surface([ax, ay, az]);
        let rx = u * a[DX + l] + v * b[DX + l] + w * c[DX + l] - mx;
        let ry = u * a[DY + l] + v * b[DY + l] + w * c[DY + l] - my;
        let rz = u * a[DZ + l] + v * b[DZ + l] + w * c[DZ + l] - mz;
        let apart = nx * rx + ny * ry + nz * rz;
        let depth = cells.reach - distance;
        let (stopped, released) = motion.push_out.of_lane(depth, apart);
        let far = if is_pushed { stopped + released } else { 0.0 };
        let stopped = if is_pushed { stopped } else { 0.0 };
        let nx = if is_pushed { nx } else { 0.0 };
        let ny = if is_pushed { ny } else { 0.0 };
        let nz = if is_pushed { nz } else { 0.0 };
        let share_a = if is_pushed { part_a / mobility } else { 0.0 };
        let share_b = if is_pushed { part_b / mobility } else { 0.0 };
        let share_c = if is_pushed { part_c / mobility } else { 0.0 };
        pushes.normal[0][l] = nx;
        pushes.normal[1][l] = ny;
        pushes.normal[2][l] = nz;
        pushes.far[l] = far;
        pushes.stopped[l] = stopped;
        pushes.shares[0][l] = share_a;
        pushes.shares[1][l] = share_b;
        pushes.shares[2][l] = share_c;
        let share = larger(larger(share_a, share_b), share_c);
        farthest[l] = far * share;
        let depth = if is_pushed { depth } else { 0.0 };
        sums.deepest[l] = larger(depth, sums.deepest[l]);
    }
    sums.passed = farthest.into_iter().fold(sums.passed, f32::max);
    pushes
}

/// Moves a corner of each triangle. Adds its impulse on the ball.
#[inline(always)]
pub(crate) fn move_corner(
    view: &mut View,
    share: &Lanes,
    pushes: &CornerPushes,
    motion: &LaneMotion,
    sums: &mut Sums,
) -> [Lanes; 3] {
    let mut momentum = [[0.0; LANES]; 3];
    let [ox, oy, oz] = motion.origin;
    for l in 0..LANES {
        let share = share[l];
        let (far, stopped) = (pushes.far[l] * share, pushes.stopped[l] * share);
        let normal = &pushes.normal;
        let (nx, ny, nz) = (normal[0][l], normal[1][l], normal[2][l]);
        let (mx, my, mz) = (nx * stopped, ny * stopped, nz * stopped);
        view[X + l] += nx * far;
        view[Y + l] += ny * far;
        view[Z + l] += nz * far;
        view[DX + l] += mx;
        view[DY + l] += my;
        view[DZ + l] += mz;
        momentum[0][l] = mx;
        momentum[1][l] = my;
        momentum[2][l] = mz;
        let mass = if share > 0.0 { 1.0 / view[W + l] } else { 0.0 };
        let given = [-mx * mass, -my * mass, -mz * mass];
        let x = if share > 0.0 { view[X + l] - ox } else { 0.0 };
        let y = if share > 0.0 { view[Y + l] - oy } else { 0.0 };
        let z = if share > 0.0 { view[Z + l] - oz } else { 0.0 };
        sums.give(l, given, [x, y, z]);
    }
    momentum
}

/// Area of a circle of a radius (m) beyond a line whose distance from the centre is `inside` (m), in m²:
/// `r² acos(s/r) − s √(r² − s²)`. The arc cosine is a polynomial (Abramowitz and Stegun 4.4.45), with an error of 7·10⁻⁵.
#[inline(always)]
fn beyond(inside: f32, radius: f32, square: f32) -> f32 {
    let inside = larger(smaller(inside, radius), -radius);
    let part = if radius > 0.0 { inside / radius } else { 1.0 };
    let size = part.abs();
    let arc = (1.0 - size).sqrt()
        * (1.570_728_8 + size * (-0.212_114_4 + size * (0.074_261 - 0.018_729_3 * size)));
    let arc = if part < 0.0 { PI - arc } else { arc };
    let chord = square - inside * inside;
    let chord = if chord > 0.0 { chord.sqrt() } else { 0.0 };
    square * arc - inside * chord
}

/// Adds the penetrating area (m²) of each pushed triangle, and ∫ depth dA over it (m³): the circle in which the ball
/// cuts its plane, less the parts beyond each edge. Returns the lanes left out, where parts beyond two edges overlap:
/// triangles with corners inside the ball, and with a circle's centre far outside.
#[inline(always)]
pub(crate) fn areas(
    near: &Nearest,
    is_pushed: &[bool; LANES],
    reach: f32,
    sums: &mut Sums,
) -> [bool; LANES] {
    let mut crosses = [false; LANES];
    for l in 0..LANES {
        let normal = near.sum[l].sqrt();
        // Distance of the ball's projected centre inside each edge.
        let a = near.areas[0][l] / (normal * near.edges[0][l].sqrt());
        let b = near.areas[1][l] / (normal * near.edges[1][l].sqrt());
        let c = near.areas[2][l] / (normal * near.edges[2][l].sqrt());
        let least = smaller(smaller(a, b), c);
        let outside = smaller(least, 0.0);
        let distance = near.distance[l];
        let height = distance * distance - outside * outside;
        let height = if height > 0.0 { height.sqrt() } else { 0.0 };
        let square = larger(reach * reach - height * height, 0.0);
        let radius = square.sqrt();
        let segments =
            beyond(a, radius, square) + beyond(b, radius, square) + beyond(c, radius, square);
        let area = larger(square * PI - segments, 0.0);
        let is_left = (near.corner[l] < reach * reach) | (least < -0.25 * radius);
        let area = if is_pushed[l] & !is_left { area } else { 0.0 };
        sums.area[l] += area;
        sums.volume[l] += area * (reach - height) * 0.5;
        crosses[l] = is_pushed[l] & is_left;
    }
    crosses
}

/// Adds the area of a triangle in a lane.
#[cold]
#[inline(never)]
pub(crate) fn add_area(corners: [&View; 3], lane: usize, cells: &Cells, sums: &mut Sums) {
    let corners =
        corners.map_inline(|view| Vec3::new(view[X + lane], view[Y + lane], view[Z + lane]));
    let (area, volume) = cap(corners, cells.centre.into(), cells.reach);
    sums.area[lane] += area;
    sums.volume[lane] += volume;
}
