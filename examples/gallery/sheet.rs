//! The sheet of all pictures, each with the name of its example.

use std::{
    fs,
    io::BufReader,
    path::{Path, PathBuf},
};

use bevy_egui::egui::{
    Color32, FontDefinitions, FontId,
    epaint::text::{Fonts, FontsView, TextOptions},
};
use examples_shared::pixels::Pixels;
use png::{Decoder, Transformations};

/// Pictures in a row.
const COLUMNS: usize = 3;
/// Size of each (pixels), of what is written below, and between them.
const TILE: [usize; 2] = [320, 180];
const CAPTION: usize = 32;
const GAP: usize = 8;
/// Colours of the ground, of a name, and of what is said of it.
const GROUND: [u8; 3] = [24, 28, 34];
const NAME: [u8; 3] = [255, 214, 150];
const WHAT: [u8; 3] = [196, 204, 214];

/// Size of letters (pixels).
const LETTERS: f32 = 15.0;

/// A sheet of pictures: the name of an example, what is seen, and the file.
pub fn of(
    pictures: impl Iterator<Item = (&'static str, &'static str, PathBuf)>,
) -> Result<Pixels, String> {
    let pictures: Vec<_> = pictures.collect();
    let rows = pictures.len().div_ceil(COLUMNS);
    let width = COLUMNS * (TILE[0] + GAP) + GAP;
    let height = rows * (TILE[1] + CAPTION) + GAP;
    let mut rgb = vec![GROUND; width * height];
    for (number, (_, _, path)) in pictures.iter().enumerate() {
        let tile = load(path)?.scaled(TILE[0], TILE[1]);
        let [left, top] = corner(number);
        for (row, line) in tile.rgb.chunks_exact(TILE[0]).enumerate() {
            let from = (top + row) * width + left;
            rgb[from..from + TILE[0]].copy_from_slice(line);
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
    let mut sheet = Pixels { width, height, rgb };
    write(captions, &mut sheet);
    Ok(sheet)
}

/// One picture, with its caption below.
pub fn captioned(picture: &Pixels, texts: [&str; 2]) -> Pixels {
    let (width, height) = (picture.width, picture.height + CAPTION);
    let mut rgb = picture.rgb.clone();
    rgb.resize(width * height, GROUND);
    let caption = Caption {
        texts,
        sides: [GAP, width - GAP],
        middle: picture.height + CAPTION / 2 - 1,
    };
    let mut captioned = Pixels { width, height, rgb };
    write([caption].into_iter(), &mut captioned);
    captioned
}

/// The name of an example from the left, and what is seen up to the right: where they begin and end, and their middle's height.
struct Caption<'a> {
    texts: [&'a str; 2],
    sides: [usize; 2],
    middle: usize,
}

/// Writes captions into a picture, in the panel's font, which every example has.
fn write<'a>(captions: impl Iterator<Item = Caption<'a>>, picture: &mut Pixels) {
    let mut fonts = Fonts::new(TextOptions::default(), FontDefinitions::default());
    let mut fonts = fonts.with_pixels_per_point(1.0);
    for caption in captions {
        let ([name, what], [left, right]) = (caption.texts, caption.sides);
        let [_, end] = write_text(&mut fonts, picture, (name, NAME), |_| left, caption.middle);
        let left = |width| right.saturating_sub(width);
        let [begin, _] = write_text(&mut fonts, picture, (what, WHAT), left, caption.middle);
        assert!(end < begin, "no place for “{what}” beside “{name}”");
    }
}

/// Writes a text in a colour: by its width, where it begins; and the height of its middle. Returns where it begins and ends.
fn write_text(
    fonts: &mut FontsView,
    picture: &mut Pixels,
    (text, color): (&str, [u8; 3]),
    left: impl Fn(usize) -> usize,
    middle: usize,
) -> [usize; 2] {
    let font = FontId::proportional(LETTERS);
    let laid = fonts.layout_no_wrap(text.to_owned(), font, Color32::WHITE);
    let letters = fonts.image();
    let width = laid.size().x.ceil() as usize;
    let begin = left(width);
    let start = [begin as f32, middle as f32 - 0.5 * laid.size().y];
    for row in &laid.rows {
        for glyph in &row.glyphs {
            let at = row.pos + glyph.pos.to_vec2() + glyph.uv_rect.offset;
            let [from, to] = [glyph.uv_rect.min, glyph.uv_rect.max].map(|at| at.map(usize::from));
            let corner = [start[0] + at.x, start[1] + at.y].map(|at| at.round() as usize);
            for y in from[1]..to[1] {
                for x in from[0]..to[0] {
                    let covered = f32::from(letters.pixels[y * letters.size[0] + x].a()) / 255.0;
                    let [column, row] = [corner[0] + x - from[0], corner[1] + y - from[1]];
                    if column < picture.width && row < picture.height {
                        let pixel = &mut picture.rgb[row * picture.width + column];
                        *pixel = std::array::from_fn(|at| {
                            let [under, over] = [pixel[at], color[at]].map(f32::from);
                            (under + covered * (over - under)).round() as u8
                        });
                    }
                }
            }
        }
    }
    [begin, begin + width]
}

/// Left and upper edge of the picture with this number.
fn corner(number: usize) -> [usize; 2] {
    [
        GAP + number % COLUMNS * (TILE[0] + GAP),
        GAP + number / COLUMNS * (TILE[1] + CAPTION),
    ]
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
