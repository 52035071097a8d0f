//! Matrices of torn meshes.

use super::*;
use crate::cloth::ClothTears;

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
