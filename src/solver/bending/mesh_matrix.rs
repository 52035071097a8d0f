//! The matrix of a mesh's bending energy.

use super::patch::{Patch, RestFace, for_each_row};
use crate::cloth::{StiffnessFactors, Surface, Woven};

/// K, row by row, and the forces of faces that are curved at rest.
#[derive(Debug, PartialEq)]
pub(super) struct MeshMatrix {
    /// Where each particle's entries begin, and one more.
    first: Vec<u32>,
    /// Column and number (N/m) off the diagonal.
    entries: Vec<(u32, f32)>,
    /// On it.
    pub diagonal: Vec<f32>,
    /// By their faces, ascending.
    pub rest: Vec<RestFace>,
}

/// The matrix of a surface that was torn in another way.
#[derive(Debug, Clone, Copy)]
pub(super) struct KnownMatrix<'a> {
    pub matrix: &'a MeshMatrix,
    pub surface: &'a Surface,
    pub factors: &'a StiffnessFactors,
}

impl MeshMatrix {
    /// Of a plate of these flexural rigidities (N·m), times the factor of each face. Without a grain, it has their mean in all
    /// directions. Rows that do not change are copied from a matrix that is known, of the same rigidities.
    pub fn new(
        surface: &Surface,
        rigidity: Woven,
        factors: &StiffnessFactors,
        known: Option<KnownMatrix>,
    ) -> Self {
        let places = surface.places_in_f64();
        let known = known.map(|known| (known.matrix, changed(&known, surface, factors)));
        // The matrix with the row of a particle, if that is as before.
        let with_row = |particle: u32| {
            let (matrix, changed) = known.as_ref()?;
            let is_kept = (particle as usize) < matrix.len() && !changed[particle as usize];
            is_kept.then_some(*matrix)
        };
        let known_rest = known.iter().flat_map(|(matrix, _)| &matrix.rest);
        let mut known_rest = known_rest.peekable();
        let bending = surface.bending_faces();
        let mut patches = Vec::new();
        if known.is_none() {
            patches.reserve_exact(bending.faces().len());
        }
        let mut rest = Vec::new();
        for (index, face) in bending.faces().iter().enumerate() {
            let beside = bending.beside(index);
            let rest_before = known_rest.next_if(|of| of.face as usize == index);
            let mut particles = face.iter().chain(beside.iter().flatten());
            if particles.all(|particle| with_row(*particle).is_some()) {
                rest.extend(rest_before.copied());
                continue;
            }
            let Some(mut patch) = Patch::new(*face, beside, &places) else {
                continue;
            };
            if let Some(warp) = surface.bending_grain(index)
                && rigidity.ratio != 1.0
            {
                patch.weave(warp.as_dvec3(), rigidity.ratio.into(), &places);
            }
            let stiffness = f64::from(rigidity.mean * factors.mean_bending(face)) * patch.area;
            rest.extend(patch.rest(index as u32, stiffness, &places));
            patches.push((patch, stiffness));
        }
        let mut matrix = Self {
            first: Vec::with_capacity(places.len() + 1),
            entries: Vec::new(),
            diagonal: Vec::with_capacity(places.len()),
            rest,
        };
        matrix.first.push(0);
        // Of a row that is copied, the sums lack patches, and are not used.
        for_each_row(&patches, places.len(), |row, numbers| {
            if let Some(known) = with_row(row) {
                matrix.diagonal.push(known.diagonal[row as usize]);
                matrix.entries.extend(known.of(row as usize));
            } else {
                let on_it = numbers.iter().find(|(column, _)| *column == row);
                (matrix.diagonal).push(on_it.map_or(0.0, |(_, number)| *number as f32));
                let others = numbers.iter().filter(|(column, _)| *column != row);
                let others = others.map(|(column, number)| (*column, *number as f32));
                matrix.entries.extend(others);
            }
            matrix.first.push(matrix.entries.len() as u32);
        });
        matrix.entries.shrink_to_fit();
        matrix.rest.shrink_to_fit();
        matrix
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.diagonal.len()
    }

    /// The entries of a row off the diagonal.
    #[inline]
    pub fn of(&self, row: usize) -> &[(u32, f32)] {
        &self.entries[self.first[row] as usize..self.first[row + 1] as usize]
    }
}

#[cfg(test)]
impl MeshMatrix {
    /// K (N/m), dense. Its rows add up to nothing, as the forces do.
    pub fn dense(&self) -> Vec<Vec<f64>> {
        let count = self.len();
        let row = |row: usize| {
            let mut numbers = vec![0.0; count];
            for &(column, number) in self.of(row) {
                numbers[column as usize] += f64::from(number);
                numbers[row] -= f64::from(number);
            }
            numbers
        };
        (0..count).map(row).collect()
    }

    /// ½ xᵀ K x of one coordinate (J), by differences, as the forces are.
    pub fn energy(&self, places: &[f64]) -> f64 {
        let of_row = |row: usize| {
            let beside = self.of(row).iter();
            let between = |&(other, number): &(u32, f32)| {
                f64::from(number) * (places[other as usize] - places[row]).powi(2)
            };
            beside.map(between).sum::<f64>()
        };
        // Each pair is seen from both ends.
        -(0..places.len()).map(of_row).sum::<f64>() / 4.0
    }
}

/// Marks the particles of faces that are not as before.
pub(super) fn changed(
    known: &KnownMatrix,
    surface: &Surface,
    factors: &StiffnessFactors,
) -> Vec<bool> {
    let [was, is] = [known.surface, surface].map(Surface::bending_faces);
    if was.faces().len() != is.faces().len() {
        return vec![true; surface.len()];
    }
    let mut is_changed = vec![false; surface.len()];
    for index in 0..is.faces().len() {
        let [before, after] = [was, is].map(|of| (of.faces()[index], of.beside(index)));
        let particles = |(face, beside): ([u32; 3], [Option<u32>; 3])| {
            face.into_iter().chain(beside.into_iter().flatten())
        };
        let place = |of: &Surface, particle: u32| of.rest_positions()[particle as usize];
        let is_same = before == after
            && known.factors.mean_bending(&before.0) == factors.mean_bending(&after.0)
            && particles(after).all(|of| place(known.surface, of) == place(surface, of));
        if !is_same {
            for particle in particles(before).chain(particles(after)) {
                if let Some(is_changed) = is_changed.get_mut(particle as usize) {
                    *is_changed = true;
                }
            }
        }
    }
    is_changed
}
