//! Sewn cloths that hang, and the momentum of those that fly.

use super::*;

/// A sheet hangs from another by a seam, grid from grid, mesh from grid, two columns to three: the gap is less than gravity
/// moves in a sub-step, and the seam stretches no more than the sheets do.
#[test]
fn a_sheet_hangs_from_a_sheet() {
    for (columns, is_mesh) in [(20, false), (30, false), (13, false), (20, true)] {
        let mut app = app();
        let upper = app.world_mut().spawn(Cloth::new(20, 20, 0.05)).id();
        tick(&mut app, 1);
        let first = row(&app, upper, 19);
        let (left, width) = (first[0], first[19].x - first[0].x);
        let spacing = width / (columns - 1) as f32;
        let cloth = match is_mesh {
            false => Cloth::new(columns, 20, spacing),
            true => {
                let mesh = irregular(width, 0.95, 0.05, 0.2);
                Cloth::triangles(mesh.positions, mesh.triangles)
            }
        };
        let lower = app.world_mut().spawn((cloth.clone(), Pins::none())).id();
        tick(&mut app, 1);
        // One that is held by its pins bears as much.
        let held = match is_mesh {
            false => Pins::new([Pin::Row(0)]),
            true => Pins::new([Pin::at_rest(is_top)]),
        };
        let aside = Transform::from_xyz(3.0, 0.0, 0.0);
        let alone = (cloth, held, aside);
        let alone = app.world_mut().spawn(alone).id();
        let own = places(&app, lower);
        let corner = own
            .iter()
            .fold(Vec3::new(f32::MAX, f32::MIN, 0.0), |corner, place| {
                Vec3::new(corner.x.min(place.x), corner.y.max(place.y), 0.0)
            });
        app.world_mut().entity_mut(lower).insert((
            ClothParticles::default(),
            Transform::from_translation(left - corner),
        ));
        let seam = ClothSeam::new(
            (upper, Pin::Row(19)),
            (
                lower,
                Pin::at_rest(move |place| place.y > corner.y - 1.0e-3),
            ),
        );
        sew(&mut app, seam);
        tick(&mut app, 1);
        // A sub-step lets all of the lower sheet's 19 rows fall, and then moves only half of a row, which is sewn, back. So that moves 38 times as
        // far, away from the next row. In a mesh that is 0.6 spacings away at least.
        let beside = if is_mesh { 0.6 * 0.05 } else { spacing };
        let by_seam = 38.0 * fall_in_a_substep(&app, lower) / beside;
        let rest = places(&app, lower);
        let top: Vec<usize> = {
            let highest = rest.iter().map(|place| place.y).fold(f32::MIN, f32::max);
            let mut top: Vec<usize> = (0..rest.len())
                .filter(|&index| rest[index].y > highest - 0.01)
                .collect();
            top.sort_by(|a, b| rest[*a].x.total_cmp(&rest[*b].x));
            top
        };
        let mut worst = [0.0_f32; 4];
        for step in 0..512 {
            tick(&mut app, 1);
            let own = places(&app, lower);
            let fine: Vec<Vec3> = top.iter().map(|&index| own[index]).collect();
            let hem = row(&app, upper, 19);
            // The border of an irregular mesh is not evenly spaced.
            let gap = if is_mesh {
                let at = |place: usize| (rest[top[place]].x - left.x) / width;
                (0..top.len())
                    .map(|of| along(&hem, at(of)).distance(fine[of]))
                    .fold(0.0, f32::max)
            } else {
                gap(&hem, &fine)
            };
            worst[0] = worst[0].max(gap);
            if step > 256 {
                for (place, cloth) in [upper, lower, alone].into_iter().enumerate() {
                    let stretch = stats(&app, cloth).stretch.structural;
                    worst[place + 1] = worst[place + 1].max(stretch);
                }
            }
        }
        let lowest = places(&app, lower)
            .iter()
            .map(|place| place.y)
            .fold(f32::MAX, f32::min);
        let highest = row(&app, upper, 0)[0].y;
        let length = 0.95 + if is_mesh { 0.95 } else { 19.0 * spacing };
        println!(
            "20 columns, {columns}{}: gap {:.1e} m, stretch {:.2} % above, {:.2} % below, {:.2} % alone, hangs {:.4} m of {length:.4}",
            if is_mesh { " of a mesh" } else { "" },
            worst[0],
            100.0 * worst[1],
            100.0 * worst[2],
            100.0 * worst[3],
            highest - lowest
        );
        // A mesh's vertices are matched by length, which rounds at each of them.
        let most = if is_mesh { 1.0e-3 } else { IN_A_SUBSTEP };
        assert!(worst[0] < most, "{worst:?}");
        assert!(worst[1] < 0.02, "{worst:?}");
        // The threads beside it give, too: less than a fifth of that.
        assert!(worst[2] < worst[3] + 1.2 * by_seam, "{worst:?} {by_seam}");
        assert!(
            (highest - lowest - length).abs() < 0.02,
            "{} {length}",
            highest - lowest
        );
    }
}

