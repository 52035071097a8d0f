//! Skinned meshes as colliders.

use std::sync::Arc;

use bevy::math::{Affine3A, Vec3};

use super::{DeformingMesh, Topology};
use crate::cloth::Skinning;
#[cfg(feature = "mesh")]
use crate::{
    cloth::{ClothError, JointWeights, same_places},
    contact::colliders::geometry::check_triangles,
};

/// The triangles of a skinned mesh, bound to its joints.
#[derive(Debug)]
pub(crate) struct SkinnedTriangles {
    topology: Arc<Topology>,
    skinning: Skinning,
    /// The joint that moves most of the mesh.
    carrier: usize,
}

impl SkinnedTriangles {
    /// Triangles between vertices at these positions (m), bound by their joints and weights. Vertices at the same position are
    /// merged, and follow the joints of the first.
    ///
    /// # Errors
    /// For vertices or weights that are not valid, and if no triangle has an area.
    #[cfg(feature = "mesh")]
    pub fn new(
        positions: &[Vec3],
        triangles: &[[u32; 3]],
        skin: &[JointWeights],
    ) -> Result<Self, ClothError> {
        check_triangles(positions, triangles)?;
        let (first, merged) = same_places(positions, 0.0);
        let places = first.iter().map(|&vertex| positions[vertex as usize]);
        let places: Vec<Vec3> = places.collect();
        let of = |corners: &[u32; 3]| corners.map(|corner| merged[corner as usize]);
        let bound = |&vertex: &u32| {
            let vertex = vertex as usize;
            let skin = skin.get(vertex).copied().unwrap_or_default();
            (vertex, positions[vertex], skin)
        };
        let skinning = Skinning::of_vertices(first.iter().map(bound))?;
        let topology = Topology::new(&places, triangles.iter().map(of).collect());
        Ok(Self {
            topology: topology.into(),
            carrier: skinning.heaviest_joint(),
            skinning,
        })
    }

    /// The index of the joint that moves most of the mesh.
    pub fn carrier(&self) -> usize {
        self.carrier
    }

    /// Number of joints required.
    pub fn joints(&self) -> usize {
        self.skinning.joints()
    }

    /// The mesh in a tick that begins and ends with these transforms of the joints, from the mesh to the collider's frame:
    /// at least as many as [required](Self::joints). It is one of the `known` of earlier ticks, unless all are still in use.
    pub fn moving(
        &self,
        joints: [&[Affine3A]; 2],
        known: &mut Vec<DeformingMesh>,
    ) -> DeformingMesh {
        let is_mirrored = joints[1]
            .first()
            .is_some_and(|joint| joint.matrix3.determinant() < 0.0);
        let write = |ends: &mut [Vec<Vec3>; 2]| {
            for (places, joints) in ends.iter_mut().zip(joints) {
                self.skinning.places(joints, places);
            }
            is_mirrored
        };
        let free = known.iter_mut().position(|mesh| mesh.write(write));
        let used = free.unwrap_or_else(|| {
            known.push(DeformingMesh::new(&self.topology, write));
            known.len() - 1
        });
        known[used].clone()
    }
}
