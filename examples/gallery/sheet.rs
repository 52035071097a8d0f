//! The sheet of all pictures, each with the name of its example.

use std::{
    borrow::Cow,
    fs,
    io::BufReader,
    path::{Path, PathBuf},
};

use bevy_egui::egui::FontDefinitions;
use plotters::{
    prelude::*,
    style::{
        FontStyle, register_font,
        text_anchor::{HPos, Pos, VPos},
    },
};
use png::{Decoder, Transformations};

use crate::pixels::Pixels;

/// Pictures in a row.
const COLUMNS: usize = 3;
/// Size of each (pixels), of what is written below, and between them.
const TILE: [usize; 2] = [320, 180];
const CAPTION: usize = 32;
const GAP: usize = 8;
/// Colours of the ground, of a name, and of what is said of it.
const GROUND: [u8; 3] = [24, 28, 34];
const NAME: RGBColor = RGBColor(255, 214, 150);
const WHAT: RGBColor = RGBColor(196, 204, 214);

const FONT: &str = "sans-serif";
const LETTERS: i32 = 15;

/// A sheet of pictures: the name of an example, what is seen, and the file.
pub fn of(
    pictures: impl Iterator<Item = (&'static str, &'static str, PathBuf)>,
) -> Result<Pixels, String> {
    let pictures: Vec<_> = pictures.collect();
    let rows = pictures.len().div_ceil(COLUMNS);
    let width = COLUMNS * (TILE[0] + GAP) + GAP;
    let height = rows * (TILE[1] + CAPTION) + GAP;
    let mut bytes = GROUND.repeat(width * height);
    for (number, (_, _, path)) in pictures.iter().enumerate() {
        let tile = load(path)?.scaled(TILE[0], TILE[1]);
        let [left, top] = corner(number);
        for (row, line) in tile.rgb.chunks_exact(TILE[0]).enumerate() {
            let from = 3 * ((top + row) * width + left);
            bytes[from..from + 3 * TILE[0]].copy_from_slice(line.as_flattened());
        }
    }
    let captions = pictures
        .iter()
        .enumerate()
        .map(|(number, (name, what, _))| {
            let [left, top] = corner(number);
            Caption {
                texts: [name, what],
                sides: [left + 2, left + TILE[0] - 2],
                middle: top + TILE[1] + CAPTION / 2 - 1,
            }
        });
    written(captions, bytes, [width, height])
}

/// One picture, with its caption below.
pub fn captioned(picture: &Pixels, texts: [&str; 2]) -> Result<Pixels, String> {
    let (width, height) = (picture.width, picture.height + CAPTION);
    let mut bytes = picture.rgb.as_flattened().to_vec();
    bytes.extend(GROUND.repeat(width * CAPTION));
    let caption = Caption {
        texts,
        sides: [GAP, width - GAP],
        middle: picture.height + CAPTION / 2 - 1,
    };
    written([caption].into_iter(), bytes, [width, height])
}

/// The name of an example from the left, and what is seen up to the right: where they begin and end, and their middle's height.
struct Caption<'a> {
    texts: [&'a str; 2],
    sides: [usize; 2],
    middle: usize,
}

/// A picture of this width and height, with captions in it.
fn written<'a>(
    captions: impl Iterator<Item = Caption<'a>>,
    mut bytes: Vec<u8>,
    [width, height]: [usize; 2],
) -> Result<Pixels, String> {
    use_font();
    let size = (width as u32, height as u32);
    let area = BitMapBackend::with_buffer(&mut bytes, size).into_drawing_area();
    for caption in captions {
        for (text, x, side, color) in [
            (caption.texts[0], caption.sides[0], HPos::Left, NAME),
            (caption.texts[1], caption.sides[1], HPos::Right, WHAT),
        ] {
            let style = TextStyle::from((FONT, LETTERS).into_font())
                .color(&color)
                .pos(Pos::new(side, VPos::Center));
            area.draw_text(text, &style, (x as i32, caption.middle as i32))
                .map_err(|error| error.to_string())?;
        }
    }
    area.present().map_err(|error| error.to_string())?;
    drop(area);
    let rgb = bytes.chunks_exact(3).map(|at| [at[0], at[1], at[2]]);
    Ok(Pixels {
        width,
        height,
        rgb: rgb.collect(),
    })
}

/// Left and upper edge of the picture with this number.
fn corner(number: usize) -> [usize; 2] {
    [
        GAP + number % COLUMNS * (TILE[0] + GAP),
        GAP + number / COLUMNS * (TILE[1] + CAPTION),
    ]
}

/// The panel's, which every example has.
fn use_font() {
    let fonts = FontDefinitions::default();
    if let Some(data) = fonts.font_data.get("Ubuntu-Light")
        && let Cow::Borrowed(bytes) = data.font
    {
        // Refused, text would be missing, which is seen at once.
        let _ = register_font(FONT, FontStyle::Normal, bytes);
    }
}

/// A picture that an example has saved.
pub fn load(path: &Path) -> Result<Pixels, String> {
    let fail = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let file = fs::File::open(path).map_err(|error| fail(&error))?;
    let mut decoder = Decoder::new(BufReader::new(file));
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(|error| fail(&error))?;
    let size = reader.output_buffer_size().unwrap_or_default();
    let mut bytes = vec![0; size];
    let info = reader
        .next_frame(&mut bytes)
        .map_err(|error| fail(&error))?;
    let pixels = bytes[..info.buffer_size()].chunks_exact(info.color_type.samples());
    let rgb = pixels
        .map(|at| <[u8; 3]>::try_from(at).map_err(|_| fail(&"it is not of three colours")))
        .collect::<Result<_, _>>()?;
    Ok(Pixels {
        width: info.width as usize,
        height: info.height as usize,
        rgb,
    })
}