/// A mesh hangs from a coarser and from a finer one, and a heavy one from a light one: the gap is less than a millimetre, they
/// are as long as both, and neither reaches the limit of stretch.
#[test]
fn meshes_hang_from_meshes_and_heavy_from_light() {
    let (width, height) = (0.95, 0.95);
    for (spacings, heavier) in [
        ([0.05, 0.035], 1.0),
        ([0.035, 0.05], 1.0),
        ([0.05, 0.04], 4.0),
    ] {
        let mut app = app();
        let [upper, lower] = [0, 1].map(|place| {
            let mesh = irregular(width, height, spacings[place], 0.2);
            let pins = match place {
                0 => Pins::new([Pin::at_rest(is_top)]),
                _ => Pins::none(),
            };
            let material = ClothMaterial {
                areal_density: if place == 0 { 0.15 } else { heavier * 0.15 },
                ..default()
            };
            let at = Transform::from_xyz(0.0, -height * place as f32, 0.0);
            let cloth = Cloth::triangles(mesh.positions, mesh.triangles);
            app.world_mut().spawn((cloth, pins, material, at)).id()
        });
        let is_hem = move |rest: Vec3| is_bottom(rest, height);
        let seam = ClothSeam::new((upper, Pin::at_rest(is_hem)), (lower, Pin::at_rest(is_top)));
        let seam = sew(&mut app, seam);
        let (mut gap, mut stretch) = (0.0_f32, [0.0_f32; 2]);
        let mut substeps = [0; 2];
        for step in 0..320 {
            tick(&mut app, 1);
            let hem = line(&app, upper, is_hem, Vec3::X);
            gap = gap.max(apart(&hem, &line(&app, lower, is_top, Vec3::X)));
            for (most, cloth) in stretch.iter_mut().zip([upper, lower]) {
                *most = most.max(stats(&app, cloth).stretch.structural);
            }
            substeps[usize::from(step > 0)] = stats(&app, upper).substeps;
        }
        // A load takes more of them.
        assert!(substeps[0] < substeps[1] || heavier == 1.0, "{substeps:?}");
        let lowest = places(&app, lower).into_iter().map(|place| place.y);
        let length = -lowest.fold(f32::MAX, f32::min);
        println!(
            "{spacings:?} m, {heavier} times as heavy: gap {gap:.1e} m, stretch {stretch:.4?}, hangs {length:.4} m, {substeps:?} sub-steps"
        );
        assert!(app.world().get::<ClothFault>(seam).is_none());
        // A mesh's vertices are matched by length, which rounds at each of them.
        assert!(gap < 1.0e-3, "{gap}");
        assert!(stretch.iter().all(|most| *most < 0.15), "{stretch:?}");
        // As for sheets of grids: a per cent of both.
        assert!((length - 2.0 * height).abs() < 0.02, "{length}");
    }
}

/// Three sheets in a row hang as low as one that is as long as all of them.
#[test]
fn three_sheets_hang_as_one() {
    let hangs = |app: &App, of: Entity, row_of: usize| -row(app, of, row_of)[6].y;
    let mut single = app();
    let one = single.world_mut().spawn(Cloth::new(12, 34, 0.05)).id();
    let mut app = app();
    let three = [0.0, 0.55, 1.1].map(|below| {
        let place = Transform::from_xyz(0.0, -below, 0.0);
        let pins = match below > 0.0 {
            true => Pins::none(),
            false => Pins::default(),
        };
        let sheet = (Cloth::new(12, 12, 0.05), pins, place);
        app.world_mut().spawn(sheet).id()
    });
    for two in three.windows(2) {
        let seam = ClothSeam::new((two[0], Pin::Row(11)), (two[1], Pin::Row(0)));
        sew(&mut app, seam);
    }
    tick(&mut app, 1);
    let fall = fall_in_a_substep(&app, three[1]);
    tick(&mut single, 640);
    tick(&mut app, 639);
    for place in [0, 1] {
        let [upper, lower] = [three[place], three[place + 1]];
        let gap = gap(&row(&app, upper, 11), &row(&app, lower, 0));
        assert!(gap < IN_A_SUBSTEP, "{place}: {gap}");
        let own = hangs(&app, lower, 0);
        let expected = hangs(&single, one, 11 * (place + 1));
        println!("seam {place} at {own:.5} m, in one sheet at {expected:.5} m");
    }
    let (own, expected) = (hangs(&app, three[2], 11), hangs(&single, one, 33));
    println!("three sheets hang {own:.5} m, one {expected:.5} m");
    // A sub-step lets all 22 and 11 rows below a seam fall. Then only its two borders, of half a row each, are moved, so each by twice as many times
    // the fall as there are rows. Threads beside them give, too: as much again at most.
    let most = 2.0 * 4.0 * (22.0 + 11.0) * fall;
    assert!((own - expected).abs() < most, "{own} {expected} {most}");
}

