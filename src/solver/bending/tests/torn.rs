//! Matrices of torn meshes.

use super::*;
use crate::cloth::{ClothGrid, ClothTears};

/// A matrix that copies rows from that of other tears is the one that would be built, bit for bit: of meshes flat and curved, with a
/// grain or a map, and of a torn grid, as tears come and go. Most rows are copied.
#[test]
fn a_matrix_follows_tears() {
    let flat = sheet(12, 0.25, |place| place);
    let curved = sheet(12, 0.25, |place| {
        Vec3::new(place.x, place.y, 3.0 * place.x * place.x)
    });
    let woven = ClothGrain::along(Vec3::new(0.8, 0.6, 0.0))
        .apply(flat.clone(), &TriangleMesh::default())
        .expect("a grain");
    let grid = Cloth::new(13, 13, 0.02).surface(Vec3::ONE).expect("a grid");
    let material = ClothMaterial {
        weft: Some(ClothWeft {
            bend_rigidity: RIGIDITY / 5.0,
            ..Default::default()
        }),
        ..material()
    };
    let matrix = |surface: &Surface, factors: &StiffnessFactors, known: Option<KnownMatrix>| {
        MeshMatrix::new(surface, material.woven_bending(), factors, known)
    };
    // By the particle of the whole surface, as maps are.
    let factors_of = |surface: &Surface, is_mapped: bool, step: u32| {
        let each = 0..if is_mapped { surface.len() as u32 } else { 0 };
        StiffnessFactors {
            bending: each
                .map(|at| match surface.origin_of(at) {
                    // It changes at one particle a step.
                    origin if origin == 60 + step => 9.0,
                    origin => 1.0 + (origin % 5) as f32,
                })
                .collect(),
            ..Default::default()
        }
    };
    let mut noise = noise();
    for (name, whole) in [
        ("flat", flat.clone()),
        ("mapped", flat),
        ("curved", curved),
        ("woven", woven),
        ("grid", grid),
    ] {
        let whole = Arc::new(whole);
        let mut tears = ClothTears::default();
        let torn = |tears: &ClothTears| whole.torn(tears.edges()).expect("edges that exist");
        let mut before = torn(&tears);
        let mut factors = factors_of(&before, name == "mapped", 0);
        let mut known = matrix(&before, &factors, None);
        assert_eq!(!known.rest.is_empty(), name == "curved");
        let mut most_pieces = 0;
        for step in 0..16 {
            if step % 5 == 4 {
                tears = tears.first(tears.edges().len() / 2);
            }
            for _ in 0..step % 3 {
                let faces = whole.triangles();
                let at = ((noise() + 1.0) / 2.0 * faces.len() as f64) as usize;
                tears.tear_out(&whole, faces[at.min(faces.len() - 1)]);
            }
            let after = torn(&tears);
            most_pieces = after.pieces().max(most_pieces);
            let factors_after = factors_of(&after, name == "mapped", step + 1);
            let known_before = KnownMatrix {
                matrix: &known,
                surface: &before,
                factors: &factors,
            };
            let is_changed = mesh_matrix::changed(&known_before, &after, &factors_after);
            let count = is_changed.iter().filter(|is_changed| **is_changed).count();
            // A face that is torn out changes the faces around its corners, and those beside: some two dozen particles.
            let is_mended = step % 5 == 4;
            assert!(
                is_mended || 2 * count < after.len(),
                "{name}, step {step}: {count} change"
            );
            let copied = matrix(&after, &factors_after, Some(known_before));
            let built = matrix(&after, &factors_after, None);
            assert!(copied == built, "{name}, step {step}");
            (before, known, factors) = (after, copied, factors_after);
        }
        assert!(most_pieces > 2, "{name}: {most_pieces} pieces");
    }
}

fn grid(columns: u32, rows: u32) -> (ClothGrid, Arc<Surface>) {
    let cloth = Cloth::new(columns, rows, 0.02);
    let grid = cloth.grid(Vec3::new(1.0, 1.3, 1.0)).expect("valid");
    let surface = Arc::new(Surface::of_grid(&grid));
    (grid, surface)
}

