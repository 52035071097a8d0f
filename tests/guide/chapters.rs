//! The programs of the guide's first chapters.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use super::{RunSystemOnce, app, run};

/// Where particles are in the world, of the only cloth.
fn places(app: &mut App) -> Vec<Vec3> {
    let mut cloths = app.world_mut().query::<(&ClothParticles, &ClothFrame)>();
    let (particles, frame) = cloths.single(app.world()).expect("one cloth");
    particles.positions().map(|at| frame.to_world(at)).collect()
}

/// The figures of the only cloth.
fn stats(app: &mut App) -> ClothStats {
    let mut stats = app.world_mut().query::<&ClothStats>();
    *stats.single(app.world()).expect("one cloth")
}

mod sheet {
    include!("sheet.rs");

    #[test]
    fn the_sheet_lies_on_the_ball() {
        let mut app = super::app(setup, |app: &mut App| {
            app.add_systems(FixedPostUpdate, report);
        });
        super::run(&mut app, 1.0);
        let middle = super::places(&mut app)[12 * 24 + 12];
        assert!(middle.y > 1.0 && middle.y < 1.1, "{middle}");
    }
}

mod banner {
    include!("banner.rs");

    #[test]
    fn the_banner_hangs_and_hardly_stretches() {
        let mut app = super::app(banner, |_: &mut App| {});
        super::run(&mut app, 0.5);
        assert_eq!(super::places(&mut app).len(), 22 * 22);
        assert!(super::stats(&mut app).stretch.structural < 0.05);
    }
}

mod painted {
    include!("painted.rs");

    /// It hangs by its waist, and weighs three times as much below as in its middle.
    #[test]
    fn the_apron_is_heavy_below() {
        let mut app = super::app(apron, |_: &mut App| {});
        super::run(&mut app, 0.5);
        let mut cloths = app.world_mut().query::<(&ClothParticles, &ClothBuilt)>();
        let (particles, built) = cloths.single(app.world()).expect("the apron");
        let surface = built.surface();
        assert_eq!(surface.len(), 22 * 22);
        let mass_over_area = |near: Vec3| {
            let rest = surface.rest_positions();
            let at = rest.iter().position(|place| place.distance(near) < 0.06);
            let at = at.expect("a particle");
            1.0 / particles.inverse_mass(at).expect("it exists") / surface.area_of(at)
        };
        let [middle, below] = [0.0, -0.8].map(|y| mass_over_area(Vec3::new(0.0, y, 0.0)));
        assert!((below / middle - 3.0).abs() < 1.0e-3, "{below} {middle}");
    }
}

mod scene {
    include!("scene.rs");

    use bevy::world_serialization::WorldSerializationPlugin;
    use bevy_drape::prelude::*;
    use std::{thread::sleep, time::Duration};

    #[test]
    fn the_scene_file_holds_a_flag() {
        let mut app = super::app(scene, |app: &mut App| {
            app.add_plugins(WorldSerializationPlugin);
        });
        for _ in 0..1000 {
            let mut cloths = app.world_mut().query::<&ClothParticles>();
            if cloths.iter(app.world()).any(|each| !each.is_empty()) {
                break;
            }
            sleep(Duration::from_millis(10));
            app.update();
        }
        super::run(&mut app, 0.5);
        assert!(!super::places(&mut app).is_empty());
        assert!(app.world().contains_resource::<ClothWind>());
    }
}

mod coat {
    include!("coat.rs");

    /// Bones may come later: nothing is at fault without them. A mesh of that name becomes cloth, or a collider.
    #[test]
    fn a_hero_without_a_skeleton_is_no_fault_and_the_coat_is_cloth() {
        let mut app = super::app(hero, |_: &mut App| {});
        let world = app.world_mut();
        let mesh = world.spawn_empty().id();
        make_cloth(&Name::new("coat"), mesh, &mut world.commands());
        world.flush();
        assert!(world.entity(mesh).contains::<ClothSkin>());
        make_cloth(&Name::new("body"), mesh, &mut world.commands());
        world.flush();
        assert!(world.entity(mesh).contains::<ClothCollider>());
        world.despawn(mesh);
        super::run(&mut app, 0.1);
    }
}

