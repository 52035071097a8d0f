//! Closed forms that a sheet of any surface has to follow, and what it does.

use bevy::math::Vec3;
use bevy_drape::cloth::{ClothGrain, ClothMaterial, ClothStiffening, ClothWeft};
use examples_shared::{modes::hanging_period, sheet::GRAVITY};

use super::play::Play;
use crate::surfaces::Made;

/// A measured value, and the expected one.
pub struct Found {
    pub particles: usize,
    pub value: f64,
    pub expected: f64,
}

/// A quantity with a closed form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Truth {
    /// The frequency (Hz) of a square membrane of cotton, 1 m wide and stretched by 1 %: ½ √(2 N ⁄ ρ a²).
    Membrane,
    /// The frequency (Hz) of a rigid hanging sheet of 2 m in this mode, from 0: j₀ ⁄ 4π √(g ⁄ L).
    Hanging(usize),
    /// The sag (m) of a strip of 2 m between two clamps: ∛(3 α ρ g L⁴ ⁄ 64).
    Taut,
    /// The drop of a clamped strip over its length at this Γ, with that of the elastica.
    Clamped(f64, f64),
    /// The same of a strip of 50 × 13 particles and 0.04 N·m: stiff for its spacing.
    Stiff,
    /// Γ at which a strip that is clamped below falls over.
    Upright,
    /// The sag (m) of a woven sheet that hangs by a side at this angle (degrees) to its warp.
    Woven(f32),
    /// The elongation (m) of a hanging strip that is ten times as stiff beyond half of the strain at its pins.
    Stiffening,
}

impl Truth {
    pub const ALL: [Self; 13] = [
        Self::Membrane,
        Self::Hanging(0),
        Self::Hanging(1),
        Self::Hanging(2),
        Self::Taut,
        Self::Clamped(1.0, 0.1235),
        Self::Clamped(10.0, 0.7002),
        Self::Stiff,
        Self::Upright,
        Self::Woven(0.0),
        Self::Woven(45.0),
        Self::Woven(90.0),
        Self::Stiffening,
    ];

    pub fn name(self) -> String {
        match self {
            Self::Membrane => "membrane, Hz".into(),
            Self::Hanging(mode) => format!("hanging sheet, mode {}, Hz", mode + 1),
            Self::Taut => "taut strip's sag, m".into(),
            Self::Clamped(gamma, _) => format!("clamped strip, gamma {gamma:.0}, of length"),
            Self::Stiff => "clamped strip, stiff and fine, of length".into(),
            Self::Upright => "upright strip falls over at gamma".into(),
            Self::Woven(degrees) => format!("woven sheet at {degrees:.0} degrees, m"),
            Self::Stiffening => "strip that stiffens, m".into(),
        }
    }

    /// Whether a surface has it: a grid cannot be cut at an angle, and one that stiffens is solved as a mesh.
    pub fn is_of(self, made: Made) -> bool {
        made != Made::Grid || !matches!(self, Self::Woven(45.0) | Self::Stiffening)
    }

    /// Whether it takes many seconds of each surface.
    pub fn is_slow(self) -> bool {
        matches!(self, Self::Stiff | Self::Upright)
    }

    /// How the names of woven sheets begin.
    pub const WOVEN: &str = "woven";
    /// How the names of what droops begin.
    pub const DROOP: &str = "clamped";

    pub fn find(self, made: Made, side: u32) -> Found {
        match self {
            Self::Membrane => membrane(made, side),
            Self::Hanging(mode) => hanging(made, mode),
            Self::Taut => taut(made, side),
            Self::Clamped(gamma, drop) => {
                let rigidity = ClothMaterial::COTTON.bend_rigidity;
                clamped(made, [26, 7], rigidity, [gamma, drop])
            }
            Self::Stiff => clamped(made, [50, 13], 0.04, [1.0, 0.1235]),
            Self::Upright => upright(made),
            Self::Woven(degrees) => woven(made, degrees),
            Self::Stiffening => stiffening(made),
        }
    }
}

