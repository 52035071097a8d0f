//! Which settings nothing beats, and what that says.

use super::{
    Row,
    methods::{EXPLICIT, OURS, PROJECTIVE, SMALL_STEPS, TOLERANCE, UNTETHERED},
    scenes::{STIFF_HANGING, STIFF_SWINGING},
};
use crate::measure::median;

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
        // The same method in other code differs by tethers and rounding.
        let peer = self.fastest(1.05 * ours.error(), |method| !is_ours(method))?;
        Some((ours, peer))
    }

    /// The peer on the frontier that is ahead of ours the most, and the fastest of ours that is as exact, if any is.
    pub fn best_peer(&self) -> Option<(&'a Row, Option<&'a Row>)> {
        let lead = |(peer, ours): &(&Row, Option<&Row>)| {
            ours.map_or(f64::INFINITY, |ours| {
                ours.ms_per_second / peer.ms_per_second
            })
        };
        self.frontier()
            .into_iter()
            .filter(|row| !is_ours(&row.method))
            .map(|row| (row, self.fastest(row.error(), is_ours)))
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
    [OURS, UNTETHERED, TOLERANCE].contains(&method)
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
    findings.push(format!(
        "All push particles out at the end of a step, so at the end of a tick none is deeper in the ball than {:.1e} m. The peers are plain scalar code. Projective dynamics' factorization is not counted, and errors below the reference's own ({}) are not told apart.",
        rows.iter()
            .map(|row| row.max_penetration_m)
            .fold(0.0, f64::max),
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
        for (ours, plain) in group.of(UNTETHERED).zip(group.of(SMALL_STEPS)) {
            faster.push(plain.ms_per_second / ours.ms_per_second);
            apart.push(100.0 * (ours.error() / plain.error() - 1.0).abs());
        }
        for (with, without) in group.of(OURS).zip(group.of(UNTETHERED)) {
            tethered.push(with.ms_per_second / without.ms_per_second);
        }
    }
    (!faster.is_empty()).then(|| {
        format!(
            "Plain small steps are our method in scalar code: with as many sub-steps ours without tethers is {:.1} × as fast, and its error differs from theirs by {:.1} % in the middle and {:.0} % at most. So much is implementation, the rest is method. Tethers make a tick {:.2} × as long.",
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
    Some(format!(
        "{}: the material itself gives {own:.2} % when it is let go; {}, which is less, cannot be had, and takes {:.0} sub-steps a tick, those in vain included, for an error of {}.",
        group.name(),
        row.setting,
        row.substeps,
        mm(row.error())
    ))
}

/// Where projective dynamics locks.
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
    let least = |group: &Group, method: &str| {
        let errors = group.of(method).map(Row::error);
        mm(errors.fold(f64::INFINITY, f64::min))
    };
    let ours = swinging
        .of(OURS)
        .find(|row| row.setting == "20 sub-steps")?;
    Some(format!(
        "{}: projective dynamics, at best {} off while the stiff cloth hangs, locks when it swings: {} off at best, where 20 sub-steps of ours are {} off; explicit forces need {:.0} steps a tick.",
        swinging.name(),
        least(hanging, PROJECTIVE),
        least(swinging, PROJECTIVE),
        mm(ours.error()),
        swinging.of(EXPLICIT).next()?.substeps
    ))
}
