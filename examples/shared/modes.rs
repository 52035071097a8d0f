//! How sheets swing and ring, measured, and in closed form.

use bevy::math::Vec3;
use bevy_drape::{
    cloth::{ClothMaterial, ClothParticles},
    solver::{Control, Substepping, TickStep},
};

use super::sheet::{GRAVITY, Sheet};

/// Zeros of the Bessel function J₀, one a mode.
pub const ROOTS: [f64; 3] = [2.404_825_557_7, 5.520_078_110_3, 8.653_727_912_9];

/// Columns of a hanging sheet: each hangs by itself.
const COLUMNS: u32 = 8;

/// Periods that a measurement takes the mean of, and how long it waits for them, in true ones.
const PERIODS: usize = 5;
const PATIENCE: f64 = 4.0;

/// How far a sheet is stretched on its frame.
const PRE_STRETCH: f64 = 0.01;

/// The Bessel function J₀, by its power series: exact to 10⁻¹² up to 10.
fn j0(x: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..60 {
        term *= -(x * x / 4.0) / f64::from(k * k);
        sum += term;
    }
    sum
}

/// Period (s) of a mode, from 0, of a sheet that hangs `length` m down: ω = (j ⁄ 2) √(g ⁄ L), its shape J₀(j √(s ⁄ L)) at
/// s m from the free end (Bernoulli's hanging chain).
pub fn hanging_period(length: f64, mode: usize) -> f64 {
    std::f64::consts::TAU / (ROOTS[mode] / 2.0 * (GRAVITY / length).sqrt())
}

/// How far each row is from the vertical in a mode, 1 at the free end.
pub fn hanging_shape(rows: u32, mode: usize) -> Vec<f64> {
    let from_end = |row: u32| 1.0 - f64::from(row) / f64::from(rows - 1);
    let each = (0..rows).map(|row| j0(ROOTS[mode] * from_end(row).sqrt()));
    each.collect()
}

/// Heights and offsets (m) of rows that hang one below the other, these `lengths` (m) apart, from 0 on.
pub fn hanging_places(lengths: &[f64], shape: &[f64], amplitude: f64) -> Vec<[f64; 2]> {
    let mut places = vec![[0.0, 0.0]];
    for (length, part) in lengths.iter().zip(&shape[1..]) {
        let [y, z] = places[places.len() - 1];
        let next = amplitude * part;
        places.push([y - (length * length - (next - z).powi(2)).sqrt(), next]);
    }
    places
}

/// How much longer each row of springs of a hanging sheet is for what hangs below it, and how much narrower, as parts. As a lattice
/// of C₁₁ = k₁ + k₂ and C₁₂ = k₂ gives that is pulled one way: by N ⁄ (C₁₁ − C₁₂² ⁄ C₁₁), and C₁₂ ⁄ C₁₁ of that across.
fn hanging_strains(rows: u32, spacing: f64, material: &ClothMaterial) -> Vec<[f64; 2]> {
    let [k1, k2] = [material.stretch_compliance, material.shear_compliance].map(f64::from);
    let [k1, k2] = [1.0 / k1, 1.0 / k2];
    let (stiffness, across) = if k1.is_finite() && k2.is_finite() {
        (k1 + k2 - k2 * k2 / (k1 + k2), k2 / (k1 + k2))
    } else {
        (k1.max(k2), 0.0)
    };
    let weight = f64::from(material.areal_density) * GRAVITY * spacing;
    // The last row is half a row.
    let below = |row: u32| f64::from(rows - 1 - row) - 0.5;
    let strain = |row: u32| weight * below(row) / stiffness;
    let each = (0..rows - 1).map(|row| [strain(row), across * strain(row)]);
    each.collect()
}

/// The same as it is found by the solver: infinite where it does not swing. Of a sheet of 8 columns that is let go in the
/// mode's shape, sloped by 1.5 % at most, and as long and wide as its weight makes it: let go at rest, cotton would bounce, and
/// its folds are chaos that hides the third mode. Lengthened by its own weight it is longer by 1 part in 10,000 (cotton, 2 m).
pub fn hanging_found(
    rows: u32,
    length: f64,
    mode: usize,
    material: &ClothMaterial,
    step: TickStep,
    tethers: bool,
) -> f64 {
    let spacing = length / f64::from(rows - 1);
    let shape = hanging_shape(rows, mode);
    let amplitude = 0.01 * length * (ROOTS[0] / ROOTS[mode]).powi(2);
    let strains = hanging_strains(rows, spacing, material);
    let lengths: Vec<f64> = strains
        .iter()
        .map(|[long, _]| spacing * (1.0 + long))
        .collect();
    let places = hanging_places(&lengths, &shape, amplitude);
    let place = |row: u32, column: u32| {
        let [y, z] = places[row as usize];
        // A row of particles is between two of springs.
        let narrow = |row: Option<u32>| {
            row.and_then(|row| strains.get(row as usize))
                .map(|of| of[1])
        };
        let [above, below] = [narrow(row.checked_sub(1)), narrow(Some(row))];
        let narrow = 0.5 * (above.or(below).unwrap_or(0.0) + below.or(above).unwrap_or(0.0));
        let aside = f64::from(column) - 0.5 * f64::from(COLUMNS - 1);
        Vec3::new(
            (spacing * (1.0 - narrow) * aside) as f32,
            y as f32,
            z as f32,
        )
    };
    let size = (COLUMNS, rows);
    let pinned = |row, _| row == 0;
    let sheet = Sheet::new(size, spacing as f32, *material, step, place, pinned);
    let weights: Vec<f64> = sheet
        .grid()
        .cells()
        .map(|(row, _)| shape[row as usize])
        .collect();
    period(
        sheet.tethered(tethers),
        &weights,
        hanging_period(length, mode),
        None,
    )
}

