//! Colours for light and for dark pages.

use plotters::style::RGBColor;

use super::Look;

pub struct Theme {
    /// Of file names.
    pub suffix: &'static str,
    pub background: RGBColor,
    pub ink: RGBColor,
    /// For what is read second.
    pub pale: RGBColor,
    /// For what stands back.
    pub grey: RGBColor,
    /// For grids.
    pub faint: RGBColor,
    styles: [RGBColor; 8],
}

impl Theme {
    /// The colours that Okabe and Ito (2008) chose for those who are colour-blind, the yellow darkened for white paper.
    pub const LIGHT: Self = Self {
        suffix: "",
        background: RGBColor(255, 255, 255),
        ink: RGBColor(31, 35, 40),
        pale: RGBColor(87, 96, 106),
        grey: RGBColor(150, 157, 165),
        faint: RGBColor(225, 228, 232),
        styles: [
            RGBColor(0, 114, 178),
            RGBColor(213, 94, 0),
            RGBColor(0, 158, 115),
            RGBColor(204, 121, 167),
            RGBColor(230, 159, 0),
            RGBColor(86, 180, 233),
            RGBColor(120, 94, 10),
            RGBColor(90, 90, 90),
        ],
    };

    /// The same, brighter.
    pub const DARK: Self = Self {
        suffix: "-dark",
        background: RGBColor(13, 17, 23),
        ink: RGBColor(230, 237, 243),
        pale: RGBColor(160, 168, 178),
        grey: RGBColor(110, 118, 129),
        faint: RGBColor(38, 44, 52),
        styles: [
            RGBColor(74, 163, 223),
            RGBColor(255, 133, 51),
            RGBColor(34, 197, 148),
            RGBColor(229, 154, 194),
            RGBColor(240, 180, 41),
            RGBColor(150, 212, 250),
            RGBColor(200, 170, 90),
            RGBColor(180, 180, 180),
        ],
    };

    pub fn color(&self, look: Look) -> RGBColor {
        match look {
            Look::Style(style) => self.styles[style % self.styles.len()],
            Look::Grey | Look::Faded(_) => self.grey,
            Look::Ink => self.ink,
        }
    }
}
