//! Converts shapes of parry into parts of a geometry.

use bevy::math::Vec3;
use parry3d::{
    math::Pose,
    shape::{SharedShape, Triangle, TypedShape},
};

use super::{
    edges::SharpEdge,
    mesh::{self, Triangles},
    solid::{HALF_SHEET, MeshSides, Solid, SolidKind},
};
use crate::cloth::{ClothError, MeshError, ShapeError};

/// Number of flat sides of a round shape for tests against triangles. Its edges lie on the shape, and its flat sides at
/// most 0.2 % of the radius below.
const SIDES: u32 = 48;

/// The solids and the edges of a shape under construction.
#[derive(Debug, Default, Clone)]
pub(crate) struct Parts {
    pub(super) solids: Vec<Solid>,
    pub(super) edges: Vec<SharpEdge>,
}

impl Parts {
    /// Adds triangles as a mesh, or as ground with everything below.
    ///
    /// # Errors
    /// If they do not form a mesh.
    pub fn add_mesh(
        &mut self,
        pose: Pose,
        triangles: Triangles,
        is_ground: bool,
    ) -> Result<(), ClothError> {
        let (mesh, sides, edges) = mesh::build(triangles, is_ground)?;
        self.add_solid(pose, SolidKind::Mesh(mesh.into(), sides));
        self.add_edges(pose, &edges, 0.0);
        Ok(())
    }

    fn add_solid(&mut self, pose: Pose, kind: SolidKind) {
        let bounds = match &kind {
            SolidKind::Convex(shape) => shape.compute_aabb(&pose),
            SolidKind::Mesh(mesh, _) => mesh.aabb(&pose),
        };
        // The ground reaches as deep as it is wide, for particles that have got below it.
        let extents = bounds.extents();
        let below = match &kind {
            SolidKind::Mesh(_, MeshSides::Ground) => Vec3::Y * extents.x.max(extents.z),
            _ => Vec3::ZERO,
        };
        self.solids.push(Solid {
            pose,
            bounds: [bounds.mins - below, bounds.maxs],
            kind,
        });
    }

    /// Adds the closed mesh of a convex shape.
    ///
    /// # Errors
    /// [`ShapeError::FlatHull`] if it has no volume.
    fn add_hull(&mut self, pose: Pose, triangles: Triangles) -> Result<(), ClothError> {
        let points = triangles.0.len();
        let (mesh, sides, edges) = mesh::build(triangles, false)?;
        let size = mesh.local_aabb().extents().as_dvec3().max_element();
        if sides != MeshSides::Closed
            || mesh::volume(mesh.vertices(), mesh.indices()) <= 1.0e-9 * size.powi(3)
        {
            return Err(ShapeError::FlatHull { points }.into());
        }
        self.add_solid(pose, SolidKind::Mesh(mesh.into(), sides));
        self.add_edges(pose, &edges, 0.0);
        Ok(())
    }

    /// Adds the convex hull of points.
    ///
    /// # Errors
    /// [`ShapeError::FlatHull`] of points in one plane, [`MeshError::VertexNotFinite`].
    pub fn add_hull_of(&mut self, points: &[Vec3]) -> Result<(), ClothError> {
        MeshError::check_vertices(points, Vec3::ONE)?;
        let flat = ClothError::Shape(ShapeError::FlatHull {
            points: points.len(),
        });
        if are_flat(points) {
            return Err(flat);
        }
        let hull = parry3d::transformation::try_convex_hull(points).map_err(|_| flat)?;
        self.add_hull(Pose::IDENTITY, hull)
    }

    fn add_line(&mut self, pose: Pose, shape: SharedShape, ends: [Vec3; 2], radius: f32) {
        self.add_solid(pose, SolidKind::Convex(shape));
        let line = SharpEdge {
            ends,
            outward: Vec3::ZERO,
            radius,
            round: 0.0,
            part: 1.0,
        };
        self.add_edges(pose, &[line], 0.0);
    }

    fn add_edges(&mut self, pose: Pose, edges: &[SharpEdge], radius: f32) {
        self.edges.extend(edges.iter().map(|edge| SharpEdge {
            ends: edge.ends.map(|end| pose.transform_point(end)),
            outward: pose.rotation * edge.outward,
            radius: edge.radius + radius,
            ..*edge
        }));
    }

    /// Adds other parts with a pose.
    pub fn add_parts(&mut self, pose: Pose, parts: Self) {
        let Self { solids, edges } = parts;
        self.add_edges(pose, &edges, 0.0);
        for solid in solids {
            self.add_solid(pose * solid.pose, solid.kind);
        }
    }

