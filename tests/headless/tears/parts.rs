//! Parts of torn cloth: scraps, and their weight.

use std::{collections::BTreeMap, ptr, sync::Arc};

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::{meshes::sheets, support::*, tears::*};

fn sorted<const N: usize>(mut of: [u32; N]) -> [u32; N] {
    of.sort_unstable();
    of
}

fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]].map(sorted)
}

/// How many borders, edges with a face on one side alone, there are of each edge of the whole surface.
fn borders(surface: &Surface) -> BTreeMap<[u32; 2], usize> {
    let mut faces: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for side in surface.triangles().iter().flat_map(|face| sides(*face)) {
        *faces.entry(side).or_default() += 1;
    }
    let mut borders = BTreeMap::new();
    for (side, _) in faces.into_iter().filter(|(_, faces)| *faces == 1) {
        let whole = sorted(side.map(|end| surface.origin_of(end)));
        *borders.entry(whole).or_default() += 1;
    }
    borders
}

/// Place and velocity of the centre of mass of three particles, which weigh as `weights` have it.
fn centre(of: &ClothParticles, face: [u32; 3], weights: [f32; 3]) -> [Vec3; 2] {
    let mut sums = [Vec3::ZERO; 2];
    for (corner, weight) in face.into_iter().zip(weights) {
        let corner = corner as usize;
        sums[0] += weight * of.position(corner).expect("it exists");
        sums[1] += weight * of.velocity(corner).expect("it exists");
    }
    sums.map(|sum| sum / weights.iter().sum::<f32>())
}

/// A face is torn out in the middle of a sheet that hangs without damping. The scrap falls freely: by v t + ½ g t² from where it was in
/// the sheet, as the centre of its mass, since the forces in it cancel. Sub-steps of first order would be ahead by one part in their
/// number, 33 × 2 or more: 2 % is allowed. The hole has the border that the face has, and so has the scrap. The mass stays, to the rounding
/// of its shares.
#[test]
fn a_face_that_is_torn_out_falls_freely() {
    for cloth in [Cloth::new(13, 13, 0.1), mesh(1.2, 1.2, 0.1)] {
        let mut app = app();
        let undamped = ClothMaterial {
            damping: 0.0,
            ..ClothMaterial::COTTON
        };
        let parts = (cloth, top(), undamped, ClothTears::default());
        let cloth = app.world_mut().spawn(parts).id();
        tick(&mut app, 60);
        let whole = surface(&app, cloth).clone();
        let far = |face: &[u32; 3]| {
            let corners = face.map(|corner| whole.rest_positions()[corner as usize]);
            (corners.iter().sum::<Vec3>() / 3.0).distance(Vec3::new(0.6, -0.6, 0.0))
        };
        let faces = whole.triangles().iter().copied();
        let face = faces.min_by(|a, b| far(a).total_cmp(&far(b)));
        let face = face.expect("faces");
        let before = particles(&app, cloth).clone();
        let (mass, _) = motion(&app, cloth);
        change::<ClothTears>(&mut app, cloth, |tears| {
            assert_eq!(tears.tear_out(&whole, face), 3);
        });
        tick(&mut app, 1);
        let told = messages::<ClothTorn>(&mut app);
        assert_eq!(told.len(), 1);
        assert_eq!(
            (told[0].cloth, told[0].edges, told[0].pieces),
            (cloth, 3, 2)
        );
        let torn = surface(&app, cloth).clone();
        assert_eq!(torn.pieces(), 2);
        let mut expected = borders(&whole);
        for side in sides(face) {
            assert_eq!(expected.insert(side, 2), None, "it is inside");
        }
        assert_eq!(borders(&torn), expected);
        assert!((motion(&app, cloth).0 / mass - 1.0).abs() < 1.0e-6);
        // The face itself, by what its corners were.
        let mut scraps = torn
            .triangles()
            .iter()
            .filter(|scrap| sorted(scrap.map(|corner| torn.origin_of(corner))) == sorted(face));
        let scrap = *scraps.next().expect("a scrap");
        assert_eq!(scraps.next(), None);
        let weights = scrap.map(|corner| {
            let weight = particles(&app, cloth).inverse_mass(corner as usize);
            weight.expect("it exists").recip()
        });
        let origins = scrap.map(|corner| torn.origin_of(corner));
        let [from, velocity] = centre(&before, origins, weights);
        tick(&mut app, 32);
        let seconds = 33.0 * TICK;
        let fall = GRAVITY * seconds * seconds / 2.0;
        let expected = from + velocity * seconds + fall * Vec3::NEG_Y;
        let [place, _] = centre(particles(&app, cloth), scrap, weights);
        let off = place.distance(expected);
        assert!(off < 0.02 * fall, "{off} m of {fall} m");
        assert!((motion(&app, cloth).0 / mass - 1.0).abs() < 1.0e-6);
    }
}

