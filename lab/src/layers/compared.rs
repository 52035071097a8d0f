//! Choices of how to keep layers apart, compared in the same drops.

use super::{HASH, NOTHING, PARTICLES, Row, THICKNESS, TRIANGLES};
use crate::measure::median;

impl Row {
    /// Takes a tick into account: how many pairs of triangles intersect, how many are near each other, and how often was searched.
    pub(super) fn watch(&mut self, intersections: usize, (pairs, searches): (usize, u32)) {
        self.intersections = self.intersections.max(intersections);
        self.ticks_with += usize::from(intersections > 0);
        self.pairs = self.pairs.max(pairs);
        self.searches += f64::from(searches) / self.ticks as f64;
    }
}

/// Up to which speed choices are compared (m/s).
pub const FASTEST: f32 = 5.0;

/// The runs of one choice.
pub struct Compared<'a> {
    pub name: String,
    pub rows: Vec<&'a Row>,
}

/// The choices, in the scenes in which balls were dropped, at any speed.
pub fn all(rows: &[Row]) -> Vec<Compared<'_>> {
    let thickness = format!("{:.0} mm", 1.0e3 * THICKNESS);
    let is_thick = |row: &Row| (row.thickness - THICKNESS).abs() < 1.0e-6;
    let choices = [
        (TRIANGLES, format!("{TRIANGLES}, {thickness}"), true),
        (HASH, format!("{HASH}, search alone"), true),
        (PARTICLES, format!("{PARTICLES}, {thickness}"), true),
        (PARTICLES, format!("{PARTICLES}, spacing"), false),
    ];
    let each = choices.into_iter().map(|(choice, name, thick)| {
        let of = rows
            .iter()
            .filter(|row| row.choice == choice && is_thick(row) == thick);
        Compared {
            name,
            rows: of.filter(|row| is_compared(rows, row)).collect(),
        }
    });
    let nothing = rows.iter().filter(|row| row.choice == NOTHING);
    let nothing = Compared {
        name: NOTHING.into(),
        rows: nothing.collect(),
    };
    each.chain([nothing])
        .filter(|compared| !compared.rows.is_empty())
        .collect()
}

/// Whether balls were dropped in the same way.
fn is_compared(rows: &[Row], row: &Row) -> bool {
    rows.iter().any(|other| {
        other.choice == PARTICLES
            && (&other.scene, other.particles) == (&row.scene, row.particles)
            && other.speed.to_bits() == row.speed.to_bits()
    })
}

impl Compared<'_> {
    /// Of the runs of these.
    pub fn only(&self, is_meant: impl Fn(&Row) -> bool) -> Self {
        let rows = self.rows.iter().copied().filter(|row| is_meant(row));
        Self {
            name: self.name.clone(),
            rows: rows.collect(),
        }
    }

    /// Time of a tick over that without contact, in the mean.
    pub fn times(&self) -> f64 {
        let sum: f64 = self.rows.iter().map(|row| 1.0 + row.added()).sum();
        sum / self.rows.len() as f64
    }

    /// Ticks with an intersection, and all that were watched.
    pub fn ticks(&self) -> [usize; 2] {
        let with = self.rows.iter().map(|row| row.ticks_with);
        [with.sum(), self.rows.iter().map(|row| row.ticks).sum()]
    }

    /// What contact adds to a tick (ms), in the median.
    fn added_ms(&self) -> f64 {
        let added = self.rows.iter().map(|row| row.ms_per_tick - row.ms_without);
        median(&added.collect::<Vec<_>>())
    }
}

/// A sentence for each choice.
pub fn findings(rows: &[Row]) -> Vec<String> {
    let slow = all(rows)
        .into_iter()
        .map(|compared| compared.only(|row| row.speed <= FASTEST))
        .filter(|compared| !compared.rows.is_empty());
    slow.map(|compared| {
        let [with, all] = compared.ticks();
        let lost = if all > 0 {
            format!("intersections in {with} of {all} ticks")
        } else {
            "no response, so a lower bound".into()
        };
        format!(
            "{}: {:.2} × the tick without, {:+.3} ms in the median, {lost} ({} drops, up to {FASTEST} m/s).",
            compared.name,
            compared.times(),
            compared.added_ms(),
            compared.rows.len()
        )
    })
    .collect()
}
