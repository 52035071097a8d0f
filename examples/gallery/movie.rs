//! The moving picture: some examples in turn, each in motion, as one animated PNG.

use std::{fs, io::BufWriter, path::Path};

use examples_shared::pixels::{Palette, Pixels};
use png::{BitDepth, BlendOp, ColorType, Compression, Encoder, EncodingError, Filter, Writer};

/// How long a frame is shown: ticks of 1/64 s.
pub const FRAME_TICKS: u16 = 5;
pub const TICKS_A_SECOND: u16 = 64;

/// How many frames each scene has.
pub const FRAMES: u32 = 28;

/// An example, and when its scene begins (s): where its cloth moves most.
pub const SCENES: [(&str, f64); 5] = [
    ("flag", 4.0),
    ("cape", 1.9),
    ("dress", 0.75),
    ("hammock", 0.15),
    ("fold", 0.5),
];

/// The colour that leaves what is there as it is.
const UNCHANGED: u8 = 0;

/// Saves frames of one size, which are shown over and over again.
pub fn save(frames: &[Pixels], path: &Path) -> Result<(), String> {
    let fail = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let file = fs::File::create(path).map_err(|error| fail(&error))?;
    write(frames, BufWriter::new(file)).map_err(|error| fail(&error))
}

fn write(frames: &[Pixels], to: impl std::io::Write) -> Result<(), EncodingError> {
    let [width, height] = frames
        .first()
        .map_or([0; 2], |frame| [frame.width, frame.height]);
    let palette = Palette::of(frames, 255);
    let mut encoder = Encoder::new(to, width as u32, height as u32);
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::High);
    encoder.set_filter(Filter::NoFilter);
    encoder.set_palette([&[[0; 3]], &*palette.colors].concat().into_flattened());
    encoder.set_trns(&[UNCHANGED][..]);
    encoder.set_animated(frames.len() as u32, 0)?;
    encoder.set_frame_delay(FRAME_TICKS, TICKS_A_SECOND)?;
    encoder.set_blend_op(BlendOp::Over)?;
    let mut writer = encoder.write_header()?;
    let mut shown = vec![UNCHANGED; width * height];
    for frame in frames {
        let mut numbers = palette.numbers_of(frame);
        numbers.iter_mut().for_each(|number| *number += 1);
        let part = Part::changed(&shown, &numbers, width);
        write_part(&mut writer, &part)?;
        shown = numbers;
    }
    writer.finish()
}

fn write_part(writer: &mut Writer<impl std::io::Write>, part: &Part) -> Result<(), EncodingError> {
    let [[left, top], [width, height]] =
        [part.corner, part.size].map(|pair| pair.map(|at| at as u32));
    // The part before is in the way: a place is refused that does not go with its size.
    writer.reset_frame_position()?;
    writer.set_frame_dimension(width, height)?;
    writer.set_frame_position(left, top)?;
    writer.write_image_data(&part.numbers)
}

/// The least rectangle in which a frame differs from the one before.
struct Part {
    /// Left and upper edge, width and height.
    corner: [usize; 2],
    size: [usize; 2],
    numbers: Vec<u8>,
}

impl Part {
    fn changed(before: &[u8], after: &[u8], width: usize) -> Self {
        let [mut low, mut high] = [[usize::MAX; 2], [0; 2]];
        let is_changed = |place: &usize| before[*place] != after[*place];
        for place in (0..after.len()).filter(is_changed) {
            for (axis, at) in [place % width, place / width].into_iter().enumerate() {
                low[axis] = low[axis].min(at);
                high[axis] = high[axis].max(at + 1);
            }
        }
        // Where nothing has changed: a frame has a pixel at least.
        if low[0] == usize::MAX {
            [low, high] = [[0; 2], [1; 2]];
        }
        let places = (low[1]..high[1]).flat_map(|y| (low[0]..high[0]).map(move |x| y * width + x));
        let number = |place| match before[place] == after[place] {
            true => UNCHANGED,
            false => after[place],
        };
        Self {
            corner: low,
            size: [high[0] - low[0], high[1] - low[1]],
            numbers: places.map(number).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use png::{Decoder, Transformations};

    use super::*;

    /// A red square that moves over grey, and stays once.
    fn frames() -> Vec<Pixels> {
        let frame = |left: usize| {
            let is_red =
                |at: usize| (left..left + 4).contains(&(at % 20)) && (3..7).contains(&(at / 20));
            let color = |at| {
                if is_red(at) {
                    [200, 30, 20]
                } else {
                    [90, 90, 90]
                }
            };
            Pixels {
                width: 20,
                height: 10,
                rgb: (0..200).map(color).collect(),
            }
        };
        [1, 5, 5, 16, 0].map(frame).into()
    }

    #[test]
    fn a_movie_has_the_frames_that_were_put_into_it() {
        let frames = frames();
        let mut file = Vec::new();
        write(&frames, &mut file).expect("it can be written");
        let mut decoder = Decoder::new(Cursor::new(file));
        decoder.set_transformations(Transformations::EXPAND);
        let mut reader = decoder.read_info().expect("it is a PNG");
        assert_eq!(reader.info().size(), (20, 10));
        let animation = reader.info().animation_control.expect("it is animated");
        assert_eq!((animation.num_frames, animation.num_plays), (5, 0));
        let mut shown = vec![[0; 3]; 200];
        let mut bytes = vec![0; reader.output_buffer_size().expect("it is small")];
        for (number, frame) in frames.iter().enumerate() {
            let info = reader.next_frame(&mut bytes).expect("it has this frame");
            let control = *reader.info().frame_control().expect("it is a frame's");
            assert_eq!(
                (control.delay_num, control.delay_den),
                (FRAME_TICKS, TICKS_A_SECOND)
            );
            let pixels = bytes[..info.buffer_size()].chunks_exact(4);
            for (at, pixel) in pixels.enumerate() {
                let x = control.x_offset as usize + at % info.width as usize;
                let y = control.y_offset as usize + at / info.width as usize;
                if pixel[3] > 0 {
                    shown[y * 20 + x] = [pixel[0], pixel[1], pixel[2]];
                }
            }
            assert_eq!(shown, frame.rgb, "frame {number}");
        }
    }

    #[test]
    fn only_what_has_changed_is_written() {
        let before = [1, 1, 1, 1, 2, 1, 1, 1, 1];
        let after = [1, 1, 1, 1, 1, 2, 1, 1, 1];
        let part = Part::changed(&before, &after, 3);
        assert_eq!((part.corner, part.size), ([1, 1], [2, 1]));
        assert_eq!(part.numbers, [1, 2]);
        let part = Part::changed(&before, &before, 3);
        assert_eq!((part.corner, part.size), ([0, 0], [1, 1]));
        assert_eq!(part.numbers, [UNCHANGED]);
    }
}
