//! The springs between the particles, sorted by colour.

mod spring;
#[cfg(test)]
mod tests;

use std::{ops::Range, sync::Arc};

use bevy::reflect::{Reflect, std_traits::ReflectDefault};

use super::{ClothError, ClothGrid, ClothMaterial, Layout, Link, Surface, Threads};

pub use spring::{Spring, SpringKind};

/// A cloth's springs, sorted by colour: no two springs of one colour share a particle, so that their order makes
/// no difference and many are solved at once.
///
/// The order is the solver's stability, too: colour by colour over the whole cloth holds at every size, row by
/// row blows up.
#[derive(Reflect, Debug, Default, Clone, PartialEq)]
#[reflect(opaque)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct Springs {
    storage: SpringStorage,
}

/// Where the springs are.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum SpringStorage {
    /// Along the rows, columns and diagonals of a grid. Nothing is stored a spring.
    Grid(ClothGrid, Compliances),
    /// Anywhere.
    List(Arc<SpringList>),
}

impl Default for SpringStorage {
    fn default() -> Self {
        Self::List(Arc::default())
    }
}

/// Springs anywhere, colour by colour.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct SpringList {
    pub springs: Vec<Spring>,
    pub colours: Vec<Range<usize>>,
    /// Those that are solved together; the others are swept colour by colour before.
    pub threads: Threads,
}

impl SpringList {
    /// The same springs, all swept one by one.
    pub fn without_threads(&self) -> Self {
        Self {
            springs: self.springs.clone(),
            colours: self.colours.clone(),
            threads: Threads::default(),
        }
    }

    /// Adds springs between `particles` particles, in colours of their own. Each gets the first that neither of its ends
    /// has yet. Returns the place of each.
    fn add(&mut self, springs: &[Spring], particles: usize) -> Vec<u32> {
        let mut taken: Vec<u64> = vec![0; particles];
        let mut colour_of = Vec::with_capacity(springs.len());
        for (index, spring) in springs.iter().enumerate() {
            let [a, b] = spring.ends.map(|end| end as usize);
            // A particle with more than 63 springs puts the rest into colours of one spring each.
            let free = (!(taken[a] | taken[b])).trailing_zeros().min(63);
            let colour = if free < 63 {
                taken[a] |= 1 << free;
                taken[b] |= 1 << free;
                free as usize
            } else {
                63 + index
            };
            colour_of.push((colour, index));
        }
        colour_of.sort_unstable();
        let mut places = vec![0; springs.len()];
        for (place, (_, index)) in (self.springs.len()..).zip(&colour_of) {
            places[*index] = place as u32;
        }
        for group in colour_of.chunk_by(|(a, _), (b, _)| a == b) {
            let start = self.springs.len();
            self.springs
                .extend(group.iter().map(|&(_, index)| springs[index]));
            self.colours.push(start..self.springs.len());
        }
        places
    }
}

/// Compliance of a square patch by each kind of spring (m/N); infinite for no such springs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Compliances {
    pub structural: f32,
    pub shear: f32,
}

impl Compliances {
    /// Of a strip that a spring from (row, column), with this step and length, stands for, on a border half as
    /// wide: compliance × length ⁄ width. `None` if there are no such springs.
    pub fn of_strip(
        &self,
        grid: &ClothGrid,
        (down, across): (u32, i32),
        (row, column): (u32, u32),
    ) -> Option<f32> {
        let on_border = |index: u32, count: u32| index == 0 || index + 1 == count;
        let (width, narrowed) = match (down, across) {
            (0, _) => (grid.spacing().y, on_border(row, grid.rows())),
            (_, 0) => (grid.spacing().x, on_border(column, grid.columns())),
            _ => (grid.step_length((down, across)), false),
        };
        let compliance = if down > 0 && across != 0 {
            self.shear
        } else {
            self.structural
        };
        let narrowed = if narrowed { 2.0 } else { 1.0 };
        compliance
            .is_finite()
            .then_some(compliance * grid.step_length((down, across)) / width * narrowed)
    }
}

/// The springs of a grid, colour by colour: rows down and columns across from one end to the other, and which
/// of them. Both diagonals of a pair of rows come before those of the next pair.
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

impl Springs {
    /// Structural and shear springs of `grid`. A strip's compliance follows from its length over its
    /// width ([`ClothMaterial`]); a strip on a border is half as wide. Kinds whose compliance is infinite are
    /// left out.
    pub fn of_grid(grid: &ClothGrid, material: &ClothMaterial) -> Self {
        let compliances = Compliances {
            structural: material.stretch_compliance,
            shear: material.shear_compliance,
        };
        Self {
            storage: SpringStorage::Grid(*grid, compliances),
        }
    }

