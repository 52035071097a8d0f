//! Seams that close, open, give, and hold cloths of moving parents.

use super::*;

/// A seam closes at the rate that its time says, and the cloths get no more energy than that speed has. One that is to
/// close at once closes at 1 m/s.
#[test]
fn a_seam_closes_over_seconds() {
    for (seconds, takes) in [(1.0, 1.0), (0.0, 0.45)] {
        let mut app = app();
        app.insert_resource(ClothGravity(Vec3::ZERO));
        let away = Transform::from_xyz(0.0, -0.95 - 0.3, 0.0);
        let first = app
            .world_mut()
            .spawn((Cloth::new(20, 20, 0.05), Pins::none()))
            .id();
        let second = app
            .world_mut()
            .spawn((Cloth::new(20, 20, 0.05), Pins::none(), away))
            .id();
        let seam = ClothSeam::new((first, Pin::Row(19)), (second, Pin::Row(0)));
        sew(&mut app, seam.closing_in(seconds));
        let mass = 2.0 * 0.95 * 0.95 * ClothMaterial::default().areal_density;
        // Nothing is faster than both sides come nearer: in the middle half as fast again as on average.
        let most = 0.5 * mass * (1.5 * 0.3_f32 / takes).powi(2);
        let mut energies = Vec::new();
        for step in 1..=192 {
            tick(&mut app, 1);
            let gap = gap(&row(&app, first, 19), &row(&app, second, 0));
            let past = (step as f32 * TICK / takes).min(1.0);
            let planned = 0.3 * (1.0 - past * past * (3.0 - 2.0 * past));
            assert!(gap < planned + 1.0e-4, "{step}: {gap} of {planned}");
            energies.push(motion(&app, &[first, second]).1);
        }
        let largest = energies.iter().copied().fold(0.0, f32::max);
        println!(
            "closing in {takes} s: {largest:.2e} J of {most:.2e} J, at last {:.2e} J",
            energies[191]
        );
        assert!(largest < most, "{largest} J of {most} J");
        let closed = (takes / TICK) as usize + 2;
        assert!(energies[191] <= energies[closed], "{energies:?}");
    }
}

/// Two panels that hang from their outer sides, sewn in the middle.
fn panels(app: &mut App) -> ([Entity; 2], Entity) {
    let first = (Cloth::new(12, 24, 0.05), Pins::new([Pin::Column(0)]));
    let beside = Transform::from_xyz(0.55, 0.0, 0.0);
    let second = (
        Cloth::new(12, 24, 0.05),
        Pins::new([Pin::Column(11)]),
        beside,
    );
    let first = app.world_mut().spawn(first).id();
    let second = app.world_mut().spawn(second).id();
    let seam = ClothSeam::new((first, Pin::Column(11)), (second, Pin::Column(0)));
    let seam = sew(app, seam);
    ([first, second], seam)
}

/// A zip opens from either end as far as it is told, closes again, and despawned it is open. Gravity pulls towards the end that
/// stays closed, so that one case is the other one upside down.
#[test]
fn a_zip_opens_from_either_end() {
    for end in [0, 1] {
        let mut app = app();
        let down = if end == 0 { -GRAVITY } else { GRAVITY };
        app.insert_resource(ClothGravity(down * Vec3::Y));
        let ([first, second], zip) = panels(&mut app);
        tick(&mut app, 64);
        // From the end that opens.
        let gaps = |app: &App| -> Vec<f32> {
            let pairs = column(app, first, 11)
                .into_iter()
                .zip(column(app, second, 0));
            let mut gaps: Vec<f32> = pairs.map(|(a, b)| a.distance(b)).collect();
            if end == 1 {
                gaps.reverse();
            }
            gaps
        };
        let closed = gaps(&app);
        assert!(closed.iter().all(|gap| *gap < 1.0e-5), "{closed:?}");
        for step in 0..=64 {
            let open = 0.5 * step as f32 / 64.0;
            change::<ClothSeam>(&mut app, zip, |zip| {
                zip.sewn[end] = if end == 0 { open } else { 1.0 - open };
            });
            tick(&mut app, 1);
        }
        tick(&mut app, 64);
        let open = gaps(&app);
        println!("gaps of a zip half open: {open:.4?}");
        assert!(open[..10].iter().all(|gap| *gap > 1.0e-3), "{open:?}");
        assert!(open[12..].iter().all(|gap| *gap < 1.0e-4), "{open:?}");
        change::<ClothSeam>(&mut app, zip, |zip| zip.sewn = [0.0, 1.0]);
        tick(&mut app, 128);
        let closed = gaps(&app);
        assert!(closed.iter().all(|gap| *gap < 1.0e-4), "{closed:?}");
        app.world_mut().despawn(zip);
        tick(&mut app, 64);
        let open = gaps(&app);
        assert!(open[1..].iter().all(|gap| *gap > 1.0e-3), "{open:?}");
    }
}

