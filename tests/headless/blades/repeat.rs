//! Torn cloth that repeats, is saved, and lies on itself.

use super::*;

/// Strips tear under a weight that grows until they are in two, by 0.4 % of their strength in a tick. Two apps, one of which runs on all
/// threads, send the same messages in the same ticks, and agree to the bit. Each message names a place less than a spacing from a part of
/// the edges that it counts, as the tick ends, and the number of pieces. The last says two of the grid. From a mesh, a face may come off as well.
#[test]
fn tears_under_load_repeat_to_the_bit() {
    for (strip, most) in [(Cloth::new(9, 21, 0.05), 2), (mesh(0.4, 1.0, 0.1), 3)] {
        let mut apps = [app_in_space(), app_in_space()];
        run_on_all_threads(&mut apps[1]);
        let [cloth, _] = apps.each_mut().map(|app| {
            let mut map = ClothMaterialMap::default();
            map.density.paint = ClothPaint::at_rest(|at| if at.y < -0.89 { 99.0 } else { 0.0 });
            let strip = (strip.clone().flat(), top(), threads(5.0e-4, 0.9), map);
            spawn(app, (strip, ClothTearing::new(100.0)))
        });
        let (mut ratio, mut known, mut last) = (0.0_f32, 0, 0);
        while last < 2 && ratio < 1.5 {
            let [told, same] = apps.each_mut().map(|app| {
                let free = particles(app, cloth).inverse_masses().filter(|w| *w > 0.0);
                let mass: f32 = free.map(f32::recip).sum();
                let gravity = ratio * 100.0 * 0.4 / mass.max(0.1);
                app.insert_resource(ClothGravity(Vec3::NEG_Y * gravity));
                tick(app, 1);
                messages::<ClothTorn>(app)
            });
            ratio += 4.0e-3;
            let [one, other] = &apps;
            assert_eq!(told, same);
            assert!(particles(one, cloth) == particles(other, cloth));
            for torn in told {
                let edges = &tears(one, cloth).edges()[known..known + torn.edges];
                let (after, surface) = (particles(one, cloth), surface(one, cloth));
                let is_torn = |part: &usize| {
                    let origin = surface.origin_of(*part as u32);
                    edges.iter().flatten().any(|end| *end == origin)
                };
                let far = |part| the(after.position(part)).distance(torn.place);
                let parts = (0..after.len()).filter(is_torn);
                let nearest = parts.map(far).fold(f32::MAX, f32::min);
                assert!(nearest < surface.spacing().longest, "{nearest}");
                (known, last) = (known + torn.edges, torn.pieces);
                assert_eq!(last, surface.pieces());
            }
        }
        assert!((2..=most).contains(&last), "{last} pieces");
    }
}

/// A flag with a slit, a hem with another that is sewn to it, the seam, and a hand that holds the flag.
fn spawn_sewn(app: &mut App) -> [Entity; 4] {
    let slit = |edges: [[u32; 2]; 2]| {
        let mut tears = ClothTears::default();
        assert_eq!(tears.tear_all(edges), 2);
        (tears, ClothTearing::new(700.0), ClothCreasing::LEATHER)
    };
    let flag = (Cloth::new(9, 9, 0.1), slit([[36, 37], [37, 38]]));
    let flag = spawn(app, (Name::new("flag"), flag));
    let below = (Transform::from_xyz(0.0, -0.8, 0.0), Pins::none());
    let hem = (Cloth::new(9, 4, 0.1), below, slit([[9, 10], [10, 11]]));
    let hem = spawn(app, (Name::new("hem"), hem));
    let seam = spawn(app, ClothSeam::new((flag, Pin::Row(8)), (hem, Pin::Row(0))));
    let hand = spawn(app, ClothGrab::default());
    let mut grab = the(app.world_mut().get_mut::<ClothGrab>(hand));
    (grab.cloth, grab.particle, grab.target) = (flag, 60, Vec3::new(0.6, -0.6, 0.0));
    [flag, hem, seam, hand]
}

/// An app with these entities, by a scene file, and others.
fn reloaded(app: &App, entities: [Entity; 4]) -> (App, [Entity; 4]) {
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let scene = DynamicWorldBuilder::from_world(app.world(), &registry);
    // Bevy's own, which is not text.
    let scene = scene.deny_component::<VisibilityClass>();
    let scene = scene.extract_entities(entities.into_iter()).build();
    let text = the(scene.serialize(&registry).ok());
    let mut other = app_with_assets();
    (0..50).for_each(|_| _ = spawn(&mut other, ()));
    let mut server = other.world().resource::<AssetServer>();
    let scene = WorldDeserializer {
        type_registry: &registry,
        load_from_path: &mut server,
    };
    let text = &mut ron::de::Deserializer::from_str(&text).expect("RON");
    let scene = scene.deserialize(text).expect("a scene");
    let mut map = EntityHashMap::default();
    the(scene.write_to_world(other.world_mut(), &mut map).ok());
    (other, entities.map(|entity| map[&entity]))
}

