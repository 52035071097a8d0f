//! The springs between the particles, sorted by colour.

mod list;
mod stiffness;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use thiserror::Error;

use super::{
    grid::ClothGrid,
    lanes::Layout,
    material::ClothMaterial,
    spring::{Spring, SpringKind},
    surface::{Link, Surface},
};
pub(crate) use list::SpringList;
pub(crate) use stiffness::StiffnessFactors;

/// A cloth's springs, sorted by colour. No two springs of one colour share a particle, so that they can be solved in
/// parallel and in any order.
///
/// The order of the sweep also makes the solver stable: colour by colour is stable at every size, row by row diverges.
#[derive(Reflect, Debug, Default, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(opaque)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct Springs(SpringStorage);

/// Storage of springs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum SpringStorage {
    /// Springs along the rows, columns and diagonals of a grid, with no memory for each spring.
    Grid(ClothGrid, Compliances),
    /// Springs between arbitrary particles.
    List(Arc<SpringList>),
}

impl Default for SpringStorage {
    fn default() -> Self {
        Self::List(Arc::default())
    }
}

/// Compliance of a square patch for each kind of spring (m/N); infinite for none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Compliances {
    /// Along rows and along columns.
    pub structural: [f32; 2],
    pub shear: f32,
}

impl Compliances {
    /// Compliance of the spring from (row, column) with this step: that of its strip, compliance × length ⁄ width. A
    /// strip on a border is half as wide. `None` if there are no such springs.
    pub fn of_strip(
        &self,
        grid: &ClothGrid,
        (down, across): (u32, i32),
        (row, column): (u32, u32),
    ) -> Option<f32> {
        let on_border = |index: u32, count: u32| index == 0 || index + 1 == count;
        let ([along_rows, along_columns], spacing) = (self.structural, grid.spacing());
        let length = grid.step_length((down, across));
        let (compliance, width, narrowed) = match (down, across) {
            (0, _) => (along_rows, spacing.y, on_border(row, grid.rows())),
            (_, 0) => (along_columns, spacing.x, on_border(column, grid.columns())),
            _ => (self.shear, length, false),
        };
        let narrowed = if narrowed { 2.0 } else { 1.0 };
        let of_strip = compliance * length / width * narrowed;
        compliance.is_finite().then_some(of_strip)
    }
}

/// The springs of a grid, colour by colour: rows down and columns across from one end to the other, and the parity.
/// Both diagonals of a pair of rows come before those of the next pair.
const GRID_COLOURS: [((u32, i32), u32); 8] = [
    ((0, 1), 0),
    ((0, 1), 1),
    ((1, 0), 0),
    ((1, 0), 1),
    ((1, 1), 0),
    ((1, -1), 0),
    ((1, 1), 1),
    ((1, -1), 1),
];

/// The reason why a list of springs is refused.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[type_path = "bevy_drape"]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum SpringError {
    /// A spring does not join two different particles, or its rest length or compliance is out of range.
    #[error(
        "spring {index}, {spring:?}, must join two of the {particles} particles, with a rest length from 10⁻⁹ to 10¹² m and a finite compliance of zero or more"
    )]
    Invalid {
        /// Its index in the list.
        index: usize,
        /// The spring.
        spring: Spring,
        /// Number of particles.
        particles: usize,
    },
}

impl Springs {
    /// Structural and shear springs of `grid`. A strip's compliance follows from its length and width
    /// ([`ClothMaterial`]); a strip on a border is half as wide. Kinds whose compliance is infinite are left out. They do not
    /// stiffen: the plugin solves a grid that does as a mesh.
    pub fn of_grid(grid: &ClothGrid, material: &ClothMaterial) -> Self {
        let compliances = Compliances {
            structural: material.stretch_compliances(),
            shear: material.shear_compliance,
        };
        Self(SpringStorage::Grid(*grid, compliances))
    }

