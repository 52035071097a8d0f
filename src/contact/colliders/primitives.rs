//! Conversions from Bevy's primitives.

use bevy::math::{
    Vec2, Vec3,
    primitives::{
        Capsule3d, Cone, ConicalFrustum, Cuboid, Cylinder, Extrusion, InfinitePlane3d, Rectangle,
        Sphere, Tetrahedron, Triangle3d,
    },
};

use parry3d::shape::SharedShape;

use super::collider::ClothCollider;

impl From<Sphere> for ClothCollider {
    fn from(sphere: Sphere) -> Self {
        Self::ball(sphere.radius)
    }
}

impl From<Capsule3d> for ClothCollider {
    fn from(capsule: Capsule3d) -> Self {
        Self::Capsule {
            radius: capsule.radius,
            half_length: capsule.half_length,
        }
    }
}

impl From<Cuboid> for ClothCollider {
    fn from(cuboid: Cuboid) -> Self {
        Self::Cuboid {
            half_size: cuboid.half_size,
        }
    }
}

impl From<Cylinder> for ClothCollider {
    fn from(cylinder: Cylinder) -> Self {
        Self::Cylinder {
            radius: cylinder.radius,
            half_height: cylinder.half_height,
        }
    }
}

impl From<Cone> for ClothCollider {
    fn from(cone: Cone) -> Self {
        Self::cone(cone.radius, cone.height)
    }
}

/// Becomes the convex hull of two circles of 48 points.
impl From<ConicalFrustum> for ClothCollider {
    fn from(frustum: ConicalFrustum) -> Self {
        let ring = |radius: f32, height: f32| {
            (0..48_u8).map(move |point| {
                let angle = f32::from(point) * std::f32::consts::TAU / 48.0;
                let place = Vec2::from_angle(angle) * radius;
                Vec3::new(place.x, height, place.y)
            })
        };
        let half = frustum.height / 2.0;
        let rings = ring(frustum.radius_top, half).chain(ring(frustum.radius_bottom, -half));
        Self::convex_hull(rings.collect::<Vec<Vec3>>())
    }
}

impl From<Tetrahedron> for ClothCollider {
    fn from(tetrahedron: Tetrahedron) -> Self {
        Self::convex_hull(tetrahedron.vertices)
    }
}

/// Becomes a sheet with two sides.
impl From<Triangle3d> for ClothCollider {
    fn from(triangle: Triangle3d) -> Self {
        Self::trimesh(triangle.vertices, [[0, 1, 2]])
    }
}

/// Becomes the half-space below it.
impl From<InfinitePlane3d> for ClothCollider {
    fn from(plane: InfinitePlane3d) -> Self {
        let normal = Vec3::from(plane.normal);
        if normal == Vec3::Y {
            return Self::plane();
        }
        Self::parry(SharedShape::halfspace(normal))
    }
}

/// Becomes a box.
impl From<Extrusion<Rectangle>> for ClothCollider {
    fn from(extrusion: Extrusion<Rectangle>) -> Self {
        Self::Cuboid {
            half_size: extrusion.base_shape.half_size.extend(extrusion.half_depth),
        }
    }
}
