//! Draws a chart by plotters.

use std::{path::Path, sync::Once};

use bevy::{
    asset::RenderAssetUsages,
    image::Image,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};
use bevy_egui::egui::FontDefinitions;
use plotters::{
    coord::{Shift, ranged1d::ValueFormatter},
    element::{DashedPathElement, Drawable, PointCollection},
    prelude::*,
    style::{
        FontStyle, register_font,
        text_anchor::{HPos, Pos, VPos},
    },
};

use super::{Chart, Kind, Look, Panel, Point, Series, theme::Theme};

const FONT: &str = "sans-serif";

type Area<B> = DrawingArea<B, Shift>;

/// As an SVG file.
pub fn svg(chart: &Chart, theme: &Theme, path: &Path) -> Result<(), String> {
    let [width, height] = chart.size;
    let area = SVGBackend::new(path, (width, height)).into_drawing_area();
    Canvas {
        area: &area,
        theme,
        zoom: 1,
    }
    .draw(chart)?;
    area.present()
        .map_err(|error| format!("{}: {error}", path.display()))
}

/// As a PNG file, at twice the size.
pub fn png(chart: &Chart, theme: &Theme, path: &Path) -> Result<(), String> {
    let [width, height] = chart.size.map(|pixels| 2 * pixels);
    let mut pixels = vec![0; 3 * (width * height) as usize];
    {
        let area = BitMapBackend::with_buffer(&mut pixels, (width, height)).into_drawing_area();
        Canvas {
            area: &area,
            theme,
            zoom: 2,
        }
        .draw(chart)?;
    }
    let rgba = pixels
        .chunks_exact(3)
        .flat_map(|rgb| [rgb[0], rgb[1], rgb[2], u8::MAX]);
    let image = Image::new(
        Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        rgba.collect(),
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::MAIN_WORLD,
    );
    let fail = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let image = image.try_into_dynamic().map_err(|error| fail(&error))?;
    image.to_rgb8().save(path).map_err(|error| fail(&error))
}

/// Text is measured by this font; who looks at an SVG sees it in their own.
fn use_font() {
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

struct Canvas<'a, B: DrawingBackend> {
    area: &'a Area<B>,
    theme: &'a Theme,
    zoom: i32,
}

