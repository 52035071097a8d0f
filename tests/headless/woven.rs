//! Cloth with a warp and a weft in an app: where its warp runs, what is refused, and what may change at run time.

use bevy::{
    asset::{AssetPlugin, RenderAssetUsages},
    mesh::{Indices, Mesh, MeshPlugin, PrimitiveTopology, VertexAttributeValues},
    prelude::*,
};
use bevy_drape::prelude::*;

use crate::{faults::expect_fault, support::*};

const SIDE: u32 = 9;
const SPACING: f32 = 0.1;

/// It gives eight times as much along its weft.
fn woven() -> ClothMaterial {
    ClothMaterial {
        stretch_compliance: 2.0e-3,
        shear_compliance: f32::INFINITY,
        bend_rigidity: 0.0,
        weft: Some(ClothWeft {
            stretch_compliance: 1.6e-2,
            bend_rigidity: 0.0,
        }),
        damping: 0.1,
        ..ClothMaterial::COTTON
    }
}

/// A square that hangs, of which V of the texture runs down, or across if it is turned.
fn square(is_turned: bool) -> Mesh {
    let of = |index: u32| [index % SIDE, index / SIDE].map(|at| at as f32 * SPACING);
    let places: Vec<[f32; 3]> = (0..SIDE * SIDE)
        .map(|index| {
            let [x, y] = of(index);
            [x, -y, 0.0]
        })
        .collect();
    let uvs: Vec<[f32; 2]> = (0..SIDE * SIDE)
        .map(|index| {
            let [x, y] = of(index);
            if is_turned { [-y, x] } else { [x, y] }
        })
        .collect();
    let mut indices = Vec::new();
    for row in 0..SIDE - 1 {
        for column in 0..SIDE - 1 {
            let a = row * SIDE + column;
            let (b, c, d) = (a + 1, a + SIDE, a + SIDE + 1);
            indices.extend([a, c, b, b, c, d]);
        }
    }
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::all())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, places)
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
        .with_inserted_indices(Indices::U32(indices))
}

fn app_with_meshes() -> App {
    let mut app = with_plugins((AssetPlugin::default(), MeshPlugin, DrapePlugins::default()));
    app.finish();
    app
}

fn top() -> Pins {
    Pins::new([Pin::at_rest(|place| place.y > -1.0e-4)])
}

/// How far below its place the lower edge of a square is (m).
fn sag(app: &App, cloth: Entity) -> f32 {
    let particles = particles(app, cloth);
    let lowest = particles.positions().map(|place| place.y);
    -lowest.fold(0.0, f32::min) - (SIDE - 1) as f32 * SPACING
}

/// α ρ g L²/2 (m).
fn exact(compliance: f32) -> f32 {
    let length = (SIDE - 1) as f32 * SPACING;
    compliance * woven().areal_density * 9.81 * length * length / 2.0
}

fn spawn(app: &mut App, mesh: Mesh, more: impl Bundle) -> Entity {
    let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
    let cloth = (Cloth::mesh(), Mesh3d(handle), woven(), top(), more);
    app.world_mut().spawn(cloth).id()
}

/// By its texture, whichever way that lies; by an axis; turned from either; painted. A mesh draws in at its sides and is
/// clamped at its top, which is a few per cent.
#[test]
fn the_warp_runs_where_the_texture_or_the_game_says() {
    let mut app = app_with_meshes();
    let quarter = std::f32::consts::FRAC_PI_2;
    let painted = ClothPaint::vertices(vec![quarter; (SIDE * SIDE) as usize]);
    let along_warp = [
        spawn(&mut app, square(false), ()),
        spawn(&mut app, square(true), ClothGrain::along(Vec3::Y)),
        spawn(
            &mut app,
            square(true),
            ClothGrain::default().turned(-quarter),
        ),
    ];
    let along_weft = [
        spawn(&mut app, square(true), ()),
        spawn(&mut app, square(false), ClothGrain::along(Vec3::X)),
        spawn(
            &mut app,
            square(false),
            ClothGrain::default().turned(painted),
        ),
    ];
    tick(&mut app, 500);
    for (cloths, compliance) in [(along_warp, 2.0e-3), (along_weft, 1.6e-2)] {
        for cloth in cloths {
            let (found, exact) = (sag(&app, cloth), exact(compliance));
            println!(
                "{:.2} mm, closed form {:.2} mm",
                1.0e3 * found,
                1.0e3 * exact
            );
            assert!((found / exact - 1.0).abs() < 0.1, "{found} {exact}");
        }
    }
}