/// Two cloths that are held by parents which go and turn in ways of their own are held together.
#[test]
fn cloths_of_moving_parents_are_held_together() {
    // The sheets are 1.1 m long together. Their held rows are 0.9 m apart at most in height, 0.2 m to the side, and 0.32 m at their
    // ends, by turns of 0.3 rad: 0.98 m.
    let at = |of: usize, step: usize| {
        let (way, time) = ([1.0, -1.0][of], step as f32 * TICK);
        let place = Vec3::new(
            0.1 * way * (2.0 * time).sin(),
            0.025 * way * (3.0 * time).cos(),
            0.0,
        );
        Transform::from_translation(place)
            .with_rotation(Quat::from_rotation_y(0.3 * way * (1.5 * time).sin()))
    };
    let mut app = app();
    let parents = [0, 1].map(|of| app.world_mut().spawn(at(of, 0)).id());
    let upper = (Cloth::new(12, 12, 0.05), ChildOf(parents[0]));
    let upper = app.world_mut().spawn(upper).id();
    let below = Transform::from_xyz(0.0, -0.3, 0.0);
    let pins = Pins::new([Pin::Row(11)]);
    let lower = (Cloth::new(12, 12, 0.05), pins, below, ChildOf(parents[1]));
    let lower = app.world_mut().spawn(lower).id();
    let seam = ClothSeam::new((upper, Pin::Row(11)), (lower, Pin::Row(0)));
    let seam = sew(&mut app, seam.closing_in(0.5));
    let mut worst = 0.0_f32;
    for step in 1..=320 {
        for (of, parent) in parents.into_iter().enumerate() {
            change::<Transform>(&mut app, parent, |place| *place = at(of, step));
        }
        tick(&mut app, 1);
        if step > 64 {
            worst = worst.max(gap(&row(&app, upper, 11), &row(&app, lower, 0)));
        }
    }
    println!("cloths of moving parents are {worst:.1e} m apart");
    assert!(app.world().get::<ClothFault>(seam).is_none());
    // A seam is solved last in a sub-step. Its stitches have no particles in common, so roundings are left.
    assert!(worst < 1.0e-3, "{worst}");
}

/// A soft seam gives by its compliance: a sheet of 1 kg/m² and 0.95 m pulls with 9.3 N on each metre.
#[test]
fn a_soft_seam_gives() {
    let mut app = app();
    let heavy = ClothMaterial {
        areal_density: 1.0,
        ..default()
    };
    let below = Transform::from_xyz(0.0, -0.95, 0.0);
    let upper = app
        .world_mut()
        .spawn((Cloth::new(20, 20, 0.05), heavy))
        .id();
    let lower = (Cloth::new(20, 20, 0.05), Pins::none(), heavy, below);
    let lower = app.world_mut().spawn(lower).id();
    let mut seam = ClothSeam::new((upper, Pin::Row(19)), (lower, Pin::Row(0)));
    seam.compliance = 1.0e-3;
    sew(&mut app, seam);
    tick(&mut app, 640);
    let given = gap(&row(&app, upper, 19), &row(&app, lower, 0));
    let expected = 1.0e-3 * 0.95 * GRAVITY;
    println!("a soft seam gives {given} m of {expected}");
    // At the ends, columns of half a width hang by stitches of half a length, and the sheet narrows a bit.
    assert!((given / expected - 1.0).abs() < 0.1, "{given} {expected}");
}

