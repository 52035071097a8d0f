//! Charts as data: what is shown, and not how.

mod draw;
mod geometry;
mod marks;
mod scale;
mod theme;

use std::{fs, path::Path};

pub use scale::{Axis, number};
use theme::Theme;

/// A picture of one or several panels under one heading.
pub struct Chart {
    /// Of its files: `NAME.svg`, `NAME-dark.svg` and the same as PNG.
    pub name: String,
    /// What it says, in a few words.
    pub title: String,
    /// Of what, and under which conditions.
    pub subtitle: String,
    /// Pixels.
    pub size: [u32; 2],
    /// From left to right, row by row.
    pub panels: Vec<Panel>,
    /// Panels side by side.
    pub columns: usize,
}

impl Chart {
    /// As wide as a README shows it, with one panel after the other added to it by [`with`](Self::with).
    pub fn new(name: &str, title: impl Into<String>, subtitle: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            title: title.into(),
            subtitle: subtitle.into(),
            size: [960, 540],
            panels: Vec::new(),
            columns: 1,
        }
    }

    /// With this many pixels across and down.
    pub fn sized(mut self, size: [u32; 2]) -> Self {
        self.size = size;
        self
    }

    /// With this many panels side by side.
    pub fn columns(mut self, columns: usize) -> Self {
        self.columns = columns;
        self
    }

    /// With one more panel.
    pub fn with(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }

    /// Draws it for light and for dark pages, as SVG and as PNG.
    ///
    /// # Errors
    /// Which file could not be written.
    pub fn save(&self, folder: &Path) -> Result<(), String> {
        fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        for theme in [Theme::LIGHT, Theme::DARK] {
            let stem = folder.join(format!("{}{}", self.name, theme.suffix));
            draw::svg(self, &theme, &stem.with_extension("svg"))?;
            draw::png(self, &theme, &stem.with_extension("png"))?;
        }
        Ok(())
    }
}

/// Two axes and what is drawn between them.
pub struct Panel {
    /// Above it; empty for none.
    pub title: String,
    pub x: Axis,
    pub y: Axis,
    pub series: Vec<Series>,
    pub notes: Vec<Note>,
}

impl Panel {
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self {
            title: title.into(),
            x,
            y,
            series: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// With one more series.
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// With a few words at a place.
    pub fn note(mut self, at: [f64; 2], text: impl Into<String>) -> Self {
        let text = text.into();
        self.notes.push(Note { at, text });
        self
    }
}

/// A few words at a place of a panel: they begin a little to the right of it.
pub struct Note {
    pub at: [f64; 2],
    pub text: String,
}

/// How a series is told from others: by colour, marker and dash at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// One of eight.
    Style(usize),
    /// The marker and dash of that one in grey: what stands back, and yet is told apart.
    Faded(usize),
    /// For what stands back.
    Grey,
    /// For limits and truths.
    Ink,
}

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Markers alone.
    Points,
    /// Markers and a line through them.
    Marked,
    /// A line alone, dashed by its look.
    Line,
    /// Squares that fill a map, with the look's marker in them.
    Cells,
}

/// Points that belong together. Series of the same name share one entry of the legend; one without a name has none.
pub struct Series {
    pub name: String,
    pub look: Look,
    pub kind: Kind,
    pub points: Vec<Point>,
}

/// A point with its spread across and up, where it has one.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    pub at: [f64; 2],
    pub across: Option<[f64; 2]>,
    pub up: Option<[f64; 2]>,
}

impl From<[f64; 2]> for Point {
    fn from(at: [f64; 2]) -> Self {
        Self {
            at,
            across: None,
            up: None,
        }
    }
}

impl Series {
    pub fn new<P: Into<Point>>(
        name: impl Into<String>,
        look: Look,
        kind: Kind,
        points: impl IntoIterator<Item = P>,
    ) -> Self {
        Self {
            name: name.into(),
            look,
            kind,
            points: points.into_iter().map(Into::into).collect(),
        }
    }
}
