//! On how many threads it goes on makes no difference.

use std::{env, fs, hash::Hasher, process::Command};

use bevy::{
    platform::hash::FixedHasher,
    prelude::*,
    tasks::{ComputeTaskPool, TaskPoolBuilder},
};
use bevy_drape::prelude::*;

use super::scene::{Clock, everything};
use crate::support::*;

/// Ticks before it is saved.
const TICKS: usize = 30;

/// Ticks after it is saved.
fn ticks_after() -> usize {
    if is_long() { 60 } else { 40 }
}

/// What a process of its own is told: the file, and the number of threads.
const FILE: &str = "BEVY_DRAPE_TEST_SNAPSHOT";
const THREADS: &str = "BEVY_DRAPE_TEST_THREADS";

/// Cloths of every kind, and one so large that several threads share it.
fn all() -> (App, Vec<Entity>) {
    let (mut app, mut cloths) = everything();
    let large = (
        Cloth::new(256, 256, 0.01),
        // The sub-steps that its stretch asks for take minutes.
        match is_long() {
            true => ClothSettings::default(),
            false => ClothSettings::substeps(4),
        },
        Transform::from_xyz(0.0, 0.0, -9.0),
    );
    cloths.push(app.world_mut().spawn(large).id());
    (app, cloths)
}

/// A number of all bits of all particles.
fn bits(app: &App, cloths: &[Entity]) -> String {
    let mut hasher = std::hash::BuildHasher::build_hasher(&FixedHasher);
    for cloth in cloths {
        let particles = particles(app, *cloth);
        for (index, place) in particles.positions().enumerate() {
            let velocity = particles.velocity(index).expect("it exists");
            let numbers = place.to_array().into_iter().chain(velocity.to_array());
            numbers.for_each(|number| hasher.write_u32(number.to_bits()));
        }
    }
    format!("bits {:016x}", hasher.finish())
}

/// Saved to a file in one process, and restored in others, each of which has its own number of threads.
#[test]
fn any_number_of_threads_goes_on_to_the_last_bit() {
    let (mut app, cloths) = all();
    tick(&mut app, TICKS);
    let saved = ClothWorldSnapshot::of(app.world_mut());
    let file = env::temp_dir().join(format!("bevy_drape_snapshot_{}.ron", std::process::id()));
    fs::write(&file, ron::to_string(&saved).expect("it can be written")).expect("a file");
    tick(&mut app, ticks_after());
    let expected = bits(&app, &cloths);
    let threads: &[usize] = if is_long() { &[1, 2, 5, 8] } else { &[1, 8] };
    let outcomes: Vec<_> = threads
        .iter()
        .map(|threads| {
            let output = Command::new(env::current_exe().expect("this one"))
                .args(["--exact", "snapshot::threads::in_a_process_of_its_own"])
                .args(["--ignored", "--nocapture"])
                .env(FILE, &file)
                .env(THREADS, threads.to_string())
                .output()
                .expect("a process");
            let said = String::from_utf8_lossy(&output.stdout).into_owned();
            (threads, output.status.success(), said)
        })
        .collect();
    fs::remove_file(&file).expect("the file");
    for (threads, is_success, said) in outcomes {
        assert!(
            is_success && said.contains(&expected),
            "{threads} threads: {expected}\n{said}"
        );
    }
}

#[test]
#[ignore = "run by `any_number_of_threads_goes_on_to_the_last_bit`"]
fn in_a_process_of_its_own() {
    let (Ok(file), Ok(threads)) = (env::var(FILE), env::var(THREADS)) else {
        return;
    };
    let threads = threads.parse().expect("a number");
    ComputeTaskPool::get_or_init(|| TaskPoolBuilder::new().num_threads(threads).build());
    let (mut app, cloths) = all();
    assert_eq!(ComputeTaskPool::get().thread_num(), threads);
    let text = fs::read_to_string(file).expect("the file");
    let saved: ClothWorldSnapshot = ron::from_str(&text).expect("a snapshot");
    saved.restore(app.world_mut()).expect("the same entities");
    app.insert_resource(Clock(TICKS as u32));
    tick(&mut app, ticks_after());
    println!("{}", bits(&app, &cloths));
}
