//! Which settings nothing beats, and what that says.

use super::{
    Row,
    methods::{EXPLICIT, ONE_SWEEP, OURS, PROJECTIVE, SMALL_STEPS, TOLERANCE},
    scenes::{BALL, STIFF_HANGING, STIFF_SWINGING},
};
use crate::measure::median;

/// Errors that differ by less are the same: so much do tethers and rounding do.
const MARGIN: f64 = 1.05;

/// The rows of one scene with cloths of one size.
pub struct Group<'a>(Vec<&'a Row>);

impl<'a> Group<'a> {
    /// In the order in which they were measured.
    pub fn all(rows: &'a [Row]) -> Vec<Self> {
        let chunks = rows.chunk_by(|a, b| a.scene == b.scene && a.particles == b.particles);
        chunks.map(|chunk| Self(chunk.iter().collect())).collect()
    }

    /// Those with the largest cloths.
    pub fn largest(rows: &'a [Row]) -> Vec<Self> {
        let most = rows.iter().map(|row| row.particles).max();
        let mut groups = Self::all(rows);
        groups.retain(|group| Some(group.first().particles) == most);
        groups
    }

    pub fn rows(&self) -> &[&'a Row] {
        &self.0
    }

    /// What is the same for all.
    pub fn first(&self) -> &'a Row {
        self.0[0]
    }

    pub fn name(&self) -> String {
        let side = (self.first().particles as f64).sqrt().round();
        format!("{}, {side}²", self.first().scene)
    }

    pub fn of(&self, method: &str) -> impl Iterator<Item = &'a Row> {
        self.0
            .iter()
            .copied()
            .filter(move |row| row.method == method)
    }

    /// What no other beats in time without being farther off, from the fastest to the most exact.
    pub fn frontier(&self) -> Vec<&'a Row> {
        let mut sorted = self.0.clone();
        sorted.sort_by(|a, b| {
            let times = a.ms_per_second.total_cmp(&b.ms_per_second);
            times.then(a.error().total_cmp(&b.error()))
        });
        let mut frontier: Vec<&Row> = Vec::new();
        for row in sorted {
            if frontier
                .last()
                .is_none_or(|last| row.error() < last.error())
            {
                frontier.push(row);
            }
        }
        frontier
    }

    /// The fastest of those that `are` meant and are no farther off than `error` (m).
    fn fastest(&self, error: f64, are: impl Fn(&str) -> bool) -> Option<&'a Row> {
        self.0
            .iter()
            .copied()
            .filter(|row| are(&row.method) && row.error() <= error)
            .min_by(|a, b| a.ms_per_second.total_cmp(&b.ms_per_second))
    }

    /// Our default, and the fastest peer that is as exact.
    pub fn default_against_peers(&self) -> Option<(&'a Row, &'a Row)> {
        let ours = self.of(OURS).find(|row| row.setting == "20 sub-steps")?;
        let peer = self.fastest(MARGIN * ours.error(), |method| !is_ours(method))?;
        Some((ours, peer))
    }

    /// The smallest error of those that `are` meant (m).
    fn min_error(&self, are: impl Fn(&str) -> bool) -> f64 {
        let meant = self.0.iter().filter(|row| are(&row.method));
        meant.map(|row| row.error()).fold(f64::INFINITY, f64::min)
    }

    /// Whether a peer comes nearer to the truth than all of ours.
    pub fn peer_is_most_exact(&self) -> bool {
        MARGIN * self.min_error(is_rival) < self.min_error(is_ours)
    }

    /// The peer that is ahead of ours the most, and the fastest of ours that is as exact, if any is.
    pub fn best_peer(&self) -> Option<(&'a Row, Option<&'a Row>)> {
        let lead = |(peer, ours): &(&Row, Option<&Row>)| {
            ours.map_or(f64::INFINITY, |ours| {
                ours.ms_per_second / peer.ms_per_second
            })
        };
        let mut rivals = self.0.clone();
        rivals.retain(|row| is_rival(&row.method));
        rivals.sort_by(|a, b| a.ms_per_second.total_cmp(&b.ms_per_second));
        rivals
            .into_iter()
            .map(|row| (row, self.fastest(MARGIN * row.error(), is_ours)))
            .filter(|pair| lead(pair) > 1.0)
            // The first of those that ours does not come up to.
            .reduce(|best, next| {
                if lead(&next) > lead(&best) {
                    next
                } else {
                    best
                }
            })
    }
}

