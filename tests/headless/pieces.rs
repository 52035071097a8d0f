//! Pieces of torn cloth: one that has come to rest sleeps, while others move.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::{shared_meshes::irregular, support::*, tears::cut_at};

const FLOOR: f32 = -1.5;

/// A banner that hangs from a pole to and fro, over a floor.
struct Banner {
    app: App,
    cloth: Entity,
    pole: Entity,
    floor: Entity,
    ticks: u32,
    /// The middle of the pole's way (m).
    middle: f32,
}

/// The banner of this shape and material, cut in two, `with` parts that it may need.
fn cut(shape: Cloth, with: impl Bundle) -> Banner {
    let mut app = app();
    let pole = app.world_mut().spawn(Transform::default()).id();
    let floor = (ClothCollider::plane(), Transform::from_xyz(0.0, FLOOR, 0.0));
    let floor = app.world_mut().spawn(floor).id();
    let hung = Pin::at_rest(|place| place.y > -0.01);
    let parts = (
        ClothAttachments::new([(hung, pole)]),
        ClothTears::default(),
        ClothMaterial {
            damping: 0.1,
            ..ClothMaterial::COTTON
        },
        Pins::none(),
        with,
    );
    let cloth = app.world_mut().spawn((shape, parts)).id();
    let mut banner = Banner {
        app,
        cloth,
        pole,
        floor,
        ticks: 0,
        middle: 0.0,
    };
    banner.tick(8);
    assert!(cut_at(&mut banner.app, -0.55) > 0);
    banner
}

fn grid() -> Cloth {
    Cloth::new(9, 12, 0.1)
}

fn mesh() -> Cloth {
    let mut mesh = irregular(0.8, 1.1, 0.1, 0.2);
    let top = mesh
        .positions
        .iter()
        .fold(f32::MIN, |top, at| top.max(at.y));
    mesh.positions.iter_mut().for_each(|at| at.y -= top);
    Cloth::triangles(mesh.positions, mesh.triangles)
}

impl Banner {
    fn tick(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.ticks += 1;
            let along = self.middle + 0.1 * (0.1 * self.ticks as f32).sin();
            change::<Transform>(&mut self.app, self.pole, |pole| pole.translation.z = along);
            tick(&mut self.app, 1);
        }
    }

    fn sleeping(&self) -> usize {
        stats(&self.app, self.cloth).sleeping_particles
    }

    /// Ticks until the lower piece sleeps. Returns its particles.
    fn fall_asleep(&mut self) -> Vec<usize> {
        let sleeps = (0..64 * 20).any(|_| {
            self.tick(1);
            self.sleeping() > 0
        });
        assert!(sleeps, "{:?}", stats(&self.app, self.cloth));
        let places = particles(&self.app, self.cloth).positions();
        let low = places.enumerate().filter(|(_, at)| at.y < FLOOR + 0.3);
        let low: Vec<usize> = low.map(|(index, _)| index).collect();
        assert_eq!(low.len(), self.sleeping());
        low
    }

    fn places(&self, of: &[usize]) -> Vec<Vec3> {
        let particles = particles(&self.app, self.cloth);
        of.iter()
            .map(|of| particles.position(*of).expect("it exists"))
            .collect()
    }
}

/// On grid and mesh, alone and with layers: it lies to the last bit where it fell asleep, and touches the floor. Its particles are free
/// between ticks. The other piece goes on.
#[test]
fn a_piece_sleeps_while_the_other_moves() {
    for shape in [grid(), mesh()] {
        for has_layers in [false, true] {
            let mut banner = cut(shape.clone(), ());
            if has_layers {
                let layers = ClothSelfCollision::default();
                banner
                    .app
                    .world_mut()
                    .entity_mut(banner.cloth)
                    .insert(layers);
            }
            let low = banner.fall_asleep();
            let high: Vec<usize> = (0..particles(&banner.app, banner.cloth).len())
                .filter(|index| !low.contains(index))
                .collect();
            messages::<ClothTouchStopped>(&mut banner.app);
            let before = [&low, &high].map(|of| banner.places(of));
            let mut touch = None;
            for _ in 0..100 {
                banner.tick(1);
                assert_eq!(banner.places(&low), before[0], "{has_layers}");
                assert_eq!(banner.sleeping(), low.len());
                let contacts = banner.app.world().get::<ClothContacts>(banner.cloth);
                let contact = contacts.and_then(|of| of.with(banner.floor));
                let contact = contact.expect("it lies there");
                assert!(
                    contact.particles > 0 && contact.impulse.y < 0.0,
                    "{contact:?}"
                );
                let known = *touch.get_or_insert(*contact);
                assert_eq!(*contact, known);
                let particles = particles(&banner.app, banner.cloth);
                assert!(low.iter().all(|of| particles.is_pinned(*of) == Some(false)));
                assert!(!stats(&banner.app, banner.cloth).is_asleep);
            }
            assert!(messages::<ClothTouchStopped>(&mut banner.app).is_empty());
            let moved = banner.places(&high).into_iter().zip(&before[1]);
            let farthest = moved
                .map(|(now, then)| now.distance(*then))
                .fold(0.0, f32::max);
            assert!(farthest > 0.02, "{farthest}");
        }
    }
}