    /// Any springs between `particles` particles. Each gets the first colour that neither of its ends has yet: fewer than twice as many colours as springs meet in one particle, while that are 31 or fewer; of
    /// more than 63 each further spring is a colour by itself.
    ///
    /// # Errors
    /// [`ClothError::BadSpring`] for the first that has an end too many or twice, or a rest length or
    /// compliance out of range.
    pub fn of_list(springs: &[Spring], particles: usize) -> Result<Self, ClothError> {
        for (index, spring) in springs.iter().enumerate() {
            let [a, b] = spring.ends.map(|end| end as usize);
            let is_valid = a.max(b) < particles
                && a != b
                && (1.0e-9..1.0e12).contains(&spring.rest_length)
                && spring.compliance >= 0.0
                && spring.compliance.is_finite();
            if !is_valid {
                return Err(ClothError::BadSpring {
                    index,
                    spring: *spring,
                    particles,
                });
            }
        }
        let mut list = SpringList::default();
        list.add(springs, particles);
        Ok(Self {
            storage: SpringStorage::List(Arc::new(list)),
        })
    }

    /// The springs of a surface: those of its [grid](Self::of_grid), if it was made from one.
    ///
    /// Those of a mesh run along its edges, of the stretch compliance. Edges run in all directions, so they resist shear as well;
    /// where the material's shear compliance is less than its stretch compliance, springs across each edge, between the corners
    /// that face each other there, add what is lacking.
    pub fn of_surface(surface: &Surface, material: &ClothMaterial) -> Self {
        if let Some(grid) = surface.as_grid() {
            return Self::of_grid(grid, material);
        }
        let stiffness = |compliance: f32| 1.0 / compliance;
        let shear = stiffness(material.shear_compliance) - stiffness(material.stretch_compliance);
        // Rigid stretch leaves nothing to add, not even to rigid shear.
        let shear = if material.stretch_compliance > 0.0 {
            shear.max(0.0)
        } else {
            0.0
        };
        let across = stiffness(shear);
        let compliance = |kind| match kind {
            SpringKind::Structural => material.stretch_compliance,
            SpringKind::Shear | SpringKind::Bend => across,
        };
        let mut list = SpringList::default();
        // Those along edges come last: what is stiffer has the last word.
        let [_, places] = [SpringKind::Bend, SpringKind::Structural].map(|kind| {
            let links = surface.links().iter().filter(|link| link.kind == kind);
            let springs: Vec<Spring> = links
                .map(|link| Spring {
                    kind,
                    ends: link.ends,
                    rest_length: link.rest_length,
                    compliance: compliance(kind) * link.slenderness,
                })
                .filter(|spring| spring.compliance.is_finite())
                .collect();
            list.add(&springs, surface.len())
        });
        let is_edge = |link: &&Link| link.kind == SpringKind::Structural;
        // Whoever gives no stretch springs has no threads.
        if places.len() == surface.links().iter().filter(is_edge).count() {
            list.threads = surface.threads().renamed(|edge| places[edge as usize]);
        }
        Self {
            storage: SpringStorage::List(Arc::new(list)),
        }
    }

    /// Calls `visit` with each spring and the number of its colour, in the order in which they are swept.
    pub fn for_each(&self, mut visit: impl FnMut(usize, Spring)) {
        match &self.storage {
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

    /// All springs, in the order in which they are swept.
    pub fn to_vec(&self) -> Vec<Spring> {
        let mut springs = Vec::with_capacity(self.len());
        self.for_each(|_, spring| springs.push(spring));
        springs
    }

    /// Number of springs.
    pub fn len(&self) -> usize {
        match &self.storage {
            SpringStorage::Grid(grid, compliances) => {
                let (columns, rows) = (grid.columns() as usize, grid.rows() as usize);
                let along = columns.saturating_sub(1) * rows + columns * rows.saturating_sub(1);
                let there = |compliance: f32, count: usize| {
                    if compliance.is_finite() { count } else { 0 }
                };
                there(compliances.structural, along)
                    + there(
                        compliances.shear,
                        2 * columns.saturating_sub(1) * rows.saturating_sub(1),
                    )
            }
            SpringStorage::List(list) => list.springs.len(),
        }
    }

    /// Whether there is no spring, as before the first tick.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether there are springs of `kind`.
    pub fn has(&self, kind: SpringKind) -> bool {
        match &self.storage {
            SpringStorage::Grid(_, compliances) => match kind {
                SpringKind::Structural => compliances.structural.is_finite(),
                SpringKind::Shear => compliances.shear.is_finite(),
                SpringKind::Bend => false,
            },
            SpringStorage::List(list) => list.springs.iter().any(|spring| spring.kind == kind),
        }
    }

    /// Where they are, for the solver.
    pub(crate) fn storage(&self) -> &SpringStorage {
        &self.storage
    }
}

/// Which colour of its step a grid's spring from `cell` has.
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