/// A patch all around on a flag in the wind, nowhere farther from it than a millimetre.
#[test]
fn a_patch_on_a_flag() {
    let mut app = app();
    app.insert_resource(ClothWind::gusty(Vec3::new(5.0, 0.0, 2.0)));
    let flag = (Cloth::new(31, 21, 0.05), Pins::new([Pin::Column(0)]));
    let flag = app.world_mut().spawn(flag).id();
    let patch = (
        Cloth::new(8, 8, 0.04),
        Pins::none(),
        Transform::from_xyz(0.61, -0.33, 0.003),
    );
    let patch = app.world_mut().spawn(patch).id();
    tick(&mut app, 1);
    let border = Pin::filter(|row, column| row % 7 == 0 || column % 7 == 0);
    let faces =
        Pin::at_rest(|place| (0.4..1.1).contains(&place.x) && (-0.8..-0.2).contains(&place.y));
    sew(&mut app, ClothSeam::new((patch, border), (flag, faces)));
    tick(&mut app, 16);
    // What each is sewn to: the nearest point of the flag stays the nearest, to a face's width.
    let (mut worst, mut stretched) = (0.0_f32, 0.0_f32);
    for _ in 0..256 {
        tick(&mut app, 1);
        let (own, flag_places) = (places(&app, patch), places(&app, flag));
        let built = app.world().get::<ClothBuilt>(flag).expect("it is built");
        for index in (0..64).filter(|index| index / 8 % 7 == 0 || index % 8 % 7 == 0) {
            let nearest = built.surface().triangles().iter().map(|face| {
                let [a, b, c] = face.map(|corner| flag_places[corner as usize]);
                let normal = (b - a).cross(c - a).normalize_or_zero();
                let middle = (a + b + c) / 3.0;
                let off = (own[index] - middle).dot(normal).abs();
                if own[index].distance(middle) < 0.04 {
                    off
                } else {
                    f32::MAX
                }
            });
            worst = worst.max(nearest.fold(f32::MAX, f32::min));
        }
        stretched = stretched.max(stats(&app, patch).stretch.structural);
    }
    println!("a patch is off its flag by {worst:.1e} m, stretched by {stretched}");
    assert!(worst < 1.0e-3, "{worst}");
}

/// A sheet sewn to itself is a tube.
#[test]
fn a_sheet_becomes_a_tube() {
    let mut app = app();
    app.insert_resource(ClothGravity(Vec3::ZERO));
    let sheet = (Cloth::new(25, 10, 0.04), Pins::none());
    let cloth = app.world_mut().spawn(sheet).id();
    let seam = ClothSeam::new((cloth, Pin::Column(0)), (cloth, Pin::Column(24)));
    sew(&mut app, seam.closing_in(2.0));
    tick(&mut app, 64);
    let half = gap(&column(&app, cloth, 0), &column(&app, cloth, 24));
    tick(&mut app, 128);
    let closed = gap(&column(&app, cloth, 0), &column(&app, cloth, 24));
    println!("a tube after 1 s: {half} m of 0.48, after 3 s {closed:.1e} m");
    assert!(half < 0.49 && closed < 1.0e-5, "{half} {closed}");
    let stretch = stats(&app, cloth).stretch.structural;
    println!("the tube is stretched by {stretch}");
    assert!(stretch < 0.05, "{stretch}");
}

/// With contact of cloth with cloth, what is sewn together does not push itself apart, flat or folded, and the sheets that
/// lie on each other beside the seam stay apart.
#[test]
fn layers_leave_a_seam_alone() {
    for folded in [false, true] {
        let mut app = app();
        let touch = ClothSelfCollision::of_thickness(0.01);
        let beside = match folded {
            false => Transform::from_xyz(0.0, -0.95, 0.0),
            true => Transform::from_xyz(0.0, 0.0, 0.03),
        };
        let first = app
            .world_mut()
            .spawn((Cloth::new(20, 20, 0.05), touch))
            .id();
        let pins = if folded {
            Pins::default()
        } else {
            Pins::none()
        };
        let second = (Cloth::new(30, 20, 0.95 / 29.0), pins, touch, beside);
        let second = app.world_mut().spawn(second).id();
        let row_of_second = if folded { 19 } else { 0 };
        sew(
            &mut app,
            ClothSeam::new((first, Pin::Row(19)), (second, Pin::Row(row_of_second))),
        );
        tick(&mut app, 128);
        let mut widest = 0.0_f32;
        for _ in 0..128 {
            tick(&mut app, 1);
            let gap = gap(
                &row(&app, first, 19),
                &row(&app, second, row_of_second as usize),
            );
            widest = widest.max(gap);
        }
        let exceeded = [first, second].map(|cloth| stats(&app, cloth).stretch.structural);
        println!("sewn with layers, folded {folded}: gap {widest:.1e} m, stretch {exceeded:.4?}");
        // Layers beside the seam push its particles last in a sub-step, by a part of their thickness.
        assert!(widest < 0.25 * 0.01, "{widest}");
        assert!(
            exceeded.iter().all(|stretch| *stretch < 0.03),
            "{exceeded:?}"
        );
        let lost: Vec<ClothLimitExceeded> = messages(&mut app);
        assert!(lost.is_empty(), "{lost:?}");
    }
}
