//! The load at which cloth tears.

use super::*;

/// The elongation at which a strip begins to tear that a row of pins pulls apart slowly, a thousandth of `expected` (m) in a tick.
fn elongation_at_tear(
    app: &mut App,
    strip: impl Bundle,
    length: f32,
    expected: f32,
) -> (Entity, f32) {
    app.insert_resource(ClothGravity(Vec3::ZERO));
    let bar = app.world_mut().spawn(Transform::default()).id();
    let lower = Pin::at_rest(move |place| place.y < 1.0e-3 - length);
    let held = ClothAttachments::new([(lower, bar)]);
    let cloth = app.world_mut().spawn((strip, top(), held)).id();
    tick(app, 1);
    let mut pulled = 0.0;
    while tears(app, cloth).is_empty() {
        pulled += 1.0e-3 * expected;
        assert!(pulled < 1.5 * expected, "it holds half as much again");
        change::<Transform>(app, bar, |bar| bar.translation.y = -pulled);
        tick(app, 1);
    }
    println!(
        "{}: tears at {:.1} % of its strength",
        surface(app, cloth),
        100.0 * pulled / expected
    );
    (cloth, pulled)
}

/// A strip that is pulled apart slowly tears within 5 % of the load that its strength stands for, at any resolution of a grid: the
/// stretch at that load is strength × compliance. Shear springs are soft, so that it hardly contracts: where its ends hold it, the
/// corners bear 2 % more. A tick pulls by a thousandth of that load.
#[test]
fn a_strip_tears_at_its_strength() {
    let material = ClothMaterial {
        stretch_compliance: 5.0e-4,
        shear_compliance: 1.0e-2,
        ..ClothMaterial::COTTON
    };
    let strength = 100.0;
    for columns in [8, 16, 32] {
        let spacing = 0.4 / (columns - 1) as f32;
        let rows = (1.0 / spacing) as u32 + 1;
        let length = (rows - 1) as f32 * spacing;
        let expected = strength * material.stretch_compliance * length;
        let strip = Cloth::new(columns, rows, spacing).flat();
        let strip = (strip, material, ClothTearing::new(strength));
        let mut app = app();
        let (cloth, found) = elongation_at_tear(&mut app, strip, length, expected);
        let ratio = found / expected;
        assert!(ratio > 0.95 && ratio < 1.05, "{found} {expected}");
        // It goes on until the strip is in two, and no piece bears too much any more.
        tick(&mut app, 200);
        let pieces = surface(&app, cloth).pieces();
        assert!(pieces >= 2, "{pieces}");
        let edges = tears(&app, cloth).edges().len();
        println!("    in {pieces} pieces, along {edges} edges");
    }
}

/// A map that makes it softer, and stiffening, change how far it stretches before it tears, and not the load.
#[test]
fn a_map_leaves_the_strength_alone() {
    let material = ClothMaterial {
        stretch_compliance: 5.0e-4,
        shear_compliance: 1.0e-2,
        ..ClothMaterial::COTTON
    };
    let (strength, length) = (100.0, 0.75);
    let softer = ClothMaterialMap {
        stretch: ClothFactor::of(0.5),
        ..default()
    };
    let stiffening = Some(ClothStiffening {
        strain: 0.02,
        factor: 5.0,
    });
    // 0.05 without either; 0.02 + 0.03 / 5 with a knee.
    for (map, stiffening, strain) in [(softer, None, 0.1), (default(), stiffening, 0.026)] {
        let material = ClothMaterial {
            stiffening,
            ..material
        };
        let strip = Cloth::new(8, 16, 0.05).flat();
        let strip = (strip, material, map, ClothTearing::new(strength));
        let expected = strain * length;
        let (_, found) = elongation_at_tear(&mut app(), strip, length, expected);
        assert!((found / expected - 1.0).abs() < 0.05, "{found} {expected}");
    }
}

