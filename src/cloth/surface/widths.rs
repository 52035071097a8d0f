//! How wide the triangles around a particle are.

use std::f32::consts::SQRT_2;

use bevy::math::Vec3;

use super::Surface;

impl Surface {
    /// The width of the widest triangle that each particle owns (m), 0 if it owns none: the spacing of a square grid whose
    /// triangles are as wide.
    pub(crate) fn face_widths(&self) -> &[f32] {
        self.derived.face_widths.get_or_init(|| {
            let faces = self.faces();
            let widest = |owner: u32| {
                let owned = faces.of(owner).iter();
                let widths = owned.map(|face| width(face.map(|at| self.rest[at as usize])));
                widths.fold(0.0, f32::max)
            };
            (0..self.len() as u32).map(widest).collect()
        })
    }
}

/// √2 times the radius of the smallest circle around a triangle (m). With corners outside of a ball of radius R it dips into the ball
/// by at most R − √(R² − r²), for a circle of radius r: the point where it is deepest is the foot of the ball's centre, and of
/// the corners of the triangle or edge that it is inside of, one is within r.
fn width([a, b, c]: [Vec3; 3]) -> f32 {
    let mut sides = [
        a.distance_squared(b),
        b.distance_squared(c),
        c.distance_squared(a),
    ];
    sides.sort_unstable_by(f32::total_cmp);
    let [p, q, longest] = sides;
    let square = if p + q <= longest {
        longest / 4.0
    } else {
        // (abc/4A)², and 16 A² by Heron.
        p * q * longest / (4.0 * p * q - (p + q - longest).powi(2))
    };
    SQRT_2 * square.sqrt()
}

#[cfg(test)]
mod tests {
    use bevy::math::DVec3;

    use super::*;
    use crate::{cloth::Cloth, meshes};

    /// The triangles of a square grid are as wide as its spacing; those of other shapes are as wide as their circles say.
    #[test]
    fn a_width_is_the_spacing_of_a_square_grid() {
        let grid = Cloth::new(4, 3, 0.25).surface(Vec3::ONE).expect("a grid");
        let places = grid.rest_positions().iter().copied();
        let mesh = Cloth::triangles(places, grid.triangles().iter().copied());
        let mesh = mesh.surface(Vec3::ONE).expect("a mesh");
        let owners = (0..12).filter(|owner| !mesh.faces().of(*owner).is_empty());
        for owner in owners {
            assert!((mesh.face_widths()[owner as usize] - 0.25).abs() < 1.0e-6);
        }
        let equilateral = [Vec3::ZERO, Vec3::X, Vec3::new(0.5, 0.75_f32.sqrt(), 0.0)];
        assert!((width(equilateral) - (2.0_f32 / 3.0).sqrt()).abs() < 1.0e-6);
        let flat = [Vec3::ZERO, Vec3::X, Vec3::new(0.4, 0.01, 0.0)];
        assert!((width(flat) - 0.5_f32.sqrt()).abs() < 1.0e-6);
    }

    /// No triangle dips deeper into a ball than its width says, wherever the ball is. Its deepest point is found among many, in f64.
    #[test]
    fn no_triangle_dips_deeper_than_its_width_says() {
        let mesh = meshes::irregular(0.9, 0.7, 0.1, 0.4);
        let mesh = Surface::of_mesh(&mesh, 1.0e-5, Vec3::ONE).expect("a mesh");
        let mut deepest = 0.0_f64;
        for (index, face) in mesh.triangles().iter().enumerate() {
            let corners = face.map(|at| mesh.rest_positions()[at as usize]);
            let (wide, [a, b, c]) = (f64::from(width(corners)), corners.map(Vec3::as_dvec3));
            let samples = || (0..=20).flat_map(|i| (0..=20 - i).map(move |j| (i, j)));
            let points: Vec<DVec3> = samples()
                .map(|(i, j)| a + (f64::from(i) * (b - a) + f64::from(j) * (c - a)) / 20.0)
                .collect();
            let nearest = |point: &DVec3| {
                let squares = [a, b, c].map(|corner: DVec3| corner.distance_squared(*point));
                squares.into_iter().fold(f64::INFINITY, f64::min)
            };
            // A ball's centre above the point that is farthest from the corners, or any other.
            let farthest = points
                .iter()
                .max_by(|p, q| nearest(p).total_cmp(&nearest(q)));
            let foot = match index % 2 {
                0 => *farthest.expect("there are points"),
                _ => points[index * 7 % points.len()],
            };
            let normal = (b - a).cross(c - a).normalize();
            for radius in [0.8, 1.0, 1.5, 3.0].map(|part| part * wide) {
                let height = radius * radius - nearest(&foot);
                let centre = foot + normal * height.max(0.0).sqrt();
                let dip = points.iter().map(|point| radius - point.distance(centre));
                let dip = dip.fold(0.0, f64::max) / radius;
                let circle = wide / std::f64::consts::SQRT_2;
                let most = 1.0 - (1.0 - (circle / radius).powi(2)).sqrt();
                assert!(dip <= most + 1.0e-6, "{index}: {dip} of {most} at {radius}");
                deepest = deepest.max(dip / most);
            }
        }
        assert!(deepest > 0.95, "no test of the bound: {deepest}");
    }
}
