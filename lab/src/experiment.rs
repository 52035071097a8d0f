//! What an experiment is, and how one is conducted.

use std::{fmt, path::PathBuf};

use examples_shared::view::View;
use indicatif::{ProgressBar, ProgressStyle};
use serde::{Serialize, de::DeserializeOwned};

use crate::{chart::Chart, record};

/// One experiment: what it measures, what must hold of that, and what it looks like.
pub trait Experiment {
    /// A row of its CSV file.
    type Row: Serialize + DeserializeOwned;

    /// Its name on the command line and of its files.
    const NAME: &'static str;

    /// Measures. Where nothing can be, says why by [`Run::say`] and returns no rows.
    fn run(run: &mut Run) -> Vec<Self::Row>;

    /// What must hold of the rows, however fast the machine is.
    ///
    /// # Errors
    /// What does not.
    fn check(rows: &[Self::Row]) -> Result<(), String>;

    /// What came of it, a sentence each, with its numbers.
    fn findings(rows: &[Self::Row]) -> Vec<String>;

    /// What is printed.
    fn table(rows: &[Self::Row]) -> Table;

    /// What is drawn.
    fn charts(rows: &[Self::Row]) -> Vec<Chart>;
}

/// How experiments are run.
pub struct Run {
    /// Whether a short run will do: fewer settings and turns, all experiments within a minute.
    pub quick: bool,
    /// What frames can be drawn on.
    pub view: View,
    /// What the header of the CSV file says besides.
    pub settings: Vec<(String, String)>,
    bar: ProgressBar,
}

impl Run {
    pub fn new(quick: bool, view: View) -> Self {
        Self {
            quick,
            view,
            settings: Vec::new(),
            bar: ProgressBar::hidden(),
        }
    }

    /// One of two, the first in a short run.
    pub fn either<T>(&self, quick: T, whole: T) -> T {
        if self.quick { quick } else { whole }
    }

    /// Notes a setting for the header.
    pub fn set(&mut self, name: &str, value: impl fmt::Display) {
        self.settings.push((name.into(), value.to_string()));
    }

    /// Begins a progress bar of this many steps.
    pub fn begin(&mut self, name: &'static str, steps: usize) {
        self.bar.finish_and_clear();
        let style = ProgressStyle::with_template("{msg:>12} {bar:40} {pos}/{len}, {eta} left");
        self.bar = ProgressBar::new(steps as u64)
            .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
            .with_message(name);
    }

    /// A step of it is done.
    pub fn step(&self) {
        self.bar.inc(1);
    }

    /// Says a line.
    pub fn say(&self, line: &str) {
        self.bar.suspend(|| println!("{line}"));
    }

    fn finish(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// What is printed of an experiment.
pub struct Table {
    pub columns: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Table {
    pub fn new<const N: usize>(columns: [&str; N]) -> Self {
        Self {
            columns: columns.map(String::from).to_vec(),
            rows: Vec::new(),
        }
    }

    pub fn row<const N: usize>(&mut self, cells: [String; N]) {
        self.rows.push(cells.to_vec());
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let all = || std::iter::once(&self.columns).chain(&self.rows);
        let width = |column: usize| {
            all()
                .filter_map(|row| row.get(column))
                .map(|cell| cell.chars().count())
                .max()
        };
        for row in all() {
            write!(f, " ")?;
            for (column, cell) in row.iter().enumerate() {
                let width = width(column).unwrap_or(0);
                // Words to the left, numbers to the right.
                let is_number = cell.starts_with(|c: char| c.is_ascii_digit() || c == '-');
                if column == 0 || !is_number {
                    write!(f, " {cell:<width$}")?;
                } else {
                    write!(f, " {cell:>width$}")?;
                }
                write!(f, " ")?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

/// Where files go, and whether they are only drawn again.
pub struct Output {
    pub folder: PathBuf,
    pub redraw: bool,
}

/// Runs an experiment, or reads what an earlier run has measured; writes, prints, draws and checks it.
///
/// # Errors
/// What does not hold of the rows, or which file could not be read or written.
pub fn conduct<E: Experiment>(run: &mut Run, output: &Output) -> Result<(), String> {
    let path = output.folder.join(format!("{}.csv", E::NAME));
    run.settings.clear();
    println!("{}", E::NAME);
    let rows = if output.redraw {
        record::read(&path)?
    } else {
        let rows = E::run(run);
        run.finish();
        if !rows.is_empty() {
            record::write(&path, run, &rows)?;
        }
        rows
    };
    if rows.is_empty() {
        return Ok(());
    }
    println!("{}", E::table(&rows));
    // Findings and titles rest on what is checked.
    E::check(&rows).map_err(|error| format!("{}: {error}", E::NAME))?;
    for finding in E::findings(&rows) {
        println!("  {finding}");
    }
    for chart in E::charts(&rows) {
        chart.save(&output.folder)?;
    }
    println!("  {}\n", path.display());
    Ok(())
}

/// A short run of an experiment, whose rows are checked, written with these first columns, read again and drawn.
#[cfg(test)]
pub fn quick<E: Experiment>(view: View, columns: &str) -> Vec<E::Row> {
    let folder =
        std::env::temp_dir().join(format!("bevy_drape_lab_{}_{}", E::NAME, std::process::id()));
    let mut run = Run::new(true, view);
    let output = |redraw| Output {
        folder: folder.clone(),
        redraw,
    };
    conduct::<E>(&mut run, &output(false)).expect("all that must hold");
    let path = folder.join(format!("{}.csv", E::NAME));
    let text = std::fs::read_to_string(&path).expect("rows were measured");
    let header = text.lines().find(|line| !line.starts_with('#'));
    assert!(
        header.is_some_and(|header| header.starts_with(columns)),
        "{header:?}"
    );
    assert!(text.contains("# machine: ") && text.contains("# run: quick"));
    conduct::<E>(&mut run, &output(true)).expect("the same, from the file");
    let rows: Vec<E::Row> = record::read(&path).expect("it was just written");
    let charts = E::charts(&rows);
    assert!(!charts.is_empty() && !E::findings(&rows).is_empty());
    for chart in charts {
        for file in [
            format!("{}.svg", chart.name),
            format!("{}-dark.png", chart.name),
        ] {
            assert!(folder.join(&file).is_file(), "{file}");
        }
    }
    std::fs::remove_dir_all(folder).expect("it was made");
    rows
}