fn stiffness(compliance: f32) -> f64 {
    1.0 / f64::from(compliance)
}

/// Free of bending, and of damping where it swings.
fn limp(damping: f32) -> ClothMaterial {
    ClothMaterial {
        bend_rigidity: 0.0,
        damping,
        ..ClothMaterial::COTTON
    }
}

fn membrane(made: Made, side: u32) -> Found {
    const STRAIN: f64 = 0.01;
    let material = limp(0.0);
    let (surface, _) = made.surface([side, side], 1.0 / (side - 1) as f32);
    let [stretch, shear] = [material.stretch_compliance, material.shear_compliance].map(stiffness);
    let pull = match made {
        Made::Grid => STRAIN * (stretch + 2.0 * shear),
        _ => STRAIN * 1.5 * stretch,
    };
    let density = f64::from(material.areal_density);
    let expected = 0.5 * (2.0 * pull / density / (1.0 + STRAIN)).sqrt();
    let wave = |at: Vec3| {
        let half = |along: f32| (std::f64::consts::PI * f64::from(along)).sin();
        half(at.x) * half(-at.y)
    };
    let shape: Vec<f64> = surface
        .rest_positions()
        .iter()
        .map(|at| wave(*at))
        .collect();
    let stretched = 1.0 + STRAIN as f32;
    let place = |at: Vec3| {
        Vec3::new(
            at.x * stretched,
            at.y * stretched,
            (1.0e-3 * wave(at)) as f32,
        )
    };
    let is_border = |at: Vec3| (at.x - 0.5).abs().max((at.y + 0.5).abs()) > 0.5 - 1.0e-4;
    let mut play = Play::new(&surface, &material, side, place, is_border);
    Found {
        particles: surface.len(),
        value: 1.0 / play.period(&shape, 1.0 / expected),
        expected,
    }
}

/// Zeros of the Bessel function J₀.
const ROOTS: [f64; 3] = [2.404_825_6, 5.520_078_1, 8.653_727_9];

/// J₀ by its power series, for the small arguments that are needed.
fn bessel(x: f64) -> f64 {
    let mut term = 1.0;
    let mut sum = 1.0;
    for k in 1..40 {
        term *= -(x * x / 4.0) / f64::from(k * k);
        sum += term;
    }
    sum
}

fn hanging(made: Made, mode: usize) -> Found {
    const LENGTH: f64 = 2.0;
    const ROWS: u32 = 65;
    /// Pieces into which its length is cut to place it without stretch.
    const PIECES: usize = 4000;
    let material = ClothMaterial {
        stretch_compliance: 0.0,
        shear_compliance: f32::INFINITY,
        ..limp(0.0)
    };
    let (surface, _) = made.surface([9, ROWS], LENGTH as f32 / (ROWS - 1) as f32);
    let expected = 1.0 / hanging_period(LENGTH, mode);
    let amplitude = 0.01 * LENGTH * (ROOTS[0] / ROOTS[mode]).powi(2);
    let shape_at = |y: f64| bessel(ROOTS[mode] * (1.0 + y / LENGTH).max(0.0).sqrt());
    let piece = LENGTH / PIECES as f64;
    let mut heights = vec![0.0];
    for at in 0..PIECES {
        let ends = [at, at + 1].map(|at| shape_at(-piece * at as f64));
        let across = amplitude * (ends[1] - ends[0]);
        heights.push(heights[at] - (piece * piece - across * across).sqrt());
    }
    let place = |at: Vec3| {
        let along = (f64::from(-at.y) / piece).clamp(0.0, PIECES as f64);
        let first = (along as usize).min(PIECES - 1);
        let height =
            heights[first] + (heights[first + 1] - heights[first]) * (along - first as f64);
        let z = amplitude * shape_at(at.y.into());
        Vec3::new(at.x, height as f32, z as f32)
    };
    let rest = surface.rest_positions().iter();
    let shape: Vec<f64> = rest.map(|at| shape_at(at.y.into())).collect();
    let mut play = Play::new(&surface, &material, ROWS, place, |at| at.y > -1.0e-4);
    Found {
        particles: surface.len(),
        value: 1.0 / play.period(&shape, 1.0 / expected),
        expected,
    }
}