/// The surface of a cloth, and where its springs and its tree are.
fn parts(app: &App, cloth: Entity) -> (Arc<Surface>, [*const (); 2]) {
    let built: &ClothBuilt = app.world().get(cloth).expect("it is built");
    let at = [
        ptr::from_ref(built.springs()).cast(),
        ptr::from_ref(built.tree()).cast(),
    ];
    (sheets::surface(app, cloth).clone(), at)
}

/// A cloth whose density changes in every tick keeps its surface, springs and tree, and shares the surface with one that stays dry: whole,
/// and after a tear. Each particle, new ones as well, weighs as its place at rest says, times the dry one. Masses round four times, by 2⁻²⁴.
#[test]
fn a_density_that_changes_builds_nothing() {
    for cloth in [Cloth::new(9, 9, 0.1), mesh(0.8, 0.8, 0.1)] {
        let mut app = app();
        let [wet, dry] = [(); 2].map(|()| {
            let parts = (cloth.clone(), top(), ClothTears::default());
            app.world_mut().spawn(parts).id()
        });
        let map = ClothMaterialMap::default();
        app.world_mut().entity_mut(wet).insert(map);
        tick(&mut app, 1);
        let mut known = parts(&app, wet);
        let whole = known.0.clone();
        for at in 1..30_u8 {
            let wetness = 0.3 * f32::from(at);
            // Two ticks go by without a change, one of them as the cut opens.
            let changes = !(14..16).contains(&at);
            if changes {
                let paint = ClothPaint::at_rest(move |place| wetness * place.y.abs());
                change::<ClothMaterialMap>(&mut app, wet, |map| map.density.paint = paint);
            }
            if at == 14 || at == 20 {
                let height = if at == 14 { -0.4 } else { -0.2 };
                let edges = edges_where(&app, dry, |rest| (rest.y - height).abs() < 0.045);
                assert!(tear(&mut app, wet, edges.iter().copied()) > 4);
                tear(&mut app, dry, edges);
            }
            tick(&mut app, 1);
            let now = parts(&app, wet);
            if at == 14 || at == 20 {
                assert!(!Arc::ptr_eq(&known.0, &now.0) && now.0.len() > known.0.len());
                known = now;
            } else {
                assert!(Arc::ptr_eq(&known.0, &now.0) && known.1 == now.1, "{at}");
            }
            assert!(Arc::ptr_eq(&known.0, sheets::surface(&app, dry)), "{at}");
            let wetness = if changes { wetness } else { 0.3 * 13.0 };
            let [wet, dry] = [wet, dry].map(|cloth| particles(&app, cloth).inverse_masses());
            for (index, (wet, dry)) in wet.zip(dry).enumerate() {
                // The sides of a cut begin a little apart; they are painted where they were whole.
                let rest = whole.rest_positions()[known.0.origin_of(index as u32) as usize];
                if dry > 0.0 {
                    let (found, expected) = (dry / wet, 1.0 + wetness * rest.y.abs());
                    assert!(
                        (found / expected - 1.0).abs() < 1.0e-6,
                        "{at}: {found} {expected}"
                    );
                }
            }
        }
    }
}

/// Cloth is cut at any level of detail. One that stands still opens its cut as it goes on. Its lower part then falls off.
#[test]
fn cloth_is_cut_at_any_level() {
    use ClothLodLevel::{Every, Frozen, Full, Off};
    for (cloth, level) in [Cloth::new(9, 9, 0.1), mesh(0.8, 0.8, 0.1)]
        .into_iter()
        .flat_map(|cloth| [Full, Every(2), Every(4), Frozen, Off].map(|of| (cloth.clone(), of)))
    {
        let mut app = app();
        let parts = (cloth, top(), ClothTears::default());
        let cloth = app.world_mut().spawn(parts).id();
        let set = |app: &mut App, level| {
            let lod = ClothLod::at(level);
            app.world_mut().entity_mut(cloth).insert(lod);
        };
        tick(&mut app, 2);
        set(&mut app, level);
        tick(&mut app, 8);
        let mass = motion(&app, cloth).0;
        assert!(cut_at(&mut app, -0.35) > 4);
        tick(&mut app, 8);
        let stands = matches!(level, Frozen | Off);
        let pieces = sheets::surface(&app, cloth).pieces();
        assert_eq!(pieces, if stands { 1 } else { 2 }, "{level:?}");
        set(&mut app, Full);
        tick(&mut app, 64);
        assert_eq!(sheets::surface(&app, cloth).pieces(), 2, "{level:?}");
        assert!(app.world().get::<ClothFault>(cloth).is_none());
        assert!((motion(&app, cloth).0 / mass - 1.0).abs() < 1.0e-6);
        let lowest = particles(&app, cloth).positions().map(|place| place.y);
        assert!(lowest.fold(0.0, f32::min) < -3.0, "{level:?}");
    }
}
