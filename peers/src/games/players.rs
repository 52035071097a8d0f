//! The solvers with their settings that play the scenes of games.

use bevy_drape::{contact::NarrowPhase, solver::Substepping};
use oxijolt::LongRangeAttachment;

use super::scenes::Game;
use crate::{
    game_row::GAME_SOLVERS,
    jolt,
    player::{Player, Way},
    rapier,
};

const OURS: &str = GAME_SOLVERS[0];
const JOLT: &str = GAME_SOLVERS[1];
const RAPIER: &str = GAME_SOLVERS[2];

/// The plugin with 200 sub-steps, and with half as many: what these differ by is the larger part of the first one's error.
pub fn references() -> [Player; 2] {
    [200, 100].map(ours)
}

/// All that play a scene.
pub fn all(game: &Game, is_quick: bool) -> Vec<Player> {
    let mut all = vec![Player {
        solver: OURS,
        setting: "default".into(),
        way: Way::Ours(Substepping::Automatic, NarrowPhase::Auto),
    }];
    let counts: &[u32] = if is_quick { &[20] } else { &[10, 20, 40, 80] };
    all.extend(counts.iter().map(|&count| ours(count)));
    all.extend(of_jolt(game, is_quick));
    all.extend(of_rapier(game, is_quick));
    all
}

fn ours(count: u32) -> Player {
    Player {
        solver: OURS,
        setting: format!("{count} sub-steps"),
        way: Way::Ours(Substepping::Fixed(count), NarrowPhase::Auto),
    }
}

fn of_jolt(game: &Game, is_quick: bool) -> Vec<Player> {
    let best = |iterations| jolt::Setting {
        iterations,
        is_generated: false,
        is_shuffled: true,
        late_pins: true,
        tethers: None,
    };
    let documented = |iterations| jolt::Setting {
        is_generated: true,
        is_shuffled: false,
        late_pins: false,
        ..best(iterations)
    };
    let tethered = |iterations| jolt::Setting {
        is_generated: true,
        late_pins: false,
        tethers: Some(LongRangeAttachment::GeodesicDistance),
        ..best(iterations)
    };
    let player = |name: &str, setting: jolt::Setting| Player {
        solver: JOLT,
        setting: format!("{} iterations{name}", setting.iterations),
        way: Way::Jolt(setting),
    };
    let counts: &[u32] = if is_quick {
        &[20]
    } else {
        &[5, 10, 20, 40, 80]
    };
    let mut all: Vec<Player> = counts
        .iter()
        .map(|&count| player("", best(count)))
        .collect();
    all.push(player(", as documented", documented(5)));
    if game.has_pins() {
        let counts: &[u32] = if is_quick { &[20] } else { &[10, 20, 40] };
        let tethered = |&count: &u32| player(", tethers", tethered(count));
        all.extend(counts.iter().map(tethered));
    }
    all
}

fn of_rapier(game: &Game, is_quick: bool) -> Vec<Player> {
    let player = |substeps: u32, iterations: usize, is_rigid: bool| Player {
        solver: RAPIER,
        setting: format!(
            "{substeps} × {iterations} iterations{}",
            if is_rigid { ", rigid" } else { "" }
        ),
        way: Way::Rapier(rapier::Setting {
            substeps,
            iterations,
            is_rigid,
        }),
    };
    // Rigid edges are its own default, and with pins its best: only then it bounds the distance from them.
    let mut all = vec![player(4, 8, false)];
    if game.has_pins() {
        all.push(player(4, 8, true));
    }
    if !is_quick {
        all.push(player(16, 2, game.has_pins()));
    }
    all
}
