//! Linear blend skinning of particles and vertices.

use bevy::{
    ecs::entity::Entity,
    math::{Affine3A, Vec3, Vec3A},
    reflect::Reflect,
};
use thiserror::Error;

use crate::cloth::surface::JointWeights;
#[cfg(feature = "mesh")]
use crate::cloth::surface::Surface;

/// The reason why a skinned mesh can't follow its joints.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[type_path = "bevy_drape"]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum SkinError {
    /// A skinned mesh has a joint weight that is negative or not finite.
    #[error("the joint weights of vertex {vertex} must be finite and not negative: {weights:?}")]
    Weights {
        /// Index of the vertex.
        vertex: usize,
        /// Its weights.
        weights: [f32; 4],
    },
    /// A skinned mesh has no joint indices and weights, or its vertices name joints that do not exist.
    #[error(
        "the mesh needs joint indices and weights for each vertex, and {needed} joints with inverse bind poses, but there are {joints}"
    )]
    MissingJoints {
        /// Number of joints that the vertices name.
        needed: usize,
        /// Number of joints that exist.
        joints: usize,
    },
    /// A joint of a skinned mesh does not exist, or its transform is not finite.
    #[error("joint {joint} of the skin, {entity}, must exist and have a finite global transform")]
    Joint {
        /// Index of the joint.
        joint: usize,
        /// Its entity.
        entity: Entity,
    },
}

/// Linear blend skinning of a surface's particles, in the mesh's metres, before any scale.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct Skinning {
    particles: Vec<Bound>,
    joints: usize,
}

/// The binding of one particle.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
struct Bound {
    place: Vec3A,
    normal: Vec3A,
    skin: JointWeights,
}

impl Skinning {
    /// Binds a surface's particles by the vertices of its mesh: their positions (m), joints and weights. A particle
    /// takes the skin of its first vertex. Weights are normalized; a vertex without weights follows the first joint.
    ///
    /// # Errors
    /// [`SkinError::Weights`] for the first vertex whose weights are negative or not finite.
    #[cfg(feature = "mesh")]
    pub fn new(
        surface: &Surface,
        places: &[Vec3],
        skin: &[JointWeights],
    ) -> Result<Self, SkinError> {
        let mut particles = vec![None; surface.len()];
        let mirrors = surface.scale().element_product().signum();
        for (vertex, (place, skin)) in places.iter().zip(skin).enumerate() {
            let Some(particle) = surface.particle_of_vertex(vertex) else {
                continue;
            };
            if particles[particle].is_none() {
                // The surface's has the scale in it.
                let normal = surface.normal_of(particle) * surface.scale() * mirrors;
                particles[particle] = Some(Bound {
                    place: (*place).into(),
                    normal: normal.normalize_or(Vec3::Y).into(),
                    skin: normalized(vertex, skin)?,
                });
            }
        }
        surface.share_with_copies(&mut particles);
        let particles = particles.into_iter().map(Option::unwrap_or_default);
        Ok(Self::of(particles.collect()))
    }

    /// Binds vertices, by their indices, positions (m), joints and weights. They have no normals.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    #[cfg(feature = "mesh")]
    pub fn of_vertices(
        vertices: impl Iterator<Item = (usize, Vec3, JointWeights)>,
    ) -> Result<Self, SkinError> {
        let bound = |(vertex, place, skin): (usize, Vec3, JointWeights)| {
            Ok(Bound {
                place: place.into(),
                normal: Vec3A::ZERO,
                skin: normalized(vertex, &skin)?,
            })
        };
        let bound: Result<_, SkinError> = vertices.map(bound).collect();
        bound.map(Self::of)
    }

    #[cfg(feature = "mesh")]
    fn of(particles: Vec<Bound>) -> Self {
        let moving = particles.iter().flat_map(|bound| bound.skin.moving());
        let joints = moving.map(|(joint, _)| joint + 1).max().unwrap_or(0);
        Self { particles, joints }
    }

    /// Number of joints required.
    pub fn joints(&self) -> usize {
        self.joints
    }

    /// The joint with the largest sum of weights, the first of several.
    #[cfg(feature = "mesh")]
    pub fn heaviest_joint(&self) -> usize {
        let mut sums = vec![0.0_f32; self.joints];
        for (joint, weight) in self.particles.iter().flat_map(|of| of.skin.moving()) {
            sums[joint] += weight;
        }
        let sums = sums.iter().enumerate().rev();
        let heaviest = sums.max_by(|(_, a), (_, b)| a.total_cmp(b));
        heaviest.map_or(0, |(joint, _)| joint)
    }

    /// Positions of the particles in a pose. `joints` are the matrices Jⱼ Bⱼ, at least [this many](Self::joints).
    pub fn places(&self, joints: &[Affine3A], places: &mut Vec<Vec3>) {
        places.clear();
        places.extend(self.particles.iter().map(|bound| {
            let at = |joint: &Affine3A| joint.transform_point3a(bound.place);
            Vec3::from(bound.blended(joints, at))
        }));
    }