impl<B: DrawingBackend> Canvas<'_, B> {
    fn draw(&self, chart: &Chart) -> Result<(), String> {
        use_font();
        let fail = |error: &dyn std::fmt::Display| error.to_string();
        self.area
            .fill(&self.theme.background)
            .map_err(|error| fail(&error))?;
        let z = self.zoom;
        let (width, height) = self.area.dim_in_pixel();
        let mut top = 14 * z;
        for line in self.wrapped(&chart.title, 23, width as i32 - 40 * z) {
            self.text(
                &line,
                [20 * z, top],
                23,
                Look::Ink,
                Pos::new(HPos::Left, VPos::Top),
            )?;
            top += 29 * z;
        }
        for line in self.wrapped(&chart.subtitle, 14, width as i32 - 40 * z) {
            self.text(
                &line,
                [20 * z, top],
                14,
                Look::Grey,
                Pos::new(HPos::Left, VPos::Top),
            )?;
            top += 19 * z;
        }
        top = self.legend(chart, top + 6 * z)?;
        let columns = chart.columns.max(1);
        let rows = chart.panels.len().div_ceil(columns).max(1);
        let (wide, high) = (
            (width as i32 - 16 * z) / columns as i32,
            (height as i32 - top - 8 * z) / rows as i32,
        );
        for (index, panel) in chart.panels.iter().enumerate() {
            let (row, column) = ((index / columns) as i32, (index % columns) as i32);
            let place = self.area.clone().shrink(
                (8 * z + column * wide, top + row * high),
                (wide as u32, high as u32),
            );
            self.panel(panel, &place, [8 * z + column * wide, top + row * high])?;
        }
        Ok(())
    }

    /// Each name of what is drawn once, with its marker, line by line. Returns where it ends.
    fn legend(&self, chart: &Chart, top: i32) -> Result<i32, String> {
        let z = self.zoom;
        let mut known: Vec<&Series> = Vec::new();
        for series in chart.panels.iter().flat_map(|panel| &panel.series) {
            let is_new = known.iter().all(|other| other.name != series.name);
            if !series.name.is_empty() && !series.points.is_empty() && is_new {
                known.push(series);
            }
        }
        let (mut x, mut y) = (22 * z, top + 8 * z);
        for series in &known {
            let wide = self.width(&series.name, 15) + 52 * z;
            if x + wide > self.area.dim_in_pixel().0 as i32 && x > 22 * z {
                (x, y) = (22 * z, y + 22 * z);
            }
            if matches!(series.kind, Kind::Marked | Kind::Line) {
                self.line(&[[x, y], [x + 24 * z, y]], series.look, series.kind)?;
            }
            if series.kind == Kind::Cells {
                let corners = [[x + z, y - 9 * z], [x + 23 * z, y + 9 * z]];
                self.cell(corners, [x + 12 * z, y], series.look)?;
            } else if series.kind != Kind::Line {
                self.marker([x + 12 * z, y], series.look)?;
            }
            // Text stands a little above its middle.
            let at = [x + 32 * z, y + 2 * z];
            self.text(
                &series.name,
                at,
                15,
                Look::Ink,
                Pos::new(HPos::Left, VPos::Center),
            )?;
            x += wide;
        }
        Ok(if known.is_empty() { top } else { y + 18 * z })
    }

    fn panel(&self, panel: &Panel, place: &Area<B>, origin: [i32; 2]) -> Result<(), String> {
        let z = self.zoom;
        let values = |axis: usize| {
            let points = panel.series.iter().flat_map(|series| &series.points);
            points.flat_map(move |point| {
                let spread = if axis == 0 { point.across } else { point.up };
                std::iter::once(point.at[axis]).chain(spread.into_iter().flatten())
            })
        };
        let (x, y) = (panel.x.scale(values(0)), panel.y.scale(values(1)));
        let longest = panel
            .y
            .names
            .iter()
            .map(|(_, name)| self.width(name, 14))
            .max();
        let title = if panel.title.is_empty() { 6 } else { 30 };
        let (wide, high) = place.dim_in_pixel();
        let mut builder = ChartBuilder::on(place);
        builder
            .margin_top(title * z)
            .margin_right(18 * z)
            .x_label_area_size(44 * z)
            .y_label_area_size(longest.map_or(64 * z, |longest| longest + 40 * z));
        let mut chart = builder
            .build_cartesian_2d(x.clone(), y.clone())
            .map_err(|error| error.to_string())?;
        let style =
            |size: i32| TextStyle::from((FONT, size * z).into_font()).color(&self.theme.ink);
        chart
            .configure_mesh()
            .x_desc(&panel.x.label)
            .y_desc(&panel.y.label)
            .x_labels((wide as usize / (70 * z as usize)).max(2))
            .y_labels((high as usize / (44 * z as usize)).max(2))
            .max_light_lines(0)
            .x_label_formatter(&|value| x.format_ext(value))
            .y_label_formatter(&|value| y.format_ext(value))
            .label_style(style(14))
            .axis_desc_style(style(15))
            .axis_style(self.theme.grey)
            .bold_line_style(self.theme.faint.stroke_width(z as u32))
            .light_line_style(TRANSPARENT)
            .draw()
            .map_err(|error| error.to_string())?;
        let (plot_x, plot_y) = chart.plotting_area().get_pixel_range();
        if !panel.title.is_empty() {
            let at = [plot_x.start, origin[1] + 16 * z];
            self.text(
                &panel.title,
                at,
                17,
                Look::Ink,
                Pos::new(HPos::Left, VPos::Center),
            )?;
        }
        let pixel = |at: [f64; 2]| {
            let (x, y) = chart.backend_coord(&(at[0], at[1]));
            [x, y]
        };
        let is_inside = |at: [i32; 2]| {
            (plot_x.start - z..=plot_x.end + z).contains(&at[0])
                && (plot_y.start - z..=plot_y.end + z).contains(&at[1])
        };
        let cells = cells_along(&panel.series, &pixel);
        let (low, high) = ([plot_x.start, plot_y.start], [plot_x.end, plot_y.end]);
        for series in &panel.series {
            let shown: Vec<&Point> = series
                .points
                .iter()
                .filter(|point| panel.x.shows(point.at[0]) && panel.y.shows(point.at[1]))
                .filter(|point| is_inside(pixel(point.at)))
                .collect();
            let at: Vec<[i32; 2]> = shown.iter().map(|point| pixel(point.at)).collect();
            if series.kind == Kind::Line {
                // To the edge, where it goes beyond.
                let points = series.points.iter().map(|point| pixel(point.at));
                for part in clipped(&points.collect::<Vec<_>>(), [low, high]) {
                    self.line(&part, series.look, series.kind)?;
                }
            } else if series.kind == Kind::Marked {
                self.line(&at, series.look, series.kind)?;
            }
            for (point, at) in shown.iter().zip(&at) {
                for (ends, axis) in [(point.across, 0), (point.up, 1)] {
                    let Some(ends) = ends else { continue };
                    let bar = ends.map(|end| {
                        let mut place = point.at;
                        place[axis] = end;
                        pixel(place)
                    });
                    self.bar(bar, axis, series.look)?;
                }
                if series.kind == Kind::Cells {
                    let ends = [0, 1].map(|axis| ends_of_cell(&cells[axis], at[axis]));
                    let corner = |end: usize| {
                        [0, 1].map(|axis| ends[axis][end].clamp(low[axis], high[axis]))
                    };
                    self.cell([corner(0), corner(1)], *at, series.look)?;
                } else if series.kind != Kind::Line {
                    self.marker(*at, series.look)?;
                }
            }
        }
        for note in &panel.notes {
            let [x, y] = pixel(note.at);
            // To the left of it, where it would go beyond the right.
            let wide = self.width(&note.text, 14);
            let (x, side) = if x + wide + 12 * z > plot_x.end + 16 * z {
                (x - 10 * z, HPos::Right)
            } else {
                (x + 10 * z, HPos::Left)
            };
            self.text(
                &note.text,
                [x, y],
                14,
                Look::Ink,
                Pos::new(side, VPos::Center),
            )?;
        }
        Ok(())
    }

    fn put<E>(&self, element: &E) -> Result<(), String>
    where
        for<'e> &'e E: PointCollection<'e, (i32, i32)>,
        E: Drawable<B>,
    {
        self.area.draw(element).map_err(|error| error.to_string())
    }

    fn text(
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
    fn width(&self, text: &str, size: i32) -> i32 {
        let font = (FONT, size * self.zoom).into_font();
        let measured = font.box_size(text).map_or(0, |(width, _)| width);
        // Other fonts are wider.
        (f64::from(measured) * 1.12) as i32
    }

    fn wrapped(&self, text: &str, size: i32, width: i32) -> Vec<String> {
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

    fn line(&self, points: &[[i32; 2]], look: Look, kind: Kind) -> Result<(), String> {
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

    fn bar(&self, [from, to]: [[i32; 2]; 2], axis: usize, look: Look) -> Result<(), String> {
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

    fn cell(&self, corners: [[i32; 2]; 2], middle: [i32; 2], look: Look) -> Result<(), String> {
        let fill = self.theme.color(look).mix(0.45).filled();
        let corners = corners.map(|[x, y]| (x, y));
        self.put(&Rectangle::new(corners, fill))?;
        self.marker(middle, look)
    }

    fn marker(&self, [x, y]: [i32; 2], look: Look) -> Result<(), String> {
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

/// Where the middles of cells are across and down (pixels).
fn cells_along(series: &[Series], pixel: &impl Fn([f64; 2]) -> [i32; 2]) -> [Vec<i32>; 2] {
    let cells = series.iter().filter(|series| series.kind == Kind::Cells);
    let places: Vec<[i32; 2]> = cells
        .flat_map(|series| &series.points)
        .map(|point| pixel(point.at))
        .collect();
    [0, 1].map(|axis| {
        let mut along: Vec<i32> = places.iter().map(|place| place[axis]).collect();
        along.sort_unstable();
        along.dedup_by(|a, b| *a - *b <= 2);
        along
    })
}

/// From where to where a cell goes: half-way to its neighbours.
fn ends_of_cell(along: &[i32], at: i32) -> [i32; 2] {
    let index = along.partition_point(|&place| place < at - 2);
    let half = |a: Option<&i32>, b: Option<&i32>| a.zip(b).map(|(a, b)| (b - a) as f32 / 2.0);
    let before = half(index.checked_sub(1).map(|i| &along[i]), along.get(index));
    let after = half(along.get(index), along.get(index + 1));
    // At a border it is as far as to the other side.
    let low = before.or(after).unwrap_or(20.0);
    let high = after.or(before).unwrap_or(20.0);
    [at as f32 - low, at as f32 + high].map(|end| end.round() as i32)
}

/// What of a line is between two corners, in parts.
fn clipped(points: &[[i32; 2]], [low, high]: [[i32; 2]; 2]) -> Vec<Vec<[i32; 2]>> {
    let mut parts: Vec<Vec<[i32; 2]>> = Vec::new();
    for pair in points.windows(2) {
        let from = pair[0].map(f64::from);
        let way = [0, 1].map(|axis| f64::from(pair[1][axis]) - from[axis]);
        // From which part of it to which it is inside (Liang and Barsky 1984).
        let (mut begin, mut end) = (0.0_f64, 1.0_f64);
        for axis in 0..2 {
            let (near, far) = (
                f64::from(low[axis]) - from[axis],
                f64::from(high[axis]) - from[axis],
            );
            if way[axis] == 0.0 {
                if near > 0.0 || far < 0.0 {
                    end = -1.0;
                }
                continue;
            }
            let (a, b) = (near / way[axis], far / way[axis]);
            (begin, end) = (begin.max(a.min(b)), end.min(a.max(b)));
        }
        if begin > end {
            continue;
        }
        let at = |part: f64| [0, 1].map(|axis| (from[axis] + part * way[axis]).round() as i32);
        match parts.last_mut() {
            Some(last) if last.last() == Some(&at(begin)) => last.push(at(end)),
            _ => parts.push(vec![at(begin), at(end)]),
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_meet_half_way() {
        let along = [10, 20, 40];
        assert_eq!(ends_of_cell(&along, 10), [5, 15]);
        assert_eq!(ends_of_cell(&along, 20), [15, 30]);
        assert_eq!(ends_of_cell(&along, 40), [30, 50]);
        assert_eq!(ends_of_cell(&[7], 7), [-13, 27]);
    }

    #[test]
    fn lines_end_at_the_edge() {
        let corners = [[0, 0], [10, 10]];
        assert_eq!(
            clipped(&[[-5, 5], [5, 5], [5, 25]], corners),
            [vec![[0, 5], [5, 5], [5, 10]]]
        );
        assert_eq!(
            clipped(&[[2, 2], [2, 30], [4, 30], [4, 4]], corners),
            [vec![[2, 2], [2, 10]], vec![[4, 10], [4, 4]]]
        );
        assert!(clipped(&[[-5, 0], [-5, 9]], corners).is_empty());
    }
}
