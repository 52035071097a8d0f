//! Implicit Euler by local and global solves (Liu et al. 2013).

use super::error::MethodError;
use super::state::{MassSpring, Real, add, along, ends, scale, sub};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{CreationError, FaerError, SparseColMat, Triplet};
use faer::{Conj, Mat, Par, Side, Spec};
use std::fmt;

/// A stepper with the factor of M / dt² + L over the free particles, where L
/// is the stiffness-weighted Laplacian of the springs. The three coordinates
/// share it, and it is made once.
pub(super) struct Projective<R: Real> {
    /// s
    step: R,
    iterations: u32,
    /// The row of each particle; none when it is pinned.
    rows: Vec<Option<usize>>,
    symbolic: SymbolicCholesky<usize>,
    factor: Vec<R>,
    /// Right side (N), then the solution (m), of a global solve: free × 3.
    solution: Mat<R>,
    /// Where the particles would go without springs, m.
    predicted: Vec<[R; 3]>,
    scratch: MemBuffer,
}

// By hand, as the scratch buffer has no `Debug`.
impl<R: Real> fmt::Debug for Projective<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Projective")
            .field("step", &self.step)
            .field("iterations", &self.iterations)
            .field("unknowns", &self.solution.nrows())
            .finish_non_exhaustive()
    }
}

impl<R: Real> Projective<R> {
    pub(super) fn new(
        state: &MassSpring<R>,
        step: R,
        iterations: u32,
    ) -> Result<Self, MethodError> {
        let (rows, matrix) = system(state, step)?;
        let symbolic = factorize_symbolic_cholesky(
            matrix.symbolic(),
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams::default(),
        )?;
        let mut factor = vec![R::from(0.0); symbolic.len_val()];
        // One buffer serves the factorization and, from then on, every solve.
        let request = symbolic
            .factorize_numeric_llt_scratch::<R>(Par::Seq, Spec::default())
            .or(symbolic.solve_in_place_scratch::<R>(3, Par::Seq));
        let mut scratch = MemBuffer::new(request);
        symbolic.factorize_numeric_llt(
            &mut factor,
            matrix.as_ref(),
            Side::Lower,
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut scratch),
            Spec::default(),
        )?;
        Ok(Self {
            step,
            iterations,
            rows,
            solution: Mat::zeros(matrix.nrows(), 3),
            symbolic,
            factor,
            predicted: state.positions.clone(),
            scratch,
        })
    }

    pub(super) fn step(&mut self, state: &mut MassSpring<R>, acceleration: [R; 3], kept: R) {
        let gained = scale(acceleration, self.step);
        for (particle, row) in self.rows.iter().enumerate() {
            let position = state.positions[particle];
            self.predicted[particle] = position;
            if row.is_some() {
                let velocity = add(scale(state.velocities[particle], kept), gained);
                state.velocities[particle] = velocity;
                self.predicted[particle] = add(position, scale(velocity, self.step));
            }
        }
        // The first local solve starts at the prediction.
        state.positions.copy_from_slice(&self.predicted);
        for _ in 0..self.iterations {
            self.iterate(state);
        }
        let per_second = R::from(1.0) / self.step;
        for (velocity, row) in state.velocities.iter_mut().zip(&self.rows) {
            if let Some(row) = *row {
                *velocity = add(*velocity, scale(self.departure(row), per_second));
            }
        }
    }

    /// One local and one global solve.
    ///
    /// The unknown is the departure δ = x - s from the prediction s, for which
    /// the system reads (M / dt² + L) δ = J d - L s: the large terms cancel
    /// before they are rounded, and pins are the rows with δ = 0.
    fn iterate(&mut self, state: &mut MassSpring<R>) {
        self.solution.fill(R::from(0.0));
        for spring in &state.springs {
            let pair = ends(spring);
            // Local solve: the nearest vector of the rest length. Coincident
            // ends are as near to every direction; the zero vector favours none.
            let target = match along(&state.positions, pair) {
                Some((_, direction)) => scale(direction, R::from(spring.rest_length)),
                None => [R::from(0.0); 3],
            };
            let predicted = sub(self.predicted[pair[0]], self.predicted[pair[1]]);
            let stiffness = R::from(1.0) / R::from(spring.compliance);
            let force = scale(sub(target, predicted), stiffness);
            for (axis, force) in force.into_iter().enumerate() {
                if let Some(row) = self.rows[pair[0]] {
                    self.solution[(row, axis)] += force;
                }
                if let Some(row) = self.rows[pair[1]] {
                    self.solution[(row, axis)] -= force;
                }
            }
        }
        LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            self.solution.as_mut(),
            Par::Seq,
            MemStack::new(&mut self.scratch),
        );
        for (particle, row) in self.rows.iter().enumerate() {
            if let Some(row) = *row {
                state.positions[particle] = add(self.predicted[particle], self.departure(row));
            }
        }
    }

    fn departure(&self, row: usize) -> [R; 3] {
        [0, 1, 2].map(|axis| self.solution[(row, axis)])
    }
}

/// The rows of the free particles and the lower triangle of M / dt² + L (N/m).
type System<R> = (Vec<Option<usize>>, SparseColMat<usize, R>);

fn system<R: Real>(state: &MassSpring<R>, step: R) -> Result<System<R>, FaerError> {
    let mut free = 0;
    let mut entries = Vec::new();
    let mut rows = Vec::with_capacity(state.positions.len());
    for &w in &state.inverse_mass {
        rows.push((w > R::from(0.0)).then(|| {
            entries.push(Triplet::new(free, free, R::from(1.0) / (w * step * step)));
            free += 1;
            free - 1
        }));
    }
    for spring in &state.springs {
        let stiffness = R::from(1.0) / R::from(spring.compliance);
        let pair = ends(spring).map(|end| rows[end]);
        for row in pair.into_iter().flatten() {
            entries.push(Triplet::new(row, row, stiffness));
        }
        if let [Some(a), Some(b)] = pair {
            entries.push(Triplet::new(a.max(b), a.min(b), -stiffness));
        }
    }
    let matrix =
        SparseColMat::try_new_from_triplets(free, free, &entries).map_err(|error| match error {
            CreationError::Generic(error) => error,
            // Rows are counted above, so this cannot be.
            CreationError::OutOfBounds { .. } => FaerError::IndexOverflow,
        })?;
    Ok((rows, matrix))
}