/// Damping does not slow a piece without pins, and such a piece does not follow a pole that moves: its centre of mass gains g in each second, on grid
/// and mesh, and with soft springs that act by forces. Places of up to 2 m are rounded by 6·10⁻⁸ m in each of 720 sub-steps.
#[test]
fn a_piece_falls_as_if_there_was_no_damping() {
    for (shape, compliance) in [(grid(), 0.0), (grid(), 3.0e-2), (mesh(), 1.0e-4)] {
        let mut app = app();
        let pole = app.world_mut().spawn(Transform::default()).id();
        let material = ClothMaterial {
            damping: 0.3,
            stretch_compliance: compliance,
            shear_compliance: compliance,
            ..ClothMaterial::COTTON
        };
        let hung = ClothAttachments::new([(Pin::at_rest(|place| place.y > -0.01), pole)]);
        let parts = (hung, material, ClothTears::default(), Pins::none());
        let settings = ClothSettings::substeps(20);
        let cloth = (app.world_mut().spawn((shape, parts, settings))).id();
        tick(&mut app, 1);
        assert!(cut_at(&mut app, -0.55) > 0);
        let places: [Vec<Vec3>; 3] = [0, 1, 2].map(|_| {
            for _ in 0..12 {
                change::<Transform>(&mut app, pole, |pole| pole.translation.z += 0.05);
                tick(&mut app, 1);
            }
            particles(&app, cloth).positions().collect()
        });
        let particles = particles(&app, cloth);
        let low: Vec<(usize, f32)> = (0..particles.len())
            .filter(|index| places[2][*index].y < -1.0)
            .map(|index| {
                (
                    index,
                    particles.inverse_mass(index).expect("it exists").recip(),
                )
            })
            .collect();
        assert!(low.len() > 40);
        let mass: f32 = low.iter().map(|(_, mass)| mass).sum();
        let middles = places.map(|places| -> Vec3 {
            let moments = low.iter().map(|(index, mass)| *mass * places[*index]);
            moments.sum::<Vec3>() / mass
        });
        let [first, second, third] = middles;
        let gained = third - second - (second - first);
        let expected = Vec3::NEG_Y * 9.81 * (12.0 / 64.0_f32).powi(2);
        assert!(gained.distance(expected) < 5.0e-5, "{gained} {expected}");
        assert!((third - first).z.abs() < 1.0e-2, "{middles:?}");
    }
}