    /// Normals of the particles in a pose, of length 1.
    pub fn normals(&self, joints: &[Affine3A], normals: &mut Vec<Vec3>) {
        normals.clear();
        normals.extend(self.particles.iter().map(|bound| {
            let at = |joint: &Affine3A| joint.transform_vector3a(bound.normal);
            Vec3::from(bound.blended(joints, at)).normalize_or(Vec3::Y)
        }));
    }
}

impl Bound {
    /// The weighted sum over its joints.
    fn blended(&self, joints: &[Affine3A], of: impl Fn(&Affine3A) -> Vec3A) -> Vec3A {
        let mut sum = Vec3A::ZERO;
        for (joint, weight) in self.skin.moving() {
            sum += weight * of(&joints[joint]);
        }
        sum
    }
}

#[cfg(feature = "mesh")]
fn normalized(vertex: usize, skin: &JointWeights) -> Result<JointWeights, SkinError> {
    let sum: f32 = skin.weights.iter().sum();
    if !(sum.is_finite() && skin.weights.iter().all(|weight| *weight >= 0.0)) {
        let weights = skin.weights;
        return Err(SkinError::Weights { vertex, weights });
    }
    let weights = match sum > 0.0 {
        true => skin.weights.map(|weight| weight / sum),
        false => [1.0, 0.0, 0.0, 0.0],
    };
    Ok(JointWeights { weights, ..*skin })
}

#[cfg(all(test, feature = "mesh"))]
mod tests {
    use super::*;
    use crate::cloth::TriangleMesh;
    use bevy::math::{DAffine3, DVec3, Quat};

    /// A strip of vertices whose skins are as different as they can be.
    fn strip() -> (Surface, Vec<Vec3>, Vec<JointWeights>) {
        let place = |vertex: u32| {
            let row = (vertex / 2) as f32;
            Vec3::new((vertex % 2) as f32, row, 0.1 * (row * 1.7).sin())
        };
        let places: Vec<Vec3> = (0..40).map(place).collect();
        let triangles = (0..38).map(|first| [first, first + 1, first + 2]).collect();
        let skin = |vertex: u32| JointWeights {
            joints: [vertex, vertex + 1, vertex * 3, vertex / 3].map(|joint| (joint % 7) as u16),
            // Their sum is not 1.
            weights: [3, 5, 7, 11].map(|prime| (vertex % prime) as f32 * 0.3),
        };
        let mesh = TriangleMesh {
            positions: places.clone(),
            triangles,
            ..TriangleMesh::default()
        };
        let surface = Surface::of_mesh(&mesh, 0.0, Vec3::ONE).expect("a surface");
        (surface, places, (0..40).map(skin).collect())
    }

    fn joints() -> Vec<Affine3A> {
        let joint = |index: u32| {
            let turn = Quat::from_scaled_axis(Vec3::new(1.0, -0.3, 0.2) * index as f32);
            let place = Vec3::new(index as f32, 5.0, -2.0);
            Affine3A::from_scale_rotation_translation(Vec3::splat(0.5), turn, place)
        };
        (0..7).map(joint).collect()
    }

    /// Six roundings of numbers up to 30 m: four sums of four products each.
    #[test]
    fn places_are_those_of_brute_force_in_f64() {
        let (surface, places, skin) = strip();
        let joints = joints();
        let skinning = Skinning::new(&surface, &places, &skin).expect("valid weights");
        let (mut found, mut normals) = (Vec::new(), Vec::new());
        skinning.places(&joints, &mut found);
        skinning.normals(&joints, &mut normals);
        for (vertex, (place, skin)) in places.iter().zip(&skin).enumerate() {
            let sum: f64 = skin.weights.iter().map(|w| f64::from(*w)).sum();
            let mut truth = DVec3::ZERO;
            for (joint, weight) in skin.joints.iter().zip(skin.weights) {
                let joint =
                    DAffine3::from_mat4(bevy::math::Mat4::from(joints[*joint as usize]).as_dmat4());
                let weight = if sum > 0.0 {
                    f64::from(weight) / sum
                } else {
                    0.0
                };
                truth += weight * joint.transform_point3(place.as_dvec3());
            }
            if sum == 0.0 {
                let first = skin.joints[0] as usize;
                truth = joints[first].transform_point3(*place).as_dvec3();
            }
            let particle = surface.particle_of_vertex(vertex).expect("a particle");
            let error = found[particle].as_dvec3().distance(truth);
            assert!(
                error < 6.0 * 30.0 * f64::from(f32::EPSILON),
                "{vertex}: {error}"
            );
            assert!((normals[particle].length() - 1.0).abs() < 1.0e-6);
        }
    }

    #[test]
    fn bad_weights_are_refused() {
        let (surface, places, mut skin) = strip();
        for bad in [f32::NAN, -0.5, f32::INFINITY] {
            skin[17].weights[2] = bad;
            let error = Skinning::new(&surface, &places, &skin).expect_err("no weight");
            assert!(
                matches!(error, SkinError::Weights { vertex: 17, .. }),
                "{error}"
            );
        }
    }
}