    /// Springs between any of `particles` particles. Each takes the first colour that is free at both of its ends. With
    /// at most 31 springs at each particle, there are fewer than twice as many colours as springs at one particle.
    /// Beyond 63 springs at a particle, each further spring gets its own colour.
    ///
    /// # Errors
    /// [`SpringError::Invalid`] for the first that does not join two different particles, or whose rest length or
    /// compliance is out of range.
    pub fn of_list(springs: &[Spring], particles: usize) -> Result<Self, SpringError> {
        for (index, spring) in springs.iter().enumerate() {
            let [a, b] = spring.ends.map(|end| end as usize);
            let is_valid = a.max(b) < particles
                && a != b
                && (1.0e-9..1.0e12).contains(&spring.rest_length)
                && spring.compliance >= 0.0
                && spring.compliance.is_finite();
            if !is_valid {
                return Err(SpringError::Invalid {
                    index,
                    spring: *spring,
                    particles,
                });
            }
        }
        let mut list = SpringList::default();
        list.add(springs, particles);
        Ok(Self(SpringStorage::List(Arc::new(list))))
    }

    /// The springs of a surface. For a surface made from a grid, [those of the grid](Self::of_grid).
    ///
    /// Those of a mesh run along its edges, with the stretch compliance. Edges run in all directions, so they resist
    /// shear as well. If the material's shear compliance is below its stretch compliance, springs across each edge,
    /// between the two opposite corners, add the difference. A mesh without a [grain](crate::cloth::ClothGrain) takes the
    /// geometric mean of what warp and weft have.
    pub fn of_surface(surface: &Surface, material: &ClothMaterial) -> Self {
        Self::with_factors(surface, material, &StiffnessFactors::default())
    }

    /// The same of a mesh whose stiffness differs from place to place. A grid takes no factors.
    pub(crate) fn with_factors(
        surface: &Surface,
        material: &ClothMaterial,
        factors: &StiffnessFactors,
    ) -> Self {
        if let Some(grid) = surface.as_grid() {
            return Self::of_grid(grid, material);
        }
        let compliance = compliances(surface, material);
        let woven_links = match surface.rest_grid() {
            Some(_) => None,
            None => surface.woven_links(material.woven_stretch().ratio),
        };
        let all_links = woven_links.as_deref().unwrap_or(surface.links());
        let mut list = SpringList {
            stiffening: material.stiffening,
            ..SpringList::default()
        };
        list.grid = match (surface.rest_grid(), material.stiffening) {
            // The rows of a grid have no knee.
            (Some(grid), None) if grid.columns() > 1 && grid.rows() > 1 => Some(*grid),
            _ => None,
        };
        // Springs along edges come last: the stiffest springs are solved last.
        let [_, places] = [false, true].map(|is_along| {
            let links = all_links.iter();
            let springs: Vec<Spring> = links
                .filter(|link| (link.kind == SpringKind::Structural) == is_along)
                .map(|link| Spring {
                    kind: link.kind,
                    ends: link.ends,
                    rest_length: link.rest_length,
                    compliance: compliance(link) * link.slenderness * factors.of_spring(link.ends),
                })
                .filter(|spring| spring.compliance.is_finite())
                .collect();
            list.add(&springs, surface.len())
        });
        let is_edge = |link: &&Link| link.kind == SpringKind::Structural;
        // Without stretch springs there are no chains.
        if places.len() == all_links.iter().filter(is_edge).count() {
            let chains = match &list.grid {
                Some(grid) => surface.chains_beyond(grid.len() as u32),
                None => surface.chains().clone(),
            };
            list.chains = chains.renamed(|edge| places[edge as usize]);
        }
        Self(SpringStorage::List(Arc::new(list)))
    }

    /// Calls `visit` with each spring and the index of its colour, in the order of the sweep.
    pub fn for_each(&self, mut visit: impl FnMut(usize, Spring)) {
        match &self.0 {
            SpringStorage::Grid(grid, compliances) => {
                let strip = Layout::new(grid.columns(), grid.rows()).strip;
                for (colour, (step, part)) in GRID_COLOURS.into_iter().enumerate() {
                    for cell in grid.cells() {
                        let there = part_of(step, cell, strip) == part;
                        if let Some(spring) = grid_spring(grid, compliances, step, cell)
                            && there
                        {
                            visit(colour, spring);
                        }
                    }
                }
            }
            SpringStorage::List(list) => {
                for (colour, range) in list.colours.iter().enumerate() {
                    for spring in &list.springs[range.clone()] {
                        visit(colour, *spring);
                    }
                }
            }
        }
    }