/// Irregular meshes that a dense part hangs from tear within 6 % of their strength by default, while gravity grows slowly until they are in
/// two; under their own weight they may hold a little longer. At rest a patch bears some 5 % more or less than the mean, see `cloth/stress.rs`. They hang with their own weight alone, or with a part at their end
/// that is ten or a hundred times as dense. What counts is the weight below the first edge that tears. Under their own weight, a patch at
/// the upper border bears what hangs 0.8 σ lower, with a reach of σ = √(2n/3) spacings for n rings: they may hold by so much more. Damping
/// leaves some motion: without any, a weight would sink behind gravity. The finest meshes run where tests run at their full length.
#[test]
fn a_mesh_tears_at_its_strength() {
    let material = ClothMaterial {
        stretch_compliance: 5.0e-4,
        shear_compliance: 1.0e-2,
        damping: 0.9,
        ..ClothMaterial::COTTON
    };
    let meshes = [
        (0.1, 0.15, 4.0),
        (0.1, 0.3, 4.0),
        (0.05, 0.15, 7.0),
        (0.05, 0.3, 7.0),
        (0.025, 0.3, 12.0),
    ];
    for ((spacing, jitter, rings), dense) in meshes
        .into_iter()
        .flat_map(|mesh| [0.0, 9.0, 99.0].map(|dense| (mesh, dense)))
    {
        if spacing < 0.05 && !is_long() {
            continue;
        }
        let [begins, apart] = load_at_tear(&material, (spacing, jitter), dense);
        let reach = (2.0 * rings / 3.0_f32).sqrt() * spacing;
        // The part of the weight above the lower end, of which the patch misses as much as it reaches down.
        let own = 0.9 / (0.9 + 0.1 * (1.0 + dense));
        let allowed = 0.94..1.06 + 0.8 * reach * own;
        assert!(allowed.contains(&begins), "{begins} {allowed:?}");
        assert!(apart < 1.2 * allowed.end, "{apart}");
    }
}

/// Hangs an irregular mesh with this spacing and jitter, whose lower end is denser by so many times. Returns the load at which it begins
/// to tear, and that at which it is in two, as parts of its strength.
fn load_at_tear(material: &ClothMaterial, (spacing, jitter): (f32, f32), dense: f32) -> [f32; 2] {
    let strength = 100.0;
    let strip = irregular(0.4, 1.0, spacing, jitter);
    let weight = ClothPaint::at_rest(move |place| if place.y < -0.89 { dense } else { 0.0 });
    let mut app = app();
    app.insert_resource(ClothGravity(Vec3::ZERO));
    let parts = (
        Cloth::triangles(strip.positions, strip.triangles).flat(),
        top(),
        *material,
        ClothMaterialMap {
            density: ClothFactor::added(weight),
            ..default()
        },
        ClothTearing::new(strength),
    );
    let cloth = app.world_mut().spawn(parts).id();
    tick(&mut app, 1);
    let mass = motion(&app, cloth).0 as f32;
    let most = strength * 0.4 / mass;
    let (mut gravity, mut begins) = (0.0, None);
    while surface(&app, cloth).pieces() < 2 && gravity < 1.5 * most {
        gravity += 1.0e-3 * most;
        app.insert_resource(ClothGravity(Vec3::NEG_Y * gravity));
        tick(&mut app, 1);
        if begins.is_none()
            && let Some([end, _]) = tears(&app, cloth).edges().first()
        {
            begins = Some(mass_below(&app, cloth, *end) * gravity / 0.4 / strength);
        }
    }
    let (begins, apart) = (begins.unwrap_or(f32::MAX), gravity / most);
    println!(
        "{}, moved by {jitter} spacings, {dense} times denser below, {} sub-steps: tears at {:.1} % of its strength, is in two at {:.1} %",
        surface(&app, cloth),
        stats(&app, cloth).substeps,
        100.0 * begins,
        100.0 * apart
    );
    [begins, apart]
}

/// The mass of what lies lower at rest than a particle (kg).
fn mass_below(app: &App, cloth: Entity, particle: u32) -> f32 {
    let (rest, particles) = (surface(app, cloth).rest_positions(), particles(app, cloth));
    let height = rest[particle as usize].y;
    let below = (0..rest.len()).filter(|index| rest[*index].y < height);
    let weights = below.filter_map(|index| particles.inverse_mass(index));
    weights.map(f32::recip).sum()
}

/// A slit in cloth whose threads all bear too much runs on at its two ends alone, by an edge each in a tick. The sides of it tear no
/// further.
#[test]
fn a_tear_runs_from_its_ends() {
    let mut app = app();
    let parts = (Cloth::new(21, 21, 0.1), ClothTears::default());
    let cloth = app.world_mut().spawn(parts).id();
    tick(&mut app, 60);
    let slit: Vec<[u32; 2]> = (8..12)
        .map(|column| [10 * 21 + column, 10 * 21 + column + 1])
        .collect();
    tear(&mut app, cloth, slit);
    tick(&mut app, 2);
    app.world_mut()
        .entity_mut(cloth)
        .insert(ClothTearing::new(0.01));
    for _ in 0..6 {
        let before = tears(&app, cloth).edges().len();
        tick(&mut app, 1);
        let torn = tears(&app, cloth).edges()[before..].to_vec();
        assert!((1..=2).contains(&torn.len()), "{torn:?}");
    }
}