/// A grid with this many of its faces torn out, and a cut in its middle.
pub fn shreds(columns: u32, rows: u32, count: usize) -> Surface {
    let (_, whole) = grid(columns, rows);
    let (mut tears, mut noise) = (ClothTears::default(), noise());
    let faces = whole.triangles();
    for _ in 0..count {
        let at = ((noise() + 1.0) / 2.0 * faces.len() as f64) as usize;
        tears.tear_out(&whole, faces[at.min(faces.len() - 1)]);
    }
    let middle = columns * (rows / 2);
    tears.tear_all((1..columns / 2).map(|column| [middle + column, middle + column + 1]));
    whole.torn(tears.edges()).expect("edges that exist")
}

/// A grid that is torn nowhere, as that of a map is, is pushed as a grid, to the bit.
#[test]
fn a_mapped_grid_is_pushed_as_a_grid() {
    for (columns, rows) in [(2, 2), (3, 3), (2, 9), (9, 4), (17, 10)] {
        let (_, whole) = grid(columns, rows);
        let mapped = whole.torn(&[]).expect("a grid");
        assert!(mapped.as_grid().is_none());
        let [mut of_grid, mut of_mapped] =
            [&*whole, &mapped].map(|of| Bending::new(of, &material()).expect("it is stiff"));
        let particles = disturbed(&whole, 5, 0.005);
        let weight = softest(&mut of_grid, &particles).min(1.0e-6);
        let expected = added(&mut of_grid, &particles, weight, SimdLevel::Auto);
        let particles = disturbed(&mapped, 5, 0.005);
        let found = added(&mut of_mapped, &particles, weight, SimdLevel::Auto);
        assert!(is_soft(&of_mapped), "{columns} × {rows}");
        assert_eq!(found, expected, "{columns} × {rows}");
    }
}

/// Both parts of a grid that is cut along a row or a column are pushed as grids of their own. Places within 0.3 m are rounded by
/// 1.5·10⁻⁸ m, which is less than 10⁻⁵ of second differences of 5 mm.
#[test]
fn pieces_of_a_cut_grid_are_pushed_as_grids() {
    for along_row in [true, false] {
        let (columns, rows) = (8, 11);
        let (_, whole) = grid(columns, rows);
        let edge = |at: u32| match along_row {
            true => [4 * columns + at, 4 * columns + at + 1],
            false => [at * columns + 4, (at + 1) * columns + 4],
        };
        let last = if along_row { columns } else { rows } - 1;
        let edges: Vec<[u32; 2]> = (0..last).map(edge).collect();
        let torn = whole.torn(&edges).expect("edges of the grid");
        assert_eq!(torn.pieces(), 2);
        let mut bending = Bending::new(&torn, &material()).expect("it is stiff");
        let particles = disturbed(&torn, 7, 0.005);
        // Sums of bounds are rounded.
        let weight = 0.999 * softest(&mut bending, &particles).min(1.0e-6);
        let found = added(&mut bending, &particles, weight, SimdLevel::Auto);
        assert!(is_soft(&bending));
        let of = torn.pieces_of();
        for piece in [of[0], of[of.len() - 1]] {
            let mut own: Vec<usize> = (0..of.len()).filter(|at| of[*at] == piece).collect();
            own.sort_by_key(|at| torn.origin_of(*at as u32));
            let count = own.len() as u32;
            let (columns, rows) = match along_row {
                true => (columns, count / columns),
                false => (count / rows, rows),
            };
            let (_, alone) = grid(columns, rows);
            let mut bending = Bending::new(&alone, &material()).expect("it is stiff");
            let mut part = ClothParticles::at_rest(&alone, &material()).expect("valid");
            for (to, from) in own.iter().enumerate() {
                let (to, from) = (part.layout().slot_of(to), torn.layout().slot_of(*from));
                let (was, block) = (
                    &particles.blocks()[from.block],
                    &mut part.blocks_mut()[to.block],
                );
                block.set_position(to.lane, was.position(from.lane));
                block.set_displacement(to.lane, was.displacement(from.lane));
                block.set_inverse_mass(to.lane, was.inverse_mass(from.lane));
            }
            let expected = added(&mut bending, &part, weight, SimdLevel::Auto);
            assert!(is_soft(&bending));
            let largest = expected.iter().map(|of| of.length()).fold(0.0, f32::max);
            for (at, expected) in own.iter().zip(&expected) {
                let off = found[*at].distance(*expected);
                assert!(off <= 1.0e-5 * largest, "{at}: {off} of {largest}");
            }
        }
    }
}