/// Another grain, another weft, or none: at rest or not, the particles stay, and the cloth goes to where it should hang.
#[test]
fn grain_and_weft_may_change_at_run_time() {
    let mut app = app_with_meshes();
    let cloth = spawn(&mut app, square(false), ());
    let grid = Cloth::new(SIDE, SIDE, SPACING);
    let grid = app.world_mut().spawn((grid, woven(), Pins::default())).id();
    tick(&mut app, 500);
    assert!((sag(&app, cloth) / exact(2.0e-3) - 1.0).abs() < 0.1);
    type Change = fn(&mut App, Entity);
    let changes: [(Change, f32); 5] = [
        (
            |app, cloth| {
                app.world_mut()
                    .entity_mut(cloth)
                    .insert(ClothGrain::along(Vec3::X));
            },
            1.6e-2,
        ),
        (
            |app, cloth| change::<ClothMaterial>(app, cloth, |material| material.weft = None),
            2.0e-3,
        ),
        (
            |app, cloth| change::<ClothMaterial>(app, cloth, |material| *material = woven()),
            1.6e-2,
        ),
        (
            |app, cloth| {
                app.world_mut().entity_mut(cloth).remove::<ClothGrain>();
            },
            2.0e-3,
        ),
        (
            |app, cloth| {
                change::<ClothMaterial>(app, cloth, |material| {
                    material.stretch_compliance = 1.0e-2;
                });
            },
            1.0e-2,
        ),
    ];
    for (at, (apply, compliance)) in changes.into_iter().enumerate() {
        // It moves by its velocity across, 1 m/s, and not to where it rests: a tick of 1/64 s takes it 16 mm, less damping.
        change::<ClothParticles>(&mut app, cloth, |particles| {
            for index in 0..particles.len() {
                particles.set_velocity(index, Vec3::Z).expect("a particle");
            }
        });
        apply(&mut app, cloth);
        tick(&mut app, 1);
        let farthest = particles(&app, cloth).positions().map(|place| place.z);
        let farthest = farthest.fold(0.0, f32::max);
        assert!((0.01..0.02).contains(&farthest), "{at}: {farthest}");
        tick(&mut app, 500);
        let (found, exact) = (sag(&app, cloth), exact(compliance));
        assert!((found / exact - 1.0).abs() < 0.1, "{at}: {found} {exact}");
    }
    // A grid's warp is that of its columns, whatever its grain.
    let before = sag(&app, grid);
    assert!((before / exact(2.0e-3) - 1.0).abs() < 0.02, "{before}");
    app.world_mut()
        .entity_mut(grid)
        .insert(ClothGrain::along(Vec3::ZERO));
    tick(&mut app, 50);
    assert_eq!(sag(&app, grid), before);
}

/// A grid has a grain of its own.
fn mend(app: &mut App, entity: Entity) {
    change::<Cloth>(app, entity, |cloth| *cloth = default());
}

fn triangles() -> Cloth {
    let places = [Vec3::ZERO, Vec3::X, Vec3::NEG_Y, Vec3::new(1.0, -1.0, 0.0)];
    Cloth::triangles(places, [[0, 2, 1], [1, 2, 3]])
}

#[test]
fn a_grain_that_cannot_be() {
    for axis in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
        expect_fault(
            (triangles(), woven(), ClothGrain::along(axis), Pins::none()),
            |_, _| {},
            |error| matches!(error, ClothError::Grain(GrainError::Axis { .. })),
            mend,
        );
    }
    for turn in [-1.0, f32::NAN, f32::INFINITY] {
        let grain = ClothGrain {
            turn: ClothPaint::Uniform(turn),
            ..ClothGrain::along(Vec3::X)
        };
        expect_fault(
            (triangles(), woven(), grain, Pins::none()),
            |_, _| {},
            |error| error.quantity().is_some(),
            mend,
        );
    }
    let grain = ClothGrain::along(Vec3::X).turned(ClothPaint::vertices([0.0; 3]));
    expect_fault(
        (triangles(), woven(), grain, Pins::none()),
        |_, _| {},
        |error| matches!(error, ClothError::Paint(PaintError::Count { .. })),
        mend,
    );
    // Without a texture, and without an axis.
    expect_fault(
        (triangles(), woven(), Pins::none()),
        |_, _| {},
        |error| matches!(error, ClothError::Grain(GrainError::NeedsUvs)),
        mend,
    );
}

/// Without texture coordinates, and with some that are folded: named, and mended by an axis.
#[test]
fn a_texture_that_has_no_direction() {
    let mut app = app_with_meshes();
    let mut none = square(false);
    none.remove_attribute(Mesh::ATTRIBUTE_UV_0);
    let mut folded = square(false);
    if let Some(VertexAttributeValues::Float32x2(uvs)) = folded.attribute_mut(Mesh::ATTRIBUTE_UV_0)
    {
        // The corners of the first cell lie in one place.
        for vertex in [0, 1, SIDE, SIDE + 1] {
            uvs[vertex as usize] = [0.5, 0.5];
        }
    }
    let cloths = [none, folded].map(|mesh| spawn(&mut app, mesh, ()));
    tick(&mut app, 5);
    let fault = |app: &App, cloth| {
        let fault = app.world().get::<ClothFault>(cloth);
        fault.map(|fault| fault.error.clone())
    };
    assert_eq!(
        fault(&app, cloths[0]),
        Some(ClothError::Grain(GrainError::NeedsUvs))
    );
    let Some(ClothError::Grain(GrainError::FoldedUvs { triangle })) = fault(&app, cloths[1]) else {
        panic!("{:?}", fault(&app, cloths[1]));
    };
    // Those with two or three of these corners.
    assert!([0, 1, 2, 16].contains(&triangle), "{triangle}");
    for cloth in cloths {
        app.world_mut()
            .entity_mut(cloth)
            .insert(ClothGrain::along(Vec3::Y));
    }
    tick(&mut app, 5);
    for cloth in cloths {
        assert_eq!(fault(&app, cloth), None);
    }
}
