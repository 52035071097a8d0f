//! Text, lines and markers, in pixels.

use std::sync::Once;

use bevy_egui::egui::FontDefinitions;
use plotters::{
    coord::Shift,
    element::{DashedPathElement, Drawable, PointCollection},
    prelude::*,
    style::{FontStyle, register_font, text_anchor::Pos},
};

use super::{Kind, Look, theme::Theme};

pub const FONT: &str = "sans-serif";

pub type Area<B> = DrawingArea<B, Shift>;

/// Text is measured by this font; who looks at an SVG sees it in their own.
pub fn use_font() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let fonts = FontDefinitions::default();
        if let Some(data) = fonts.font_data.get("Ubuntu-Light")
            && let std::borrow::Cow::Borrowed(bytes) = data.font
        {
            // Refused, text would be missing, which is seen at once.
            let _ = register_font(FONT, FontStyle::Normal, bytes);
        }
    });
}

/// What is drawn on, by which colours, and how many pixels one is.
pub struct Canvas<'a, B: DrawingBackend> {
    pub area: &'a Area<B>,
    pub theme: &'a Theme,
    pub zoom: i32,
}

impl<B: DrawingBackend> Canvas<'_, B> {
    pub fn put<E>(&self, element: &E) -> Result<(), String>
    where
        for<'e> &'e E: PointCollection<'e, (i32, i32)>,
        E: Drawable<B>,
    {
        self.area.draw(element).map_err(|error| error.to_string())
    }

    pub fn text(
        &self,
        text: &str,
        at: [i32; 2],
        size: i32,
        look: Look,
        pos: Pos,
    ) -> Result<(), String> {
        // Grey is for markers: too pale to be read.
        let color = match look {
            Look::Grey | Look::Faded(_) => self.theme.pale,
            _ => self.theme.color(look),
        };
        let style = TextStyle::from((FONT, size * self.zoom).into_font())
            .color(&color)
            .pos(pos);
        self.area
            .draw_text(text, &style, (at[0], at[1]))
            .map_err(|error| error.to_string())
    }

    /// In pixels.
    pub fn width(&self, text: &str, size: i32) -> i32 {
        let font = (FONT, size * self.zoom).into_font();
        let measured = font.box_size(text).map_or(0, |(width, _)| width);
        // Other fonts are wider.
        (f64::from(measured) * 1.12) as i32
    }

    pub fn wrapped(&self, text: &str, size: i32, width: i32) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        for word in text.split_whitespace() {
            match lines.last_mut() {
                Some(line) if self.width(&format!("{line} {word}"), size) <= width => {
                    line.push(' ');
                    line.push_str(word);
                }
                _ => lines.push(word.into()),
            }
        }
        lines
    }

    pub fn line(&self, points: &[[i32; 2]], look: Look, kind: Kind) -> Result<(), String> {
        let z = self.zoom as u32;
        let stroke = self.theme.color(look).stroke_width(2 * z);
        let points: Vec<(i32, i32)> = points.iter().map(|&[x, y]| (x, y)).collect();
        let dash = match (look, kind) {
            (Look::Ink, Kind::Line) => Some((9, 5)),
            (Look::Style(style) | Look::Faded(style), _) => {
                [None, Some((10, 4)), Some((3, 4)), Some((16, 5))][style % 4]
            }
            _ => None,
        };
        match dash {
            Some((long, gap)) if points.len() > 1 => {
                let dashed = DashedPathElement::new(points, long * z, gap * z, stroke);
                self.put(&dashed)
            }
            _ => self.put(&PathElement::new(points, stroke)),
        }
    }

    pub fn bar(&self, [from, to]: [[i32; 2]; 2], axis: usize, look: Look) -> Result<(), String> {
        let stroke = self.theme.color(look).stroke_width(self.zoom as u32);
        let cap = 3 * self.zoom;
        let (wide, high) = if axis == 0 { (0, cap) } else { (cap, 0) };
        self.put(&PathElement::new(
            vec![(from[0], from[1]), (to[0], to[1])],
            stroke,
        ))?;
        for [x, y] in [from, to] {
            let ends = vec![(x - wide, y - high), (x + wide, y + high)];
            self.put(&PathElement::new(ends, stroke))?;
        }
        Ok(())
    }

    pub fn cell(&self, corners: [[i32; 2]; 2], middle: [i32; 2], look: Look) -> Result<(), String> {
        let fill = self.theme.color(look).mix(0.45).filled();
        let corners = corners.map(|[x, y]| (x, y));
        self.put(&Rectangle::new(corners, fill))?;
        self.marker(middle, look)
    }

    pub fn marker(&self, [x, y]: [i32; 2], look: Look) -> Result<(), String> {
        let z = self.zoom;
        let color = self.theme.color(look);
        let (fill, stroke) = (color.filled(), color.stroke_width(2 * z as u32));
        let shape = |corners: &[(i32, i32)]| -> Vec<(i32, i32)> {
            corners
                .iter()
                .map(|&(across, down)| (x + across * z, y + down * z))
                .collect()
        };
        let path = |corners: &[(i32, i32)]| self.put(&PathElement::new(shape(corners), stroke));
        let polygon = |corners: &[(i32, i32)]| self.put(&Polygon::new(shape(corners), fill));
        match look {
            Look::Grey => self.put(&Circle::new((x, y), 3 * z, fill)),
            Look::Ink => path(&[(-5, 0), (5, 0)]),
            Look::Style(style) | Look::Faded(style) => match style % 8 {
                0 => self.put(&Circle::new((x, y), 5 * z, fill)),
                1 => polygon(&[(0, -6), (6, 5), (-6, 5)]),
                2 => polygon(&[(-5, -5), (5, -5), (5, 5), (-5, 5)]),
                3 => polygon(&[(0, -7), (6, 0), (0, 7), (-6, 0)]),
                4 => {
                    path(&[(-5, -5), (5, 5)])?;
                    path(&[(-5, 5), (5, -5)])
                }
                5 => {
                    path(&[(-6, 0), (6, 0)])?;
                    path(&[(0, -6), (0, 6)])
                }
                6 => self.put(&Circle::new((x, y), 5 * z, stroke)),
                _ => path(&[(-5, -5), (5, -5), (5, 5), (-5, 5), (-5, -5)]),
            },
        }
    }
}