/// A piece wakes in the very tick in which something could move it, and stays awake. Events elsewhere let it sleep. Without a floor, it falls.
#[test]
fn whatever_would_move_a_piece_wakes_it() {
    type Wake = fn(&mut Banner, Vec3);
    let wakes: [(&str, bool, Wake); 11] = [
        ("a ball that appears", true, |banner, at| {
            let ball = (ClothCollider::ball(0.1), Transform::from_translation(at));
            banner.app.world_mut().spawn(ball);
        }),
        ("wind", true, |banner, _| {
            let wind = ClothWind {
                velocity: 0.1 * Vec3::X,
                ..default()
            };
            banner.app.insert_resource(wind);
        }),
        ("a cloth beside it, without layers", false, |banner, at| {
            let at = Transform::from_translation(at);
            banner.app.world_mut().spawn((grid(), at));
        }),
        ("a ball elsewhere", false, |banner, at| {
            let away = Transform::from_translation(at + 3.0 * Vec3::X);
            banner
                .app
                .world_mut()
                .spawn((ClothCollider::ball(0.1), away));
        }),
        ("a ball that comes", true, |banner, at| {
            let away = Transform::from_translation(at + 3.0 * Vec3::X);
            let ball = (ClothCollider::ball(0.1), away);
            let ball = banner.app.world_mut().spawn(ball).id();
            banner.tick(1);
            assert!(banner.sleeping() > 0);
            change::<Transform>(&mut banner.app, ball, |ball| ball.translation.x -= 2.5);
        }),
        ("a floor that sinks", true, |banner, _| {
            change::<Transform>(&mut banner.app, banner.floor, |at| {
                at.translation.y -= 1.0e-3;
            });
        }),
        ("a floor that is gone", true, |banner, _| {
            banner.app.world_mut().despawn(banner.floor);
        }),
        ("gravity", true, |banner, _| {
            banner.app.world_mut().resource_mut::<ClothGravity>().0.x = 0.1;
        }),
        ("its material", true, |banner, _| {
            change::<ClothMaterial>(&mut banner.app, banner.cloth, |of| of.friction = 0.1);
        }),
        ("a game's hand", true, |banner, _| {
            change::<ClothParticles>(&mut banner.app, banner.cloth, |of| {
                of.set_velocity(100, Vec3::Y).expect("a particle");
            });
        }),
        ("another tear", true, |banner, _| {
            assert!(cut_at(&mut banner.app, -0.25) > 0);
        }),
    ];
    for (name, wakes, wake) in wakes {
        let mut banner = cut(grid(), ClothAir::default());
        let low = banner.fall_asleep();
        let places = banner.places(&low);
        let middle = places.iter().sum::<Vec3>() / places.len() as f32;
        wake(&mut banner, middle);
        for _ in 0..20 {
            banner.tick(1);
            assert_eq!(banner.sleeping() == 0, wakes, "{name}");
        }
        if name == "a floor that is gone" {
            // ½ g t² of 20 ticks are 0.48 m.
            let fallen = banner.places(&low)[0].y - places[0].y;
            assert!((fallen + 0.48).abs() < 0.05, "{fallen}");
        }
    }
}

/// A collider that appears near a piece wakes it for as long as a piece has to rest; a body, which may push back, for good.
#[test]
fn no_piece_sleeps_near_a_body() {
    for is_body in [false, true] {
        let mut banner = cut(grid(), ());
        let low = banner.fall_asleep();
        let at = banner.places(&low)[0] + 0.35 * Vec3::Y;
        let ball = (ClothCollider::ball(0.1), Transform::from_translation(at));
        let mut ball = banner.app.world_mut().spawn(ball);
        if is_body {
            ball.insert(ClothBody::default());
        }
        banner.tick(1);
        assert_eq!(banner.sleeping(), 0);
        banner.tick(64 * 8);
        let expected = if is_body { 0 } else { low.len() };
        assert_eq!(banner.sleeping(), expected);
    }
}

/// On a floor that leans by 8°, which friction holds.
#[test]
fn a_piece_sleeps_on_a_slope() {
    for (shape, axis) in [(grid(), Vec3::Z), (mesh(), Vec3::ONE.normalize())] {
        let mut banner = cut(shape, ());
        change::<Transform>(&mut banner.app, banner.floor, |floor| {
            floor.rotation = Quat::from_axis_angle(axis, 8.0_f32.to_radians());
        });
        let low = banner.fall_asleep();
        let places = banner.places(&low);
        for _ in 0..200 {
            banner.tick(1);
            assert_eq!(banner.places(&low), places);
        }
        let slippery = ClothMaterial {
            friction: 0.02,
            ..ClothMaterial::COTTON
        };
        change::<ClothMaterial>(&mut banner.app, banner.cloth, |of| *of = slippery);
        banner.tick(64);
        let slid = banner.places(&low)[0].distance(places[0]);
        assert!(slid > 0.2, "{slid}");
    }
}

/// With layers, a piece does not sleep while another cloth may touch it, and sleeps once that is gone.
#[test]
fn a_cloth_that_may_touch_a_piece_wakes_it() {
    let mut banner = cut(grid(), ClothSelfCollision::default());
    let low = banner.fall_asleep();
    let at = banner.places(&low)[0] + 0.5 * Vec3::Y;
    let other = (grid().lying().centred(), ClothSelfCollision::default());
    let other = (other, Transform::from_translation(at));
    let other = banner.app.world_mut().spawn(other).id();
    banner.tick(2);
    assert_eq!(banner.sleeping(), 0);
    banner.tick(40);
    assert_eq!(banner.sleeping(), 0);
    banner.app.world_mut().despawn(other);
    assert_eq!(banner.fall_asleep().len(), low.len());
}