/// Tears, strengths, creasing, seams and hands go through a scene file, with the entities that they name. Loaded before their first tick,
/// cloths move on to the bit as in the first app. Saved as they hang there, they are torn alike where they were.
#[test]
fn torn_sewn_and_held_cloths_are_scenes() {
    for ticks in [0, 40] {
        let mut app = app_with_assets();
        let entities = spawn_sewn(&mut app);
        tick(&mut app, ticks);
        let (mut other, read) = reloaded(&app, entities);
        let places = |app: &App, of| particles(app, of).positions().collect::<Vec<_>>();
        for at in [0, 1] {
            assert_eq!(places(&other, read[at]), places(&app, entities[at]));
        }
        tick(&mut app, 40);
        tick(&mut other, 40);
        for at in [0, 1] {
            let [now, then] = [(&other, read[at]), (&app, entities[at])].map(|(app, cloth)| {
                let (of, surface) = (app.world().entity(cloth), surface(app, cloth));
                let tearing = of.get::<ClothTearing>().copied();
                let creasing = of.get::<ClothCreasing>().copied();
                let size = (surface.len(), surface.pieces());
                (tears(app, cloth).clone(), tearing, creasing, size)
            });
            assert_eq!(now, then);
            let is_same = particles(&other, read[at]) == particles(&app, entities[at]);
            assert!(is_same || ticks > 0);
        }
        let [flag, hem, seam, hand] = read.map(|entity| other.world().entity(entity));
        let sewn = the(seam.get::<ClothSeam>());
        assert_eq!(sewn.first.cloth, ClothTarget::from(flag.id()));
        assert_eq!(sewn.second.cloth, ClothTarget::from(hem.id()));
        assert_eq!(the(hand.get::<ClothGrab>()).cloth, flag.id());
        let held = the(flag.get::<ClothParticles>());
        assert!(held.is_pinned(60) == Some(true) && held.len() > 81);
        let mut all = [flag, hem, seam, hand].into_iter();
        assert!(all.all(|entity| !entity.contains::<ClothFault>()));
    }
}

/// Cloth with five random cuts falls on a ball. Every tree finds what brute force finds, and every search leads to the bits of testing each
/// particle. The paper's rule is among them: over what is torn, the rest shape takes its place.
#[test]
fn a_torn_cloth_is_searched_as_by_brute_force() {
    let narrow_phases = [NarrowPhase::Particles, NarrowPhase::Triangles];
    for (sheet, narrow_phase) in sheets().into_iter().zip(narrow_phases) {
        let run = |method: SearchMethod| {
            let mut app = app();
            spawn(&mut app, ClothCollider::ball(0.35));
            let how = (method, narrow_phase, flat(-0.58, 0.45, -0.61));
            let cloth = (sheet.clone(), Pins::none(), ClothTears::default(), how);
            let cloth = spawn(&mut app, cloth);
            tick(&mut app, 2);
            let mut random = Random(17);
            for _ in 0..5 {
                let [middle, along, across] = [(); 3].map(|()| 0.8 * random.place());
                let middle = 0.5 * middle + Vec3::Y * 0.45;
                let blade = |side: f32| [-1.0, 1.0].map(|end| middle + end * along + side * across);
                sweep(&mut app, blade(-1.0), blade(1.0));
            }
            let (mut contacts, mut query) = (0, TopDownQuery::default());
            for _ in 0..60 {
                tick(&mut app, 1);
                contacts += stats(&app, cloth).contacts;
                let cloth = app.world().entity(cloth);
                let built = the(cloth.get::<ClothBuilt>());
                let particles = the(cloth.get::<ClothParticles>());
                let centre = the(cloth.get::<ClothFrame>()).from_world(Vec3::ZERO);
                let probe = Probe::ball(centre, 0.35, 0.02);
                if let SearchMethod::Tree(volume, rule) = method {
                    let stretch = Stretch::measure(built.springs(), particles).bound;
                    let (mut bounds, tree) = (NodeBounds::default(), built.tree());
                    let rebuilt = bounds.rebuild((volume, rule), tree, particles, stretch);
                    assert_eq!(rebuilt, Ok(()), "{method}");
                    query.clear();
                    query.search(tree, &bounds, particles, &probe);
                    let mut found = query.candidates().to_vec();
                    found.sort_unstable();
                    assert_eq!(found, brute_force(particles, &probe), "{method}");
                }
            }
            assert!(contacts > 100 && tears(&app, cloth).edges().len() > 10);
            particles(&app, cloth).clone()
        };
        let truth = run(SearchMethod::Scan);
        let is_same = SearchMethod::ALL.map(|method| (run(method) == truth, method));
        assert!(is_same.iter().all(|(is_same, _)| *is_same), "{is_same:?}");
    }
}