pub fn is_ours(method: &str) -> bool {
    [OURS, ONE_SWEEP, TOLERANCE].contains(&method)
}

/// Whether it is another method than ours, and not ours in other code.
fn is_rival(method: &str) -> bool {
    !is_ours(method) && method != SMALL_STEPS
}

/// A length in mm, with two digits that count.
pub fn mm(metres: f64) -> String {
    let mm = 1.0e3 * metres;
    let digits = (1 - mm.abs().max(1.0e-9).log10().floor() as i32).clamp(0, 6);
    format!("{mm:.*} mm", digits as usize)
}

pub fn findings(rows: &[Row]) -> Vec<String> {
    let mut findings = Vec::new();
    for group in Group::largest(rows) {
        let frontier = group.frontier();
        let own = frontier.iter().filter(|row| is_ours(&row.method)).count();
        let mut others: Vec<&str> = frontier.iter().map(|row| row.method.as_str()).collect();
        others.retain(|method| !is_ours(method));
        others.dedup();
        let others = if others.is_empty() {
            "no peer".into()
        } else {
            others.join(" and ")
        };
        let mut finding = format!(
            "{}: of {} settings on the frontier {own} are ours; besides, {others}.",
            group.name(),
            frontier.len()
        );
        if let Some((ours, peer)) = group.default_against_peers() {
            let ratio = peer.ms_per_second / ours.ms_per_second;
            finding += &format!(
                " 20 sub-steps are {} off in {:.0} ms; the fastest peer as exact, {} with {}, takes {ratio:.1} × as long.",
                mm(ours.error()),
                ours.ms_per_second,
                peer.method,
                peer.setting,
            );
        }
        if let Some((peer, ours)) = group.best_peer() {
            finding += &format!(
                " A peer wins: {} with {} is {} off in {:.0} ms, ",
                peer.method,
                peer.setting,
                mm(peer.error()),
                peer.ms_per_second
            );
            finding += &match ours {
                Some(ours) => format!(
                    "for which ours needs {:.0} ms ({}).",
                    ours.ms_per_second, ours.setting
                ),
                None => format!(
                    "which ours does not reach with up to {:.0} sub-steps.",
                    group.of(OURS).map(|row| row.substeps).fold(0.0, f64::max)
                ),
            };
        }
        findings.push(finding);
    }
    findings.extend(implementation(rows));
    findings.extend(tolerance(rows));
    findings.extend(stiff(rows));
    findings.extend(depth(rows));
    findings.push(format!(
        "The peers are plain scalar code. Projective dynamics' factorization is not counted, and errors below the reference's own ({}) are not told apart.",
        Group::all(rows)
            .iter()
            .map(|group| format!("{}: {}", group.name(), mm(group.first().reference_error_m)))
            .collect::<Vec<_>>()
            .join(", ")
    ));
    findings
}

/// The same method by two codes.
fn implementation(rows: &[Row]) -> Option<String> {
    let (mut faster, mut apart, mut tethered) = (Vec::new(), Vec::new(), Vec::new());
    for group in Group::largest(rows) {
        for (ours, plain) in group.of(ONE_SWEEP).zip(group.of(SMALL_STEPS)) {
            faster.push(plain.ms_per_second / ours.ms_per_second);
            apart.push(100.0 * (ours.error() / plain.error() - 1.0).abs());
        }
        for (with, without) in group.of(OURS).zip(group.of(ONE_SWEEP)) {
            tethered.push(with.ms_per_second / without.ms_per_second);
        }
    }
    (!faster.is_empty()).then(|| {
        format!(
            "Plain small steps are our method in scalar code: with as many sub-steps our one sweep is {:.1} × as fast, and its error differs from theirs by {:.1} % in the middle and {:.0} % at most. So much is implementation, the rest is method. Threads solved exactly make a sub-step {:.2} × as long.",
            median(&faster),
            median(&apart),
            apart.iter().copied().fold(0.0, f64::max),
            median(&tethered)
        )
    })
}

