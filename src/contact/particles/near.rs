//! Eight particles relative to a ball, a capsule, a box or a half-space.

use crate::cloth::{LANES, Lanes, View, X, Y, Z, larger, smaller};

/// A ball, or a capsule.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Round {
    pub centre: [f32; 3],
    pub axis: [f32; 3],
    /// Half of the axis's length, 0 for a ball (m).
    pub half_length: f32,
    /// Radius of the shape and a particle (m).
    pub reach: f32,
}

/// A box.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cuboid {
    pub centre: [f32; 3],
    pub axes: [[f32; 3]; 3],
    pub half_size: [f32; 3],
    /// Radius of a particle (m).
    pub reach: f32,
}

/// The half-space below a plane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HalfSpace {
    pub centre: [f32; 3],
    pub normal: [f32; 3],
    /// Radius of a particle (m).
    pub reach: f32,
}

/// Eight particles relative to a shape.
pub(crate) struct Near {
    /// Depth inside (m), negative outside.
    pub depth: Lanes,
    /// The largest depth that it may have, where the depth is not known (m).
    pub bound: Lanes,
    /// Direction away from the shape, of any length.
    pub offset: [Lanes; 3],
    pub length: Lanes,
    /// Displacement of the surface there in the sub-step by deformation (m), and the largest of the surface elsewhere that may
    /// come near.
    pub surface: [Lanes; 3],
    pub swing: Lanes,
}

#[inline(always)]
pub(super) fn near_round(view: &View, shape: &Round) -> Near {
    let mut near = Near::NONE;
    let ([cx, cy, cz], [ax, ay, az]) = (shape.centre, shape.axis);
    for l in 0..LANES {
        let (x, y, z) = (view[X + l] - cx, view[Y + l] - cy, view[Z + l] - cz);
        let along = x * ax + y * ay + z * az;
        let along = smaller(along, shape.half_length);
        let along = larger(along, -shape.half_length);
        let (x, y, z) = (x - ax * along, y - ay * along, z - az * along);
        let length = (x * x + y * y + z * z).sqrt();
        near.offset[0][l] = x;
        near.offset[1][l] = y;
        near.offset[2][l] = z;
        near.length[l] = length;
        near.depth[l] = shape.reach - length;
        near.bound[l] = near.depth[l];
    }
    near
}

#[inline(always)]
pub(super) fn near_half_space(view: &View, shape: &HalfSpace) -> Near {
    let mut near = Near::NONE;
    let ([cx, cy, cz], [nx, ny, nz]) = (shape.centre, shape.normal);
    for l in 0..LANES {
        let (x, y, z) = (view[X + l] - cx, view[Y + l] - cy, view[Z + l] - cz);
        near.offset[0][l] = nx;
        near.offset[1][l] = ny;
        near.offset[2][l] = nz;
        near.length[l] = 1.0;
        near.depth[l] = shape.reach - (x * nx + y * ny + z * nz);
        near.bound[l] = near.depth[l];
    }
    near
}

/// Displacement out of a box along an axis: the excess over its face, or 1 inside at the nearest face.
#[inline(always)]
fn outward(over: f32, least: f32, is_in: bool) -> f32 {
    let beyond = if over > 0.0 { over } else { 0.0 };
    let nearest = if over >= least { 1.0 } else { 0.0 };
    if is_in { nearest } else { beyond }
}

#[inline(always)]
pub(super) fn near_cuboid(view: &View, shape: &Cuboid) -> Near {
    let mut near = Near::NONE;
    let [cx, cy, cz] = shape.centre;
    let [u, v, w] = shape.axes;
    let [hu, hv, hw] = shape.half_size;
    for l in 0..LANES {
        let (x, y, z) = (view[X + l] - cx, view[Y + l] - cy, view[Z + l] - cz);
        let a = x * u[0] + y * u[1] + z * u[2];
        let b = x * v[0] + y * v[1] + z * v[2];
        let c = x * w[0] + y * w[1] + z * w[2];
        let (over_a, over_b, over_c) = (a.abs() - hu, b.abs() - hv, c.abs() - hw);
        let largest = larger(larger(over_a, over_b), over_c);
        // Outside, the excess over each face counts; inside, only the nearest face.
        let least = if largest > 0.0 { 0.0 } else { largest };
        let is_in = largest <= 0.0;
        let pa = outward(over_a, least, is_in).copysign(a);
        let pb = outward(over_b, least, is_in).copysign(b);
        let pc = outward(over_c, least, is_in).copysign(c);
        let length = (pa * pa + pb * pb + pc * pc).sqrt();
        near.offset[0][l] = u[0] * pa + v[0] * pb + w[0] * pc;
        near.offset[1][l] = u[1] * pa + v[1] * pb + w[1] * pc;
        near.offset[2][l] = u[2] * pa + v[2] * pb + w[2] * pc;
        near.length[l] = length;
        let distance = if is_in { largest } else { length };
        near.depth[l] = shape.reach - distance;
        near.bound[l] = near.depth[l];
    }
    near
}

impl Near {
    /// The displacement of the surface at a lane, where a rigid shape's is `rigid` (m).
    #[inline(always)]
    pub fn on_surface<const DEFORMS: bool>(&self, l: usize, [x, y, z]: [f32; 3]) -> [f32; 3] {
        if DEFORMS {
            let [sx, sy, sz] = [self.surface[0][l], self.surface[1][l], self.surface[2][l]];
            [x + sx, y + sy, z + sz]
        } else {
            [x, y, z]
        }
    }

    pub const NONE: Self = Self {
        depth: [0.0; LANES],
        bound: [0.0; LANES],
        offset: [[0.0; LANES]; 3],
        length: [0.0; LANES],
        surface: [[0.0; LANES]; 3],
        swing: [0.0; LANES],
    };
}