/// Lying: what was down is towards the eye.
fn lying(at: Vec3) -> Vec3 {
    Vec3::new(at.x, 0.0, -at.y)
}

fn taut(made: Made, columns: u32) -> Found {
    const LENGTH: f64 = 2.0;
    let material = ClothMaterial {
        shear_compliance: f32::INFINITY,
        ..limp(0.05)
    };
    let spacing = LENGTH as f32 / (columns - 1) as f32;
    let (surface, _) = made.surface([columns, 5], spacing);
    let weight = f64::from(material.stretch_compliance * material.areal_density) * GRAVITY;
    let expected = (3.0 * weight * LENGTH.powi(4) / 64.0).cbrt();
    let is_end = |at: Vec3| (at.x - 1.0).abs() > 1.0 - 1.0e-4;
    let mut play = Play::new(&surface, &material, columns, lying, is_end);
    play.settle(768);
    Found {
        particles: surface.len(),
        value: -play.height(|at| (at.x - 1.0).abs() < 0.6 * spacing),
        expected,
    }
}

/// Rigid but for bending, of this rigidity (N·m).
fn bent(bend_rigidity: f32, damping: f32) -> ClothMaterial {
    ClothMaterial {
        stretch_compliance: 0.0,
        shear_compliance: f32::INFINITY,
        bend_rigidity,
        damping,
        ..ClothMaterial::COTTON
    }
}

/// Length (m) of a strip with this Γ, and its spacing (m) with so many columns: clamped halfway between the two that are held.
fn length_of(gamma: f64, material: &ClothMaterial, columns: u32) -> [f64; 2] {
    let weight = f64::from(material.areal_density) * GRAVITY;
    let length = (gamma * f64::from(material.bend_rigidity) / weight).cbrt();
    [length, length / (f64::from(columns) - 1.5)]
}

fn clamped(
    made: Made,
    [columns, rows]: [u32; 2],
    rigidity: f32,
    [gamma, expected]: [f64; 2],
) -> Found {
    let material = bent(rigidity, 0.1);
    let [length, spacing] = length_of(gamma, &material, columns);
    let spacing = spacing as f32;
    let (surface, _) = made.surface([columns, rows], spacing);
    let is_held = |at: Vec3| at.x < 1.4 * spacing;
    let mut play = Play::new(&surface, &material, columns, lying, is_held);
    play.settle(320);
    let end = (columns as f32 - 1.01) * spacing;
    Found {
        particles: surface.len(),
        value: -play.height(|at| at.x > end) / length,
        expected,
    }
}

/// Its end, aside by a hundredth of its length, goes on aside or swings back. The bracket of Γ is halved to 1 %.
fn upright(made: Made) -> Found {
    const COLUMNS: u32 = 26;
    const TICKS: u32 = 192;
    let material = bent(ClothMaterial::COTTON.bend_rigidity, 0.02);
    let mut particles = 0;
    let mut falls = |gamma: f64| {
        let [length, spacing] = length_of(gamma, &material, COLUMNS).map(|length| length as f32);
        let (surface, _) = made.surface([COLUMNS, 7], spacing);
        particles = surface.len();
        // The two columns that are held are upright.
        let aside = |x: f32| 0.01 * (x - spacing).max(0.0).powi(2) / length;
        let place = |at: Vec3| Vec3::new(at.y, at.x, aside(at.x));
        let is_held = |at: Vec3| at.x < 1.4 * spacing;
        let mut play = Play::new(&surface, &material, COLUMNS, place, is_held);
        play.settle(TICKS);
        let end = (COLUMNS as f32 - 1.01) * spacing;
        let aside = play.rest.iter().zip(play.particles.positions());
        let aside = aside.filter(|(rest, _)| rest.x > end);
        aside.map(|(_, place)| place.z.abs()).fold(0.0, f32::max) > 0.015 * length
    };
    let (mut stands, mut fallen) = (2.0, 14.0);
    if falls(stands) || !falls(fallen) {
        return Found {
            particles,
            value: f64::NAN,
            expected: 7.837,
        };
    }
    while fallen / stands > 1.01 {
        let middle = f64::sqrt(stands * fallen);
        *(if falls(middle) {
            &mut fallen
        } else {
            &mut stands
        }) = middle;
    }
    Found {
        particles,
        value: f64::sqrt(stands * fallen),
        expected: 7.837,
    }
}