/// A plate of two rows is as stiff in each as a map says: rows that are bent alike are pushed by their own stiffness.
#[test]
fn a_map_counts_in_each_row() {
    let (_, whole) = grid(5, 2);
    let mapped = whole.torn(&[]).expect("a grid");
    let pushed = |factors: [f32; 2]| {
        let bending = (0..10).map(|at| factors[at / 5]).collect();
        let factors = StiffnessFactors {
            bending,
            ..Default::default()
        };
        let bending = Bending::with_factors(&mapped, &material(), Arc::new(factors), None);
        let mut bending = bending.expect("it is stiff");
        let mut particles = ClothParticles::at_rest(&mapped, &material()).expect("valid");
        // Each row is bent alike, to a parabola.
        for index in 0..10 {
            let along = (index % 5) as f32 - 2.0;
            let place = mapped.rest_positions()[index] + 1.0e-3 * along * along * Vec3::Z;
            particles.set_position(index, place).expect("it exists");
        }
        let found = added(&mut bending, &particles, 1.0e-7, SimdLevel::Auto);
        assert!(is_soft(&bending));
        [found[0].z, found[5].z]
    };
    let [[above, below], [above_again, twice]] = [[1.0, 1.0], [1.0, 2.0]].map(pushed);
    assert!(above < 0.0);
    for (found, expected) in [(below, above), (above_again, above), (twice, 2.0 * above)] {
        // Places of a tenth of a metre are rounded by 10⁻⁸ m, second differences are of 2 mm.
        assert!(
            (found / expected - 1.0).abs() < 1.0e-4,
            "{found} {expected}"
        );
    }
}

/// The bound of shreds is one of the largest eigenvalue of what pushes, and at most four times that.
#[test]
fn shreds_are_pushed_below_the_limit() {
    for count in 1..12 {
        let surface = shreds(11, 9, count);
        let mut bending = Bending::new(&surface, &material()).expect("it is stiff");
        let mut particles = disturbed(&surface, 0, 0.0);
        let weight = softest(&mut bending, &particles);
        bending.prepare(particles.blocks(), weight);
        assert!(is_soft(&bending));
        let mut noise = noise();
        for index in 0..particles.len() {
            let moved = DVec3::new(noise(), noise(), noise()).as_vec3();
            let set = particles.set_displacement(index, 1.0e-3 * moved);
            set.expect("it exists");
        }
        let mut largest = 0.0_f32;
        for _ in 0..300 {
            let moved = added(&mut bending, &particles, weight, SimdLevel::Auto);
            // In the norm in which the matrix is symmetric.
            let norm = |of: &mut dyn Iterator<Item = Vec3>| -> f32 {
                let each = of.zip(particles.inverse_masses());
                let squares = each.map(|(moved, weight)| moved.length_squared() / weight);
                squares.sum::<f32>().sqrt()
            };
            let after = norm(&mut moved.iter().copied());
            largest = after / norm(&mut particles.displacements());
            for (index, moved) in moved.into_iter().enumerate() {
                let set = particles.set_displacement(index, moved * (1.0e-2 / after));
                set.expect("it exists");
            }
        }
        // Norms of floats are right to 10⁻⁵.
        let range = push::LIMIT / 4.0..push::LIMIT * (1.0 + 1.0e-5);
        assert!(range.contains(&largest), "{largest}");
    }
}