    /// Adds a shape of parry with a pose.
    ///
    /// # Errors
    /// [`ShapeError::NoSuchShape`] for lines, for a half-space in a compound, and for custom shapes; errors of its
    /// triangles.
    pub fn add(&mut self, pose: Pose, shared: &SharedShape) -> Result<(), ClothError> {
        let shape = shared.clone();
        // Adds a convex shape, given by triangles on it or in it, and its radius around those (m).
        let mut round = |inner: Triangles, radius: f32| -> Result<(), ClothError> {
            let (.., edges) = mesh::build(inner, false)?;
            self.add_solid(pose, SolidKind::Convex(shared.clone()));
            self.add_edges(pose, &edges, radius);
            Ok(())
        };
        match shared.as_typed_shape() {
            TypedShape::Ball(ball) => self.add_line(pose, shape, [Vec3::ZERO; 2], ball.radius),
            TypedShape::Capsule(capsule) => {
                let ends = [capsule.segment.a, capsule.segment.b];
                self.add_line(pose, shape, ends, capsule.radius);
            }
            TypedShape::Segment(line) => {
                let thin = SharedShape::capsule(line.a, line.b, HALF_SHEET);
                self.add_line(pose, thin, [line.a, line.b], HALF_SHEET);
            }
            TypedShape::Triangle(triangle) => {
                let corners = vec![triangle.a, triangle.b, triangle.c];
                self.add_mesh(pose, (corners, vec![[0, 1, 2]]), false)?;
            }
            TypedShape::Voxels(voxels) => self.add_mesh(pose, voxels.to_trimesh(), false)?,
            TypedShape::TriMesh(mesh) => {
                let triangles = (mesh.vertices().to_vec(), mesh.indices().to_vec());
                self.add_mesh(pose, triangles, false)?;
            }
            TypedShape::HeightField(field) => {
                let cells = (field.nrows(), field.ncols());
                let (vertices, mut triangles) = field.to_trimesh();
                let is_whole = triangles.len() == 2 * cells.0 * cells.1;
                turn_up(&vertices, &mut triangles);
                self.add_mesh(pose, (vertices, triangles), is_whole)?;
            }
            TypedShape::Compound(compound) => {
                for (offset, part) in compound.shapes() {
                    self.add(pose * *offset, part)?;
                }
            }
            TypedShape::ConvexPolyhedron(hull) => self.add_hull(pose, hull.to_trimesh())?,
            TypedShape::Cuboid(cuboid) => round(cuboid.to_trimesh(), 0.0)?,
            TypedShape::Cylinder(cylinder) => {
                let (.., mut edges) = mesh::build(cylinder.to_trimesh(SIDES), false)?;
                for edge in edges.iter_mut().filter(|edge| is_upright(edge)) {
                    (edge.round, edge.part) = (cylinder.radius, 1.0);
                }
                self.add_solid(pose, SolidKind::Convex(shape));
                self.add_edges(pose, &edges, 0.0);
            }
            TypedShape::Cone(cone) => {
                let (.., edges) = mesh::build(cone.to_trimesh(SIDES), false)?;
                self.add_solid(pose, SolidKind::Convex(shape));
                self.add_edges(pose, &in_pieces(&edges, cone.radius), 0.0);
            }
            TypedShape::RoundCuboid(of) => round(of.inner_shape.to_trimesh(), of.border_radius)?,
            TypedShape::RoundTriangle(of) => {
                let Triangle { a, b, c } = of.inner_shape;
                round((vec![a, b, c], vec![[0, 1, 2]]), of.border_radius)?;
            }
            TypedShape::RoundCylinder(of) => {
                round(of.inner_shape.to_trimesh(SIDES), of.border_radius)?;
            }
            TypedShape::RoundCone(of) => round(of.inner_shape.to_trimesh(SIDES), of.border_radius)?,
            TypedShape::RoundConvexPolyhedron(of) => {
                round(of.inner_shape.to_trimesh(), of.border_radius)?;
            }
            TypedShape::Polyline(_) | TypedShape::HalfSpace(_) | TypedShape::Custom(_) => {
                return Err(ClothError::Shape(ShapeError::NoSuchShape {
                    shape: format!("{:?}", shared.shape_type()),
                }));
            }
        }
        Ok(())
    }
}

/// Whether an edge runs along the side of a cylinder or cone, and not around it.
fn is_upright(edge: &SharpEdge) -> bool {
    let [a, b] = edge.ends;
    a.y != b.y
}

/// The edges of a cone of `radius` (m), those along its side in pieces: at the upper end of each, the cone is half as wide as at the
/// lower. Where it is narrow, some of them are left out, and its flat sides are again at most 0.2 % of the radius below.
fn in_pieces(edges: &[SharpEdge], radius: f32) -> Vec<SharpEdge> {
    let (side, mut pieces): (Vec<SharpEdge>, Vec<SharpEdge>) =
        edges.iter().partition(|edge| is_upright(edge));
    for (index, edge) in side.into_iter().enumerate() {
        let [a, b] = edge.ends;
        let (base, tip) = if a.y < b.y { (a, b) } else { (b, a) };
        let mut wide = 1.0;
        for (piece, each) in [1, 1, 2, 2, 4].into_iter().enumerate() {
            let narrow = if piece == 4 { 0.0 } else { wide / 2.0 };
            if index % each == 0 {
                pieces.push(SharpEdge {
                    ends: [tip.lerp(base, wide), tip.lerp(base, narrow)],
                    round: narrow * radius,
                    part: 1.0,
                    ..edge
                });
            }
            wide = narrow;
        }
    }
    pieces
}

/// Turns the triangles of a height field so that their normals point up.
pub(crate) fn turn_up(vertices: &[Vec3], triangles: &mut [[u32; 3]]) {
    for triangle in triangles {
        let [a, b, c] = triangle.map(|corner| vertices[corner as usize]);
        if (b - a).cross(c - a).y < 0.0 {
            triangle.swap(1, 2);
        }
    }
}

/// Whether points lie in one plane, with a tolerance of 10⁻⁵ of their extent.
fn are_flat(points: &[Vec3]) -> bool {
    let Some(&first) = points.first() else {
        return true;
    };
    let farthest = |measure: &dyn Fn(Vec3) -> f64| {
        let mut best = (0.0, first);
        for &point in points {
            let measured = measure(point);
            if measured > best.0 {
                best = (measured, point);
            }
        }
        best
    };
    let from = |point: Vec3| point.as_dvec3() - first.as_dvec3();
    let (size, second) = farthest(&|point| from(point).length());
    let along = from(second).normalize_or_zero();
    let (width, third) = farthest(&|point| from(point).cross(along).length());
    let normal = along.cross(from(third)).normalize_or_zero();
    let (height, _) = farthest(&|point| from(point).dot(normal).abs());
    width <= 1.0e-5 * size || height <= 1.0e-5 * size
}