/// Hung by its top row, the warp at an angle from what is down; α ρ g L²/2 with the compliance in that direction. A grid of which
/// the weft carries hangs by its first column.
fn woven(made: Made, degrees: f32) -> Found {
    const SIDE: u32 = 17;
    const SPACING: f32 = 0.05;
    const COMPLIANCES: [f64; 2] = [2.0e-3, 8.0e-3];
    let [warp, weft] = COMPLIANCES;
    let length = f64::from(SIDE - 1) * f64::from(SPACING);
    let material = ClothMaterial {
        stretch_compliance: warp as f32,
        shear_compliance: f32::INFINITY,
        weft: Some(ClothWeft {
            stretch_compliance: weft as f32,
            bend_rigidity: 0.0,
        }),
        ..limp(0.05)
    };
    let (surface, mesh) = made.surface([SIDE, SIDE], SPACING);
    let grain = ClothGrain::along(Vec3::NEG_Y).turned(degrees.to_radians());
    let surface = grain.apply(surface, &mesh).expect("a grain");
    // A grid's columns are its warp, so it is turned itself.
    let is_turned = made == Made::Grid && degrees > 45.0;
    let upright = |at: Vec3| {
        if is_turned {
            Vec3::new(at.y, -at.x, 0.0)
        } else {
            at
        }
    };
    let is_top = |at: Vec3| upright(at).y > -1.0e-4;
    let mut play = Play::new(&surface, &material, SIDE, upright, is_top);
    play.settle(384);
    let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
    let t = (weft / warp).powf(0.25);
    let soft = cosine * cosine / t + t * sine * sine;
    let compliance = (warp * weft).sqrt() * soft * soft;
    let end = f64::from(SPACING) * (f64::from(SIDE) - 1.01);
    let height = play.height(|at| f64::from(-upright(at).y) > end);
    Found {
        particles: surface.len(),
        value: -height - length,
        expected: compliance * f64::from(material.areal_density) * GRAVITY * length * length / 2.0,
    }
}

/// At a height z over the lower end, the strain e₀ = α ρ g z of a strip without a knee is that beyond it, s + (e₀ − s) ⁄ 10, from
/// half of the length up, where e₀ is s. The integral is α ρ g L²/2 × (1 − 9/10 × 1/4).
fn stiffening(made: Made) -> Found {
    const ROWS: u32 = 33;
    const SPACING: f32 = 0.05;
    const FACTOR: f64 = 10.0;
    let length = f64::from(ROWS - 1) * f64::from(SPACING);
    let material = ClothMaterial {
        stretch_compliance: 2.0e-2,
        shear_compliance: f32::INFINITY,
        ..limp(0.05)
    };
    let weight = f64::from(material.areal_density) * GRAVITY;
    let at_pins = f64::from(material.stretch_compliance) * weight * length;
    let material = ClothMaterial {
        stiffening: Some(ClothStiffening {
            strain: (at_pins / 2.0) as f32,
            factor: FACTOR as f32,
        }),
        ..material
    };
    let (surface, _) = made.surface([9, ROWS], SPACING);
    let mut play = Play::new(&surface, &material, ROWS, |at| at, |at| at.y > -1.0e-4);
    play.settle(384);
    let end = f64::from(SPACING) * (f64::from(ROWS) - 1.01);
    Found {
        particles: surface.len(),
        value: -play.height(|at| f64::from(-at.y) > end) - length,
        expected: at_pins * length / 2.0 * (1.0 - (1.0 - 1.0 / FACTOR) / 4.0),
    }
}