/// What a tolerance below the material's own stretch buys.
fn tolerance(rows: &[Row]) -> Option<String> {
    let percent = |row: &Row| row.setting.split(' ').next()?.parse::<f64>().ok();
    let group = Group::largest(rows).into_iter().next()?;
    let own = 100.0 * group.first().reference_stretch;
    let mut below = group
        .of(TOLERANCE)
        .filter(|row| percent(row).is_some_and(|asked| asked < own));
    let row = below.next()?;
    let had = 100.0 * row.max_stretch;
    // To the last digit that is said.
    let outcome = if percent(row).is_some_and(|asked| had > asked + 5.0e-3) {
        format!("cannot be had ({had:.2} % comes out)")
    } else {
        format!("is kept ({had:.2} % comes out)")
    };
    Some(format!(
        "{}: the material itself gives {own:.2} % when it is let go; {}, which is less, {outcome}, and takes {:.0} sub-steps a tick, those in vain included, for an error of {}.",
        group.name(),
        row.setting,
        row.substeps,
        mm(row.error())
    ))
}

/// How deep particles come into the ball: 20 sub-steps of ours, the least deep peer in as much time, and the deepest.
pub struct Depths<'a> {
    pub group: Group<'a>,
    pub ours: &'a Row,
    pub peer: Option<&'a Row>,
    pub deepest: &'a Row,
}

impl<'a> Depths<'a> {
    /// In the largest cloths.
    pub fn of(rows: &'a [Row]) -> Option<Self> {
        let group = Group::largest(rows)
            .into_iter()
            .find(|group| group.first().scene == BALL)?;
        let ours = group.of(OURS).find(|row| row.setting == "20 sub-steps")?;
        let by_depth = |a: &&Row, b: &&Row| a.max_penetration_m.total_cmp(&b.max_penetration_m);
        let all = || group.rows().iter().copied();
        let peer = all()
            .filter(|row| is_rival(&row.method) && row.ms_per_second <= ours.ms_per_second)
            .min_by(by_depth);
        let deepest = all().max_by(by_depth)?;
        Some(Self {
            group,
            ours,
            peer,
            deepest,
        })
    }
}

fn depth(rows: &[Row]) -> Option<String> {
    let Depths {
        group,
        ours,
        peer,
        deepest,
    } = Depths::of(rows)?;
    let of = |row: &Row| format!("{} with {}", row.method, row.setting);
    let peer = peer.map_or("no peer is as fast".into(), |peer| {
        format!(
            "in no more time the least deep peer, {}, comes {} deep",
            of(peer),
            mm(peer.max_penetration_m)
        )
    });
    Some(format!(
        "{}: all push particles out at the end of a step or sub-step. Before, they are found {} deep in the ball at most by 20 sub-steps of ours; {peer}; the deepest by {}, {}.",
        group.name(),
        mm(ours.max_penetration_m),
        of(deepest),
        mm(deepest.max_penetration_m)
    ))
}

/// What projective dynamics does with a stiff cloth.
fn stiff(rows: &[Row]) -> Option<String> {
    let groups = Group::all(rows);
    let of = |scene: &str, particles: usize| {
        let is_meant = |group: &&Group| {
            (group.first().scene.as_str(), group.first().particles) == (scene, particles)
        };
        groups.iter().find(is_meant)
    };
    let swinging = groups
        .iter()
        .find(|group| group.first().scene == STIFF_SWINGING)?;
    let hanging = of(STIFF_HANGING, swinging.first().particles)?;
    let least = |group: &Group| group.min_error(|method| method == PROJECTIVE);
    let ours = swinging
        .of(OURS)
        .find(|row| row.setting == "20 sub-steps")?;
    let best = least(swinging);
    let outcome = if best > 10.0 * ours.error() {
        "locks when it swings"
    } else {
        "is farther off when it swings"
    };
    let outcome = if best > ours.error() {
        outcome
    } else {
        "is the more exact when it swings"
    };
    Some(format!(
        "{}: projective dynamics, at best {} off while the stiff cloth hangs, {outcome}: {} off at best, where 20 sub-steps of ours are {} off; explicit forces need {:.0} steps a tick.",
        swinging.name(),
        mm(least(hanging)),
        mm(best),
        mm(ours.error()),
        swinging.of(EXPLICIT).next()?.substeps
    ))
}