/// A cut cloth lies on a plane. One of its pieces is put 6 cm above the other, 2 cm aside, and falls on it: they collide as two cloths do. No
/// triangles cross in any tick. In the mean the upper one comes to lie at least half a thickness higher: a whole one, less what hangs
/// over the other's border.
#[test]
fn a_piece_lies_on_another() {
    let mut app = app();
    spawn(&mut app, ClothCollider::plane());
    let layers = ClothSelfCollision::default();
    let cloth = (
        Cloth::new(9, 17, 0.05),
        Pins::none(),
        layers,
        flat(0.0, 0.02, 0.0),
    );
    let cloth = spawn(&mut app, (cloth, ClothTears::default()));
    tick(&mut app, 40);
    assert_eq!(tear(&mut app, cloth, (72..80).map(|at| [at, at + 1])), 8);
    tick(&mut app, 2);
    // At rest, both pieces are a little apart.
    let rest = surface(&app, cloth).rest_positions().to_vec();
    let is_upper = |index: usize| rest[index].y < -0.4;
    // The cloth's own z is the world's y, and its y the world's −z.
    each(&mut app, cloth, |particles, index| {
        let aside = Vec3::new(0.013, 0.383, 0.06) * f32::from(is_upper(index));
        let place = the(particles.position(index)) + aside;
        the(particles.set_position(index, place).ok());
    });
    for number in 0..150 {
        tick(&mut app, 1);
        assert_eq!(crossings(&app, cloth), 0, "tick {number}");
    }
    assert_sound(&app, cloth);
    let all = particles(&app, cloth).positions().enumerate();
    let (above, below): (Vec<_>, Vec<_>) = all.partition(|(index, _)| is_upper(*index));
    let [above, below] = [above, below].map(|of| {
        assert_eq!(of.len(), 81);
        of.iter().map(|(_, place)| place.z).sum::<f32>() / 81.0
    });
    assert!(
        above - below > 0.5 * layers.thickness,
        "{above} m, {below} m"
    );
}

/// A ball takes one piece of a cut cloth along. The other one rings from the cut to the bit as without the ball: nothing joins them any more.
/// That holds where a piece shares nothing with the rest of its cloth: without damping, whose frame is that of all particles. It takes a fixed
/// number of sub-steps of first order, as a push anywhere takes all of a cloth to first order for a while.
#[test]
fn a_ball_moves_one_piece_alone() {
    let (mut material, mut settings) = (solved_once(), ClothSettings::substeps(16));
    (material.bend_rigidity, material.damping) = (0.0, 0.0);
    (settings.order, settings.sleeps) = (TimeOrder::First, false);
    for sheet in sheets() {
        let [(pushed, rest), (free, _)] = [-0.95, 9.0].map(|height| {
            let mut app = app_in_space();
            let how = (material, settings, Pins::none());
            let cloth = spawn(&mut app, (sheet.clone(), how, ClothTears::default()));
            let place = Transform::from_xyz(0.6, height, -0.5);
            spawn(&mut app, (ClothCollider::ball(0.15), Moving(1.0), place));
            tick(&mut app, 1);
            assert!(cut_at(&mut app, -0.63) > 6);
            tick(&mut app, 40);
            assert_eq!(surface(&app, cloth).pieces(), 2);
            let rest = surface(&app, cloth).rest_positions().to_vec();
            (particles(&app, cloth).clone(), rest)
        });
        let of = |all: &ClothParticles, index: usize| (all.position(index), all.velocity(index));
        let is_moved = |index: &usize| of(&pushed, *index) != of(&free, *index);
        let moved: Vec<usize> = (0..rest.len()).filter(is_moved).collect();
        // A mesh is cut within a spacing of the blade.
        assert!(moved.len() > 10 && moved.iter().all(|index| rest[*index].y < -0.52));
    }
}