/// With layers, the pole lowers the upper piece onto the one that sleeps, which wakes before they touch.
#[test]
fn a_piece_that_comes_down_wakes_the_one_below() {
    let mut banner = cut(grid(), ClothSelfCollision::default());
    let low = banner.fall_asleep();
    let top = |banner: &Banner, of: &[usize]| -> f32 {
        let places = banner.places(of).into_iter();
        places.fold(f32::MIN, |top, at| top.max(at.y))
    };
    let high: Vec<usize> = (0..particles(&banner.app, banner.cloth).len())
        .filter(|index| !low.contains(index))
        .collect();
    let below = banner.places(&low).iter().map(|at| at.z).sum::<f32>() / low.len() as f32;
    for _ in 0..100 {
        banner.middle += below / 100.0;
        banner.tick(1);
    }
    assert_eq!(banner.sleeping(), low.len());
    let mut awake_at = None;
    for _ in 0..150 {
        change::<Transform>(&mut banner.app, banner.pole, |pole| {
            pole.translation.y -= 0.007;
        });
        banner.tick(1);
        if banner.sleeping() == 0 {
            let places = banner.places(&high).into_iter();
            let bottom = places.fold(f32::MAX, |bottom, at| bottom.min(at.y));
            awake_at.get_or_insert(bottom - top(&banner, &low));
        }
    }
    let gap = awake_at.expect("it is woken");
    assert!((0.0..0.2).contains(&gap), "{gap}");
}

/// A snapshot goes on to the last bit from whatever a piece does: it falls, comes to rest, or has just been woken.
#[test]
fn a_piece_that_is_awake_is_in_a_snapshot() {
    let mut banner = cut(grid(), ());
    for stage in 0..12 {
        banner.tick(23);
        if stage == 9 {
            banner.fall_asleep();
            change::<Transform>(&mut banner.app, banner.floor, |at| {
                at.translation.y -= 1.0e-3;
            });
            banner.tick(1);
        }
        let saved = ClothWorldSnapshot::of(banner.app.world_mut());
        let ticks = banner.ticks;
        let go_on = |banner: &mut Banner| -> Vec<(ClothParticles, usize)> {
            let ticks = (0..150).map(|_| {
                banner.tick(1);
                (
                    particles(&banner.app, banner.cloth).clone(),
                    banner.sleeping(),
                )
            });
            ticks.collect()
        };
        let expected = go_on(&mut banner);
        saved
            .restore(banner.app.world_mut())
            .expect("the same world");
        banner.ticks = ticks;
        assert!(go_on(&mut banner) == expected, "{stage}");
        saved
            .restore(banner.app.world_mut())
            .expect("the same world");
        banner.ticks = ticks;
    }
}

/// A snapshot of a piece that sleeps goes on to the last bit: rolled back, and in a new app from a file.
#[test]
fn a_sleeping_piece_is_in_a_snapshot() {
    let mut banner = cut(grid(), ());
    banner.fall_asleep();
    banner.tick(5);
    let saved = ClothWorldSnapshot::of(banner.app.world_mut());
    let ticks = banner.ticks;
    banner.tick(60);
    let expected = particles(&banner.app, banner.cloth).clone();
    let touches = |banner: &Banner| -> Vec<ClothContact> {
        let contacts = banner.app.world().get::<ClothContacts>(banner.cloth);
        contacts.expect("contacts").iter().copied().collect()
    };
    let (sleeping, touched) = (banner.sleeping(), touches(&banner));
    assert!(!touched.is_empty());
    assert!(sleeping > 0);
    saved
        .restore(banner.app.world_mut())
        .expect("the same world");
    banner.ticks = ticks;
    banner.tick(1);
    assert_eq!(banner.sleeping(), sleeping);
    banner.tick(59);
    assert!(*particles(&banner.app, banner.cloth) == expected);
    assert_eq!(touches(&banner), touched);
    let text = ron::to_string(&saved).expect("it can be written");
    let read: ClothWorldSnapshot = ron::from_str(&text).expect("it can be read");
    let mut fresh = cut(grid(), ());
    read.restore(fresh.app.world_mut())
        .expect("the same entities");
    fresh.ticks = ticks;
    fresh.tick(1);
    assert_eq!(fresh.sleeping(), sleeping);
    fresh.tick(59);
    assert!(*particles(&fresh.app, fresh.cloth) == expected);
    assert_eq!(touches(&fresh), touched);
}
