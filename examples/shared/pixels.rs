//! Pictures as files: PNG, of all colours or of at most 256, which is a third as large.

use std::{collections::BTreeMap, fs, io::BufWriter, path::Path};

use png::{BitDepth, ColorType, Compression, Encoder, Filter};

/// A picture, row by row from the top.
pub struct Pixels {
    pub width: usize,
    pub height: usize,
    pub rgb: Vec<[u8; 3]>,
}

impl Pixels {
    /// Smaller, of this width and height: the mean of what each pixel covers, so that edges are smooth.
    pub fn scaled(&self, width: usize, height: usize) -> Self {
        let mean = |place: usize| {
            let across = covered(place % width, width, self.width);
            let down = covered(place / width, height, self.height);
            let (mut sum, mut whole) = ([0.0; 3], 0.0);
            for (row, part) in &down {
                for (column, share) in &across {
                    let color = self.rgb[row * self.width + column];
                    let weight = part * share;
                    whole += weight;
                    for (sum, value) in sum.iter_mut().zip(color) {
                        *sum += weight * f32::from(value);
                    }
                }
            }
            sum.map(|sum| (sum / whole).round() as u8)
        };
        Self {
            width,
            height,
            rgb: (0..width * height).map(mean).collect(),
        }
    }

    /// Saves it, in as many colours as given at most, those that it needs most, or else in all.
    pub fn save(&self, path: &Path, colors: Option<usize>) -> Result<(), String> {
        let fail = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        let file = fs::File::create(path).map_err(|error| fail(&error))?;
        let mut encoder = Encoder::new(BufWriter::new(file), self.width as u32, self.height as u32);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_compression(Compression::High);
        let bytes = match colors {
            Some(colors) => {
                let palette = Palette::of([self], colors);
                encoder.set_color(ColorType::Indexed);
                encoder.set_palette(palette.colors.as_flattened().to_vec());
                // Numbers of colours have no slope that could be foretold.
                encoder.set_filter(Filter::NoFilter);
                palette.numbers_of(self)
            }
            None => {
                encoder.set_color(ColorType::Rgb);
                self.rgb.as_flattened().to_vec()
            }
        };
        let mut writer = encoder.write_header().map_err(|error| fail(&error))?;
        writer
            .write_image_data(&bytes)
            .and_then(|()| writer.finish())
            .map_err(|error| fail(&error))
    }
}

/// The colours that pictures need most.
pub struct Palette {
    pub colors: Vec<[u8; 3]>,
    /// Which of them stands for each of the pictures' own.
    numbers: BTreeMap<[u8; 3], u8>,
}

impl Palette {
    /// At most as many as given, and 256.
    pub fn of<'a>(pictures: impl IntoIterator<Item = &'a Pixels>, colors: usize) -> Self {
        let mut counts = BTreeMap::<[u8; 3], u64>::new();
        for color in pictures.into_iter().flat_map(|picture| &picture.rgb) {
            *counts.entry(*color).or_default() += 1;
        }
        let mut palette = Self {
            colors: Vec::new(),
            numbers: BTreeMap::new(),
        };
        let groups = groups(counts.into_iter().collect(), colors.min(256));
        for (number, group) in groups.iter().enumerate() {
            let color = mean(group).map(|value| value.round() as u8);
            palette.colors.push(color);
            let colors = group.iter().map(|(color, _)| (*color, number as u8));
            palette.numbers.extend(colors);
        }
        palette
    }

    /// The number of each pixel's colour, of one of the pictures.
    pub fn numbers_of(&self, picture: &Pixels) -> Vec<u8> {
        let colors = picture.rgb.iter();
        colors.map(|color| self.numbers[color]).collect()
    }
}

/// Which of `whole` pixels the one at this place of `count` covers, and how much of each.
fn covered(place: usize, count: usize, whole: usize) -> Vec<(usize, f32)> {
    let scale = whole as f32 / count as f32;
    let (from, to) = (place as f32 * scale, (place + 1) as f32 * scale);
    let part = |pixel: usize| to.min((pixel + 1) as f32) - from.max(pixel as f32);
    let pixels = from as usize..(to.ceil() as usize).min(whole);
    pixels.map(|pixel| (pixel, part(pixel))).collect()
}

/// Colours that are alike, with how often each occurs.
type Group = Vec<([u8; 3], u64)>;

/// Cuts colours into at most this many groups: again and again the one that is spread most, at the mean of the channel in which it is.
fn groups(all: Group, most: usize) -> Vec<Group> {
    let mut groups = vec![(spread(&all), all)];
    while groups.len() < most {
        let widest = groups
            .iter()
            .enumerate()
            .max_by(|(_, (one, _)), (_, (other, _))| one.1.total_cmp(&other.1));
        let Some((place, &((channel, sum), _))) = widest else {
            break;
        };
        if sum == 0.0 {
            break;
        }
        let (_, group) = groups.swap_remove(place);
        let middle = mean(&group)[channel];
        let (low, high): (Group, Group) = group
            .into_iter()
            .partition(|(color, _)| f64::from(color[channel]) <= middle);
        groups.extend([(spread(&low), low), (spread(&high), high)]);
    }
    groups.into_iter().map(|(_, group)| group).collect()
}

fn mean(group: &Group) -> [f64; 3] {
    let count: u64 = group.iter().map(|(_, count)| count).sum();
    std::array::from_fn(|channel| {
        let sum: f64 = group
            .iter()
            .map(|(color, count)| f64::from(color[channel]) * *count as f64)
            .sum();
        sum / count.max(1) as f64
    })
}

/// The channel in which a group is spread most, and its sum of squares there.
fn spread(group: &Group) -> (usize, f64) {
    let mean = mean(group);
    let sum = |channel: usize| {
        let squares = group.iter().map(|(color, count)| {
            let off = f64::from(color[channel]) - mean[channel];
            off * off * *count as f64
        });
        (channel, squares.sum::<f64>())
    };
    (0..3)
        .map(sum)
        .max_by(|one, other| one.1.total_cmp(&other.1))
        .unwrap_or_default()
}
