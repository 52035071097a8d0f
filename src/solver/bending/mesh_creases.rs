//! The creases of a mesh.
//!
//! A face of area A with the curvatures κ, as vectors in its own frame, has the energy `½ A Σ D |κ − κ₀|²`. The part without κ₀ is
//! the bending of the mesh. The rest is a force, the gradient of `A D κ·κ₀`. It includes how the frame turns, so that no face
//! has a resultant or a moment.

use bevy::math::{DVec3, Vec3, Vec3A};

use super::{
    creasing::{ClothCreasing, recall},
    patch::{Patch, frame},
};
use crate::cloth::{Block, Layout, MapInline, StiffnessFactors, Surface, Woven};

/// The frame of a patch with its particles at these places.
fn axes_of(at: &[Vec3; 6]) -> Option<[Vec3; 3]> {
    let corners = [at[0], at[1], at[2]].map_inline(Vec3A::from);
    Some(frame(corners)?.map_inline(Vec3::from))
}

/// Curvatures along a face's first edge, beside it and of twist (1/m), in its frame.
type Curvature = [[f32; 3]; 3];

/// A face and those beside it.
#[derive(Debug, Clone)]
struct Face {
    particles: [u32; 6],
    /// Contribution of each particle's position to the curvatures (1/m²).
    curvature: [[f32; 6]; 3],
    /// Area times rigidity, from curvatures to moments (N m³).
    stiffness: [[f32; 3]; 3],
    /// That of the surface at rest.
    natural: [Vec3; 3],
    /// The curvature of a face that lies flat on the one beside it (1/m).
    most: f32,
}

impl Face {
    fn new(patch: &Patch, woven: [[f64; 3]; 3], rigidity: f32, places: &[DVec3]) -> Option<Self> {
        let number = |row: usize, column: usize| {
            let product = woven.iter().map(|of| of[row] * of[column]).sum::<f64>();
            (f64::from(rigidity) * patch.area * product) as f32
        };
        // From one corner, so that rounding stays below curvatures.
        let origin = places[patch.particles[0] as usize];
        let place = |particle: u32| (places[particle as usize] - origin).as_vec3();
        let mut new = Self {
            particles: patch.particles,
            curvature: (patch.curvature).map_inline(|of| of.map_inline(|number| number as f32)),
            stiffness: std::array::from_fn(|row| std::array::from_fn(|column| number(row, column))),
            natural: [Vec3::ZERO; 3],
            most: 4.0 / (2.0 * patch.area as f32).sqrt(),
        };
        let at = new.particles.map_inline(place);
        new.natural = new.bent(&at, &axes_of(&at)?);
        Some(new)
    }

    /// Its curvatures in its frame.
    fn bent(&self, at: &[Vec3; 6], [x, y, z]: &[Vec3; 3]) -> [Vec3; 3] {
        self.curvature.map_inline(|of| {
            let each = of.iter().zip(at);
            let bent: Vec3 = each.map(|(of, place)| *of * (*place - at[0])).sum();
            Vec3::new(bent.dot(*x), bent.dot(*y), bent.dot(*z))
        })
    }

    /// The forces of a crease on each particle (N).
    fn forces(&self, at: &[Vec3; 6], crease: &Curvature) -> Option<[Vec3; 6]> {
        let axes = axes_of(at)?;
        let crease = crease.map_inline(Vec3::from);
        let moments = self.stiffness.map_inline(|of| -> Vec3 {
            let each = of.iter().zip(crease);
            each.map(|(number, crease)| *number * crease).sum()
        });
        let mut forces: [Vec3; 6] = std::array::from_fn(|particle| {
            let of = self.curvature.iter().zip(moments);
            of.map(|(of, moment)| of[particle] * moment).sum()
        });
        let bent = self.bent(at, &axes).into_iter().zip(moments);
        let turning: Vec3 = bent.map(|(bent, moment)| bent.cross(moment)).sum();
        // What the frame does as its corners move: the third turns it around the first edge, the ends of that turn the edge.
        let [x, y, _] = axes;
        let (along, third) = ((at[1] - at[0]).dot(x), at[2] - at[0]);
        let (foot, height) = (third.dot(x) / along, third.dot(y));
        let [lift, tip, swing] = [turning.x / height, turning.y / along, turning.z / along];
        forces[0] += Vec3::new(0.0, swing, lift * (1.0 - foot) - tip);
        forces[1] += Vec3::new(0.0, -swing, lift * foot + tip);
        forces[2].z -= lift;
        let [x, y, z] = axes;
        let forces = forces.map_inline(|force| force.x * x + force.y * y + force.z * z);
        let is_finite = forces.iter().all(|force| force.is_finite());
        is_finite.then_some(forces)
    }
}