mod far_away {
    include!("far_away.rs");
    use super::RunSystemOnce;

    #[test]
    fn distant_cloth_is_frozen() {
        let mut app = super::app(far_away, |_: &mut App| {});
        let at = Transform::from_xyz(0.0, 0.0, 100.0);
        app.world_mut().spawn((Camera3d::default(), at));
        app.world_mut().spawn(Cloth::new(8, 8, 0.1).lying());
        super::run(&mut app, 1.0);
        // What is frozen does not fall.
        let lowest = super::places(&mut app)
            .iter()
            .map(|at| at.y)
            .fold(f32::MAX, f32::min);
        assert!(lowest > -0.1, "{lowest}");
        app.world_mut()
            .run_system_once(|mut commands: Commands| {
                commands.remove_resource::<GlobalClothLod>();
            })
            .expect("a system");
        super::run(&mut app, 1.0);
        let lowest = super::places(&mut app)
            .iter()
            .map(|at| at.y)
            .fold(f32::MAX, f32::min);
        assert!(lowest < -0.3, "{lowest}");
    }
}

mod fan {
    include!("fan.rs");

    /// The fan is no fault, and the air of a vehicle takes its velocity.
    #[test]
    fn the_fan_blows_and_the_vehicle_takes_its_air_along() {
        let mut app = super::app(fan, |app: &mut App| {
            app.add_systems(FixedFirst, ride);
        });
        let ridden = (
            Cloth::new(8, 8, 0.1),
            ClothAir::default(),
            InVehicle(Vec3::X * 20.0),
        );
        let ridden = app.world_mut().spawn(ridden).id();
        super::run(&mut app, 0.2);
        let air = app.world().get::<ClothAir>(ridden).expect("its air");
        assert_eq!(air.velocity, Some(Vec3::X * 20.0));
        let mut zones = app.world_mut().query::<&ClothWindZone>();
        assert_eq!(zones.iter(app.world()).count(), 1);
    }
}

#[expect(clippy::unwrap_used, reason = "it stands so in the guide")]
mod beach_ball {
    include!("beach_ball.rs");

    #[test]
    fn the_beach_ball_is_as_large_as_its_gas() {
        let mut app = super::app(beach_ball, |_: &mut App| {});
        super::run(&mut app, 4.0);
        for _ in 0..64 {
            super::run(&mut app, 1.0 / 64.0);
            let stats = super::stats(&mut app);
            assert!((stats.enclosed_volume / (0.9 * 0.0141) - 1.0).abs() < 0.01);
        }
    }
}

mod stats_report {
    include!("stats.rs");

    #[test]
    fn the_report_runs() {
        let spawn = |mut commands: Commands| {
            commands.spawn((Name::new("curtain"), Cloth::new(20, 20, 0.05)));
        };
        let mut app = super::app(spawn, |app: &mut App| {
            app.add_systems(Last, report);
        });
        super::run(&mut app, 0.1);
        assert!(super::stats(&mut app).substeps > 0);
    }
}

mod faults {
    include!("faults.rs");
    use super::RunSystemOnce;

    #[test]
    fn a_corrected_cloth_comes_back() {
        let spawn = |mut commands: Commands| {
            commands.spawn((Name::new("sail"), Cloth::new(10, 10, -0.1)));
        };
        let mut app = super::app(spawn, |_: &mut App| {});
        app.update();
        let mut faults = app.world_mut().query::<&ClothFault>();
        let fault = faults.single(app.world()).expect("a fault");
        assert_eq!(
            fault.error.to_string(),
            "spacing (m) must be positive, not -0.1"
        );
        app.world_mut().run_system_once(mend).expect("a system");
        super::run(&mut app, 0.1);
        assert_eq!(super::places(&mut app).len(), 100);
    }
}

mod silk_flag {
    include!("silk_flag.rs");

    #[test]
    fn the_flag_has_its_pins() {
        let mut app = super::app(flag, |_: &mut App| {});
        super::run(&mut app, 0.1);
        let mut particles = app.world_mut().query::<&ClothParticles>();
        let particles = particles.single(app.world()).expect("one cloth");
        let pinned = particles.inverse_masses().filter(|mass| *mass == 0.0);
        assert_eq!(pinned.count(), 17);
    }
}