    /// All springs, in the order of the sweep.
    pub fn to_vec(&self) -> Vec<Spring> {
        let mut springs = Vec::with_capacity(self.len());
        self.for_each(|_, spring| springs.push(spring));
        springs
    }

    /// Number of springs.
    pub fn len(&self) -> usize {
        match &self.0 {
            SpringStorage::Grid(grid, compliances) => {
                let (columns, rows) = (grid.columns() as usize, grid.rows() as usize);
                let (wide, high) = (columns.saturating_sub(1), rows.saturating_sub(1));
                let along = [wide * rows, columns * high];
                let there = |compliance: f32, count: usize| {
                    if compliance.is_finite() { count } else { 0 }
                };
                let [across, down] = [0, 1].map(|at| there(compliances.structural[at], along[at]));
                across + down + there(compliances.shear, 2 * wide * high)
            }
            SpringStorage::List(list) => list.springs.len(),
        }
    }

    /// Whether there are no springs, as before the first tick.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether there are springs of `kind`.
    pub fn has(&self, kind: SpringKind) -> bool {
        match &self.0 {
            SpringStorage::Grid(_, compliances) => match kind {
                SpringKind::Structural => compliances.structural.iter().any(|of| of.is_finite()),
                SpringKind::Shear => compliances.shear.is_finite(),
                SpringKind::Bend => false,
            },
            SpringStorage::List(list) => list.springs.iter().any(|spring| spring.kind == kind),
        }
    }

    /// Whether they are solved as rows, columns and diagonals: those of a grid, torn or mapped or not, without a knee.
    pub(crate) fn are_of_grid(&self) -> bool {
        match &self.0 {
            SpringStorage::Grid(..) => true,
            SpringStorage::List(list) => list.grid.is_some(),
        }
    }

    /// The storage, for the solver.
    pub(crate) fn storage(&self) -> &SpringStorage {
        &self.0
    }
}

/// The compliance of a square patch in the direction of each spring (m/N).
fn compliances(surface: &Surface, material: &ClothMaterial) -> impl Fn(&Link) -> f32 {
    let woven = material.woven_stretch();
    let stiffness = |compliance: f32| 1.0 / compliance;
    let added = stiffness(material.shear_compliance) - stiffness(woven.mean);
    let ([along_rows, along_columns], across) = match surface.rest_grid() {
        // The springs of a torn grid are those of the grid.
        Some(_) => (material.stretch_compliances(), material.shear_compliance),
        // Rigid stretch leaves nothing to add, not even to rigid shear.
        None if woven.mean > 0.0 => ([woven.mean; 2], stiffness(added.max(0.0))),
        None => ([woven.mean; 2], f32::INFINITY),
    };
    move |link| match link.kind {
        SpringKind::Structural => {
            let [a, b] = link.ends.map(|end| surface.origin_of(end));
            let is_in_row = a.abs_diff(b) == 1;
            if is_in_row { along_rows } else { along_columns }
        }
        SpringKind::Shear | SpringKind::Bend => across,
    }
}

/// The colour, among those of its step, of a grid's spring from `cell`.
fn part_of((down, across): (u32, i32), (row, column): (u32, u32), strip: u32) -> u32 {
    if let Some(group) = row.checked_div(down) {
        return group % 2;
    }
    column % strip / across.unsigned_abs() % 2
}

fn grid_spring(
    grid: &ClothGrid,
    compliances: &Compliances,
    step: (u32, i32),
    cell: (u32, u32),
) -> Option<Spring> {
    let (down, across) = step;
    let (row, column) = (cell.0 + down, cell.1.checked_add_signed(across)?);
    if row >= grid.rows() || column >= grid.columns() {
        return None;
    }
    Some(Spring {
        kind: match (down, across) {
            (0, 1) | (1, 0) => SpringKind::Structural,
            _ => SpringKind::Shear,
        },
        ends: [grid.index(cell.0, cell.1), grid.index(row, column)],
        rest_length: grid.step_length(step),
        compliance: compliances.of_strip(grid, step, cell)?,
    })
}