/// The rest curvatures of a mesh.
#[derive(Debug, Clone)]
pub(super) struct MeshCreases {
    layout: Layout,
    /// None where a face has no other beside it.
    faces: Vec<Option<Face>>,
    /// Beyond those of the surface.
    rest: Vec<Curvature>,
    places: Vec<Vec3>,
    /// Faces with a crease.
    creased: Vec<u32>,
}

impl MeshCreases {
    pub fn new(surface: &Surface, rigidity: Woven, factors: &StiffnessFactors) -> Self {
        let places = surface.places_in_f64();
        let bending = surface.bending_faces();
        let mut faces = Vec::with_capacity(bending.faces().len());
        for (index, face) in bending.faces().iter().enumerate() {
            let patch = Patch::new(*face, bending.beside(index), &places);
            faces.push(patch.and_then(|patch| {
                let warp = surface.bending_grain(index).map(Vec3::as_dvec3);
                let warp = warp.filter(|_| rigidity.ratio != 1.0);
                let woven = patch.woven(warp, rigidity.ratio.into(), &places);
                let rigidity = rigidity.mean * factors.mean_bending(face);
                Face::new(&patch, woven, rigidity, &places)
            }));
        }
        Self {
            layout: surface.layout(),
            rest: vec![Curvature::default(); faces.len()],
            places: vec![Vec3::ZERO; places.len()],
            creased: Vec::with_capacity(faces.len()),
            faces,
        }
    }

    pub fn rest(&self) -> &[f32] {
        self.rest.as_flattened().as_flattened()
    }

    /// Takes over rest curvatures; none where there are those of another surface.
    pub fn recall(&mut self, rest: &[f32]) {
        if recall(self.rest.as_flattened_mut().as_flattened_mut(), rest) {
            self.gather();
        }
    }

    /// Whether no face has a crease.
    pub fn is_flat(&self) -> bool {
        self.creased.is_empty()
    }

    fn gather(&mut self) {
        self.creased.clear();
        let each = self.rest.iter().enumerate();
        let creased = each.filter(|(_, rest)| **rest != Curvature::default());
        self.creased.extend(creased.map(|(face, _)| face as u32));
    }

    /// Adds its forces (N) where particles are at these places.
    pub fn push(&self, place: impl Fn(u32) -> Vec3, mut add: impl FnMut(u32, Vec3)) {
        for &face in &self.creased {
            let (face, rest) = (&self.faces[face as usize], &self.rest[face as usize]);
            if let Some(face) = face
                && let Some(forces) = face.forces(&face.particles.map_inline(&place), rest)
            {
                for (particle, force) in face.particles.into_iter().zip(forces) {
                    add(particle, force);
                }
            }
        }
    }

    /// Has rest curvatures follow where the cloth is bent beyond its yield curvature.
    pub fn flow(&mut self, creasing: &ClothCreasing, blocks: &[Block]) {
        for (place, slot) in self.places.iter_mut().zip(self.layout.slots()) {
            *place = blocks[slot.block].position(slot.lane);
        }
        let mut has_flowed = false;
        let faces = self.faces.iter().zip(&mut self.rest);
        for (face, rest) in faces.filter_map(|(face, rest)| Some((face.as_ref()?, rest))) {
            let at = (face.particles).map_inline(|particle| self.places[particle as usize]);
            let Some(axes) = axes_of(&at) else {
                continue;
            };
            let mut trials = face.bent(&at, &axes);
            for ((trial, natural), rest) in trials.iter_mut().zip(face.natural).zip(&*rest) {
                let elastic = (*trial - natural).to_array().into_iter().zip(rest);
                let mut yielding = elastic.map(|(bent, rest)| creasing.trial(bent, *rest));
                *trial =
                    Vec3::from_array(std::array::from_fn(|_| yielding.next().unwrap_or_default()));
            }
            let norm_squared = trials.iter().map(|trial| trial.length_squared()).sum();
            let flow = creasing.flow(norm_squared);
            if flow == 0.0 {
                continue;
            }
            has_flowed = true;
            let flowed = |kind: usize| Vec3::from(rest[kind]) + flow * trials[kind];
            let flowed: [Vec3; 3] = std::array::from_fn(flowed);
            let squares = flowed.iter().map(|of| of.length_squared());
            let norm = squares.sum::<f32>().sqrt();
            let most = face.most / norm;
            let part = if norm > face.most { most } else { 1.0 };
            *rest = flowed.map_inline(|of| (part * of).to_array());
        }
        if has_flowed {
            self.gather();
        }
    }
}
