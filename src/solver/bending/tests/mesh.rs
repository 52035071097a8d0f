//! A mesh against its own matrix, dense and in f64.

use super::{
    dense::{solve_dense, start},
    *,
};

/// The displacements to add: the solution of `(M + s K) e = −s K p`, and its first term `−s M⁻¹ K p`.
fn expected(bending: &Bending, particles: &ClothParticles, weight: f64) -> [Vec<DVec3>; 2] {
    let Kind::Mesh(mesh) = &bending.of else {
        panic!("a mesh's");
    };
    let mut matrix = mesh.matrix.dense();
    let (masses, places) = start(particles);
    let is_free = |at: usize| masses[at].is_finite();
    let force = |row: &Vec<f64>| -> DVec3 {
        let each = row.iter().zip(&places);
        each.map(|(number, place)| -weight * number * *place).sum()
    };
    let forces = matrix.iter().map(force).enumerate();
    let mut solution: Vec<DVec3> = forces
        .map(|(at, force)| if is_free(at) { force } else { DVec3::ZERO })
        .collect();
    let pushed = solution
        .iter()
        .zip(&masses)
        .map(|(force, mass)| *force / *mass);
    let pushed = pushed.collect();
    for (at, row) in matrix.iter_mut().enumerate() {
        for (other, number) in row.iter_mut().enumerate() {
            let counts = is_free(at) && is_free(other);
            *number = if counts { weight * *number } else { 0.0 };
        }
        row[at] += if is_free(at) { masses[at] } else { 1.0 };
    }
    solve_dense(&mut matrix, &mut solution);
    [solution, pushed]
}

/// Soft, it is pushed by the first term, of which no more than the part A is missing. Stiff, no more than a hundredth of the
/// solution is missing: 10⁻⁴ of the first residual is left in the norm of the preconditioner, and the matrix stretches that by up to
/// the root of its condition, 100 at A = 10⁴. That is 50,000 times the softest limit: hundreds of iterations, where 40 found a tenth.
#[test]
fn a_mesh_is_bent_as_its_dense_matrix_says() {
    let surface = sheet(8, 0.2, |place| place);
    for pins in [0, 7] {
        let particles = disturbed(&surface, pins, 0.002);
        let mut bending = Bending::new(&surface, &material()).expect("it is stiff");
        let limit = softest(&mut bending, &particles);
        let norm = |moved: &[DVec3]| -> f64 {
            let each = moved.iter().zip(particles.inverse_masses());
            let each = each.filter(|(_, inverse_mass)| *inverse_mass > 0.0);
            let squares =
                each.map(|(moved, inverse_mass)| moved.length_squared() / f64::from(inverse_mass));
            squares.sum::<f64>().sqrt()
        };
        for times in [0.1, 0.99, 10.0, 1.0e3, 5.0e4] {
            let weight = times * limit;
            let found = added(&mut bending, &particles, weight, SimdLevel::Auto);
            assert_eq!(is_soft(&bending), times < 1.0);
            let [solution, pushed] = expected(&bending, &particles, weight.into());
            let missing = |wanted: &[DVec3]| -> Vec<DVec3> {
                let each = found.iter().zip(wanted);
                each.map(|(found, wanted)| found.as_dvec3() - *wanted)
                    .collect()
            };
            let part = norm(&missing(&solution)) / norm(&solution);
            println!("{times} × the limit, pins {pins}: {part:.1e} is missing");
            if times < 1.0 {
                let rounding = norm(&missing(&pushed)) / norm(&pushed);
                assert!(rounding < 1.0e-3, "{rounding}");
                let most = f64::from(push::LIMIT * times);
                assert!(part <= most / (1.0 - most), "{part}");
            } else {
                assert!(part < 1.0e-2, "{part}");
            }
        }
    }
}

/// A constant curvature leaves no force on what is two faces or more from the border, though diagonals alternate: it would give way to
/// that, and be softer by a third. The numbers of the matrix are rounded to 2⁻²⁴ of each.
#[test]
fn a_constant_curvature_leaves_no_force() {
    let surface = sheet(12, 0.0, |place| place);
    let mesh = MeshMatrix::new(
        &surface,
        material().woven_bending(),
        &StiffnessFactors::default(),
        None,
    );
    let places = surface.rest_positions().iter();
    let places: Vec<DVec3> = places
        .map(|at| at.as_dvec3() - DVec3::splat(0.12))
        .collect();
    for (name, square) in [
        ("x²", (|at| at.x * at.x) as fn(DVec3) -> f64),
        ("y²", |at| at.y * at.y),
        ("xy", |at| at.x * at.y),
    ] {
        let heights: Vec<f64> = places.iter().map(|at| square(*at)).collect();
        for (at, row) in mesh.dense().iter().enumerate() {
            if places[at].truncate().abs().max_element() > 0.07 {
                continue;
            }
            let each = row.iter().zip(&heights);
            let each = each.map(|(number, height)| number * (height - heights[at]));
            let force: f64 = each.clone().sum();
            let rounding = each.map(f64::abs).sum::<f64>() / 2.0_f64.powi(24);
            assert!(force.abs() <= rounding, "{name}, {at}: {force} {rounding}");
        }
    }
}