/// Period (s) of the first mode of a square sheet of 1 m that is stretched by 1 % on its frame: f = ½ √(N ⁄ ρ) √2 ⁄ a.
///
/// Springs of stiffness k₁ along threads and k₂ along diagonals make a lattice of C₁₁ = k₁ + k₂ and C₁₂ = k₂, so that it is
/// pulled by N = (k₁ + 2 k₂) ε; by how much wider it is than at rest, ρ and the pull go down and a goes up: 1 ⁄ (1 + ε) in all.
pub fn membrane_period(material: &ClothMaterial) -> f64 {
    let stiffness = |compliance: f32| 1.0 / f64::from(compliance);
    let pull = PRE_STRETCH
        * (stiffness(material.stretch_compliance) + 2.0 * stiffness(material.shear_compliance));
    let square = pull / f64::from(material.areal_density) / (1.0 + PRE_STRETCH);
    1.0 / (0.5 * (2.0 * square).sqrt())
}

/// The same as it is found by the solver, with `side`² particles. It is let go in the mode's shape, 1 mm high. Sub-steps are those
/// of `step`, or with a `control` as many as it finds to be needed.
pub fn membrane_found(
    side: u32,
    material: &ClothMaterial,
    step: TickStep,
    tethers: bool,
    control: Option<Control>,
) -> f64 {
    let spacing = 1.0 / f64::from(side - 1);
    let wave = |index: u32| (std::f64::consts::PI * f64::from(index) * spacing).sin();
    let place = |row: u32, column: u32| {
        let wide = (1.0 + PRE_STRETCH) * spacing;
        let at = [column, row].map(|index| (wide * f64::from(index)) as f32);
        Vec3::new(at[0], -at[1], (1.0e-3 * wave(row) * wave(column)) as f32)
    };
    let on_frame = |index| index == 0 || index == side - 1;
    let pinned = |row, column| on_frame(row) || on_frame(column);
    let size = (side, side);
    let sheet = Sheet::new(size, spacing as f32, *material, step, place, pinned);
    let cells = sheet.grid().cells();
    let weights: Vec<f64> = cells
        .map(|(row, column)| wave(row) * wave(column))
        .collect();
    let truth = membrane_period(material);
    period(sheet.tethered(tethers), &weights, truth, control)
}

/// Mean of several periods (s) of the part of the motion along z that has a shape, from where it passes zero between two
/// sub-steps. Infinite if it does not within four times as long as it should take.
fn period(mut sheet: Sheet, shape: &[f64], truth: f64, mut control: Option<Control>) -> f64 {
    let needed = Substepping::needed(sheet.grid().columns() as usize, sheet.step.seconds);
    let weights: Vec<f64> = sheet
        .masses()
        .iter()
        .zip(shape)
        .map(|(mass, shape)| mass * shape)
        .collect();
    let part = |particles: &ClothParticles| -> f64 {
        let each = particles.positions().zip(&weights);
        each.map(|(at, weight)| f64::from(at.z) * weight).sum()
    };
    let mut before = part(&sheet.particles);
    let mut crossings = Vec::new();
    let tick = f64::from(sheet.step.seconds);
    let mut start = 0.0;
    while start < PATIENCE * PERIODS as f64 * truth && crossings.len() <= 2 * PERIODS {
        if let Some(control) = &mut control {
            sheet.step.substeps = control.substeps(Substepping::Automatic, needed);
        }
        let stretch = sheet.tick(|particles, substep| {
            let now = part(particles);
            if before.signum() != now.signum() {
                let passed = before / (before - now);
                let substeps = f64::from(substep.index) + passed;
                crossings.push(start + tick * substeps / f64::from(substep.count));
            }
            before = now;
        });
        if let Some(control) = &mut control {
            control.observe(Substepping::Automatic, stretch);
        }
        start += tick;
    }
    match (crossings.first(), crossings.last()) {
        (Some(first), Some(last)) if crossings.len() > 2 => {
            2.0 * (last - first) / (crossings.len() - 1) as f64
        }
        _ => f64::INFINITY,
    }
}

/// How far a strip of threads as long as the distance between what holds its ends sags in its middle (m): a flat arc of sag f
/// is longer by 8 f² ⁄ 3 L and pulled by ρ g L² ⁄ 8 f, so f = ∛(3 c ρ g L⁴ ⁄ 64), 48 mm for cotton over 2 m.
pub fn taut_sag(length: f64, material: &ClothMaterial) -> f64 {
    let weight = f64::from(material.areal_density) * GRAVITY;
    let given = f64::from(material.stretch_compliance) * weight;
    (3.0 * given * length.powi(4) / 64.0).cbrt()
}

/// The same as it is found by the solver after 12 s, with `columns` particles along it. It has no diagonals, so that its rows hang
/// by themselves.
pub fn taut_found(
    columns: u32,
    length: f64,
    material: &ClothMaterial,
    step: TickStep,
    tethers: bool,
) -> f64 {
    let spacing = (length / f64::from(columns - 1)) as f32;
    let material = ClothMaterial {
        shear_compliance: f32::INFINITY,
        damping: 0.05,
        ..*material
    };
    let place = |row: u32, column: u32| spacing * Vec3::new(column as f32, 0.0, row as f32);
    let pinned = |_, column| column == 0 || column == columns - 1;
    let sheet = Sheet::new((columns, 2), spacing, material, step, place, pinned);
    let mut sheet = sheet.tethered(tethers);
    for _ in 0..(12.0 / sheet.step.seconds) as u32 {
        sheet.tick(|_, _| {});
    }
    let middle = sheet.particles.position((0, columns / 2));
    -f64::from(middle.expect("it exists").y)
}