/// A cloth with a tolerance has a tick done again only with more sub-steps than were taken. A rigid one never meets its tolerance. Beside a
/// cloth that takes ten, its ticks are repeated. If it may take no more than 150, beside a cloth that takes 200, its tick is done once.
#[test]
fn a_repeated_tick_takes_no_fewer_substeps() {
    for (many, max_substeps, is_repeated) in [(10, 400, true), (200, 150, false)] {
        let mut app = app();
        let strict = ClothSettings {
            substepping: Substepping::Adaptive {
                stretch: 1.0e-8,
                max_substeps,
            },
            ..default()
        };
        let rigid = ClothMaterial {
            stretch_compliance: 0.0,
            shear_compliance: 0.0,
            ..ClothMaterial::COTTON
        };
        let first = (Cloth::new(12, 12, 0.05), rigid, strict);
        let first = app.world_mut().spawn(first).id();
        let below = Transform::from_xyz(0.0, -0.55, 0.0);
        let second = (Cloth::new(12, 12, 0.05), Pins::none(), below);
        let second = (app.world_mut()).spawn((second, ClothSettings::substeps(many)));
        let second = second.id();
        sew(
            &mut app,
            ClothSeam::new((first, Pin::Row(11)), (second, Pin::Row(0))),
        );
        let mut most = 0;
        for _ in 0..32 {
            tick(&mut app, 1);
            // The sum of all runs: one of `many`, and any others of more.
            let [substeps, of_second] = [first, second].map(|cloth| stats(&app, cloth).substeps);
            assert_eq!(substeps, of_second);
            let others = substeps - many;
            assert!(others == 0 || others > many, "{substeps} of {many}");
            most = most.max(substeps);
        }
        assert_eq!(most > many, is_repeated, "{most} of {many}");
    }
}

/// Two free sheets that fly apart pull at each other: their momentum stays, to rounding. In 64 ticks of 7 sub-steps each
/// number is rounded some ten times a sub-step, by 2⁻²⁴ of itself at most.
#[test]
fn momentum_is_conserved() {
    let mut app = app();
    app.insert_resource(ClothGravity(Vec3::ZERO));
    let turned = Transform::from_xyz(0.0, -0.95, 0.0).with_rotation(Quat::from_rotation_x(0.8));
    let first = app
        .world_mut()
        .spawn((Cloth::new(20, 20, 0.05), Pins::none()))
        .id();
    let second = app
        .world_mut()
        .spawn((Cloth::new(14, 9, 0.95 / 13.0), Pins::none(), turned))
        .id();
    tick(&mut app, 1);
    for (cloth, velocity) in [
        (first, Vec3::new(1.0, 0.5, 0.0)),
        (second, Vec3::new(0.0, -1.0, 0.7)),
    ] {
        change::<ClothParticles>(&mut app, cloth, |all| {
            for index in 0..all.len() {
                all.set_velocity(index, velocity).expect("it exists");
            }
        });
    }
    let (before, energy) = motion(&app, &[first, second]);
    sew(
        &mut app,
        ClothSeam::new((first, Pin::Row(19)), (second, Pin::Row(0))),
    );
    let mut most = 0.0_f32;
    for _ in 0..64 {
        tick(&mut app, 1);
        let (_, now) = motion(&app, &[first, second]);
        most = most.max(now);
    }
    let (after, left) = motion(&app, &[first, second]);
    let error = (after - before).length() / before.length();
    println!(
        "momentum {before} became {after}: {error:.1e}; energy {energy} J, at most {most} J, {left} J"
    );
    assert!(most < 1.001 * energy, "{most} J of {energy}");
    assert!(error < 64.0 * 7.0 * 10.0 * f32::EPSILON / 2.0, "{error}");
    assert!(gap(&row(&app, first, 19), &row(&app, second, 0)) < 1.0e-3);
}
