//! Woven fabric, made by code: a picture of its yarns' colours, and one of their normals.

use bevy::{
    asset::RenderAssetUsages,
    image::{ImageAddressMode, ImageFilterMode, ImageSampler, ImageSamplerDescriptor},
    math::Affine2,
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};
use bevy_drape::prelude::*;

/// Pairs of yarns along either side of a picture, yarns in all, and texels across each.
const PAIRS: u32 = 64;
const YARNS: u32 = 2 * PAIRS;
const TEXELS: u32 = 4;
/// How much darker or lighter than asked a yarn may be: no two are alike.
const UNEVEN: f32 = 0.09;
/// Which part of the light goes through.
const TRANSLUCENCY: f32 = 0.22;

/// Where a yarn that runs down lies above one that runs across.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Weave {
    /// At every second crossing: muslin, canvas, gingham.
    Plain,
    /// At three crossings of four, one further with each row, so that ribs run aslant: denim.
    Twill,
    /// At one crossing of four: what runs across shows.
    WeftTwill,
    /// At two of four, the ribs turning back every eighth yarn: tweed.
    Herringbone,
}

impl Weave {
    fn down_is_above(self, column: u32, row: u32) -> bool {
        match self {
            Self::Plain => (column + row).is_multiple_of(2),
            Self::Twill => !(column + row).is_multiple_of(4),
            Self::WeftTwill => (column + row).is_multiple_of(4),
            Self::Herringbone => {
                let there = column % 16;
                (there.min(15 - there) + row) % 4 < 2
            }
        }
    }
}

/// Cloth with the same 64 × 64 pairs of yarns `times` over along either side. `color` says the colour of each pair: the first
/// argument is whether it runs down the cloth, the second its number.
///
/// The normals show on meshes that have tangents.
pub fn woven(
    weave: Weave,
    images: &mut Assets<Image>,
    times: u32,
    color: impl Fn(bool, u32) -> Color,
) -> StandardMaterial {
    let yarn = |runs_down: bool, number: u32| {
        let lightness = 1.0 + UNEVEN * (2.0 * noise(2 * number + u32::from(runs_down)) - 1.0);
        color(runs_down, number / 2)
            .to_linear()
            .to_vec4()
            .truncate()
            * lightness
    };
    let [down, across] =
        [true, false].map(|way| (0..YARNS).map(|n| yarn(way, n)).collect::<Vec<_>>());
    let side = YARNS * TEXELS;
    let (mut colors, mut normals) = (Vec::new(), Vec::new());
    for y in 0..side {
        for x in 0..side {
            let (column, row) = (x / TEXELS, y / TEXELS);
            // From the middle of the crossing, −1 to 1.
            let middle = |at: u32| (2 * (at % TEXELS) + 1) as f32 / TEXELS as f32 - 1.0;
            let place = Vec2::new(middle(x), middle(y));
            let down_is_above = weave.down_is_above(column, row);
            let (color, beside, along) = if down_is_above {
                (down[column as usize], place.x, place.y)
            } else {
                (across[row as usize], place.y, place.x)
            };
            // A yarn is round across, and dives under the next at either end.
            let shade = 1.0 - 0.45 * beside * beside - 0.25 * along * along;
            colors.push((color * shade).extend(1.0));
            let (across, along) = (0.75 * beside, 0.4 * along);
            let slope = if down_is_above {
                Vec2::new(across, along)
            } else {
                Vec2::new(along, across)
            };
            // Texels run down the picture, and the second direction of a normal map up.
            let normal = Vec3::new(slope.x, -slope.y, 1.0).normalize();
            normals.push((0.5 * normal + 0.5).extend(1.0));
        }
    }
    let encode = |linear: Vec4| {
        let color = Srgba::from(LinearRgba::from_vec4(linear));
        color.to_vec4()
    };
    StandardMaterial {
        base_color_texture: Some(images.add(image(
            side,
            colors,
            TextureFormat::Rgba8UnormSrgb,
            encode,
        ))),
        normal_map_texture: Some(images.add(image(
            side,
            normals,
            TextureFormat::Rgba8Unorm,
            |normal| normal,
        ))),
        uv_transform: Affine2::from_scale(Vec2::splat(times as f32)),
        diffuse_transmission: TRANSLUCENCY,
        ..fabric(Color::WHITE)
    }
}

/// From 0 to 1, the same for the same number.
fn noise(number: u32) -> f32 {
    let mixed = (number ^ 0x9e37).wrapping_mul(0x85eb_ca6b);
    let mixed = (mixed ^ (mixed >> 13)).wrapping_mul(0xc2b2_ae35);
    (mixed >> 8) as f32 / (1 << 24) as f32
}

/// A square image with all its mip levels: without them fine yarns flicker.
fn image(
    side: u32,
    mut texels: Vec<Vec4>,
    format: TextureFormat,
    encode: impl Fn(Vec4) -> Vec4,
) -> Image {
    let mut data = Vec::new();
    let mut width = side as usize;
    loop {
        let bytes = texels.iter().flat_map(|texel| {
            let texel = (255.0 * encode(*texel)).round();
            texel.to_array().map(|value| value as u8)
        });
        data.extend(bytes);
        if width == 1 {
            break;
        }
        width /= 2;
        let at = |x: usize, y: usize| texels[2 * width * y + x];
        texels = (0..width * width)
            .map(|place| (2 * (place % width), 2 * (place / width)))
            .map(|(x, y)| 0.25 * (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1)))
            .collect();
    }
    let size = Extent3d {
        width: side,
        height: side,
        depth_or_array_layers: 1,
    };
    let mut image = Image::new_uninit(
        size,
        TextureDimension::D2,
        format,
        RenderAssetUsages::RENDER_WORLD,
    );
    image.texture_descriptor.mip_level_count = side.ilog2() + 1;
    image.data = Some(data);
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: ImageAddressMode::Repeat,
        address_mode_v: ImageAddressMode::Repeat,
        mag_filter: ImageFilterMode::Linear,
        min_filter: ImageFilterMode::Linear,
        mipmap_filter: ImageFilterMode::Linear,
        // More of it leaves dots of other places' colours on Mesa's software driver.
        anisotropy_clamp: 1,
        ..default()
    });
    image
}
