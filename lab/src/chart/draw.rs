//! Draws a chart by plotters.

use std::path::Path;

use bevy::{
    asset::RenderAssetUsages,
    image::Image,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};
use plotters::{
    coord::ranged1d::ValueFormatter,
    prelude::*,
    style::text_anchor::{HPos, Pos, VPos},
};

use super::{
    Chart, Kind, Look, Panel, Point, Series,
    geometry::{cells_along, clipped, ends_of_cell},
    marks::{Area, Canvas, FONT, use_font},
    theme::Theme,
};

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
}
