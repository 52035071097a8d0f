//! The particles that each pin names on a surface.

use bevy::math::Vec3;

use super::{Corner, Pin, PinError};
use crate::cloth::{
    grid::ClothGrid,
    surface::{Surface, VertexAttribute},
};

impl Pin {
    /// Checks that the pin names particles of `surface`. A predicate may match none.
    ///
    /// # Errors
    /// [`PinError::OutOfRange`], [`NeedsGrid`](PinError::NeedsGrid),
    /// [`NoSuchAttribute`](PinError::NoSuchAttribute), or [`FindsNothing`](PinError::FindsNothing) if no
    /// particle has the position, colour or attribute.
    pub fn validate(&self, surface: &Surface) -> Result<(), PinError> {
        let pin = || format!("{self:?}");
        let is_inside = match (self, surface.rest_grid()) {
            (Self::Index(index), _) => *index < surface.len(),
            (Self::Vertex(vertex), _) => surface.particle_of_vertex(*vertex).is_some(),
            (Self::Top | Self::AtRest(_), _) | (Self::Corner(_) | Self::Where(_), Some(_)) => true,
            (Self::Near { .. }, _) => return self.finds_something(surface),
            (Self::Attribute { name, channel, .. }, _) => {
                let attributes = surface.attributes();
                if *channel < 4 && attributes.iter().any(|each| each.name() == name) {
                    return self.finds_something(surface);
                }
                let (pin, attributes) = (pin(), VertexAttribute::names(attributes));
                return Err(PinError::NoSuchAttribute { pin, attributes });
            }
            (_, None) => return Err(PinError::NeedsGrid { pin: pin() }),
            (Self::Cell(row, column), Some(grid)) => *row < grid.rows() && *column < grid.columns(),
            (Self::Row(row), Some(grid)) => *row < grid.rows(),
            (Self::Column(column), Some(grid)) => *column < grid.columns(),
        };
        if is_inside {
            return Ok(());
        }
        let (pin, cloth) = (pin(), surface.to_string());
        Err(PinError::OutOfRange { pin, cloth })
    }

    /// Whether it is a predicate that holds for no particle of `surface`, which is no error.
    pub(crate) fn is_in_vain(&self, surface: &Surface) -> bool {
        let is_predicate = matches!(self, Self::Where(_) | Self::AtRest(_));
        is_predicate && self.finds_something(surface).is_err()
    }

    fn finds_something(&self, surface: &Surface) -> Result<(), PinError> {
        let mut found = false;
        self.for_each(surface, |_| found = true);
        if found {
            return Ok(());
        }
        let pin = format!("{self:?}");
        Err(PinError::FindsNothing { pin })
    }

    /// Calls `pinned` with the index of each particle of `surface` that the pin names, possibly more than once. The pin
    /// must be valid for it. Where the surface is torn, all parts of a particle have its name, but for its index.
    pub(crate) fn for_each(&self, surface: &Surface, mut pinned: impl FnMut(usize)) {
        if let Self::Index(index) = self {
            return pinned(*index);
        }
        let mut is_named = vec![false; if surface.is_torn() { surface.len() } else { 0 }];
        self.for_each_whole(surface, |index| {
            pinned(index);
            if let Some(is_named) = is_named.get_mut(index) {
                *is_named = true;
            }
        });
        let parts = surface.copies().filter(|(_, of)| is_named[*of as usize]);
        parts.for_each(|(part, _)| pinned(part as usize));
    }

    fn for_each_whole(&self, surface: &Surface, mut pinned: impl FnMut(usize)) {
        let scale = surface.scale();
        let places = || {
            let unscaled = surface.whole_positions().map(|place| place / scale);
            unscaled.enumerate()
        };
        match self {
            Self::Index(index) => pinned(*index),
            Self::Vertex(vertex) => {
                let particle = surface.particle_of_vertex(*vertex);
                particle.into_iter().for_each(pinned);
            }
            Self::Near { point, radius } => {
                // Up to rounding of the positions.
                let reach = |place: Vec3| radius + 1.0e-6 * place.length();
                let is_near = |(_, place): &(_, Vec3)| place.distance(*point) <= reach(*place);
                let found = places().filter(is_near);
                found.for_each(|(index, _)| pinned(index));
            }
            Self::AtRest(predicate) => {
                let found = places().filter(|(_, place)| predicate.holds(*place));
                found.for_each(|(index, _)| pinned(index));
            }
            Self::Attribute {
                name,
                channel,
                above,
            } => {
                let attribute = surface.attributes().iter().find(|each| each.name() == name);
                let values = attribute.map_or(&[][..], VertexAttribute::values);
                for (index, value) in values.iter().enumerate() {
                    if value.get(*channel).is_some_and(|value| value > above) {
                        pinned(index);
                    }
                }
            }
            _ => {
                if let Some(grid) = surface.rest_grid() {
                    let mut cell = |row, column| pinned(grid.index(row, column) as usize);
                    self.for_each_cell(grid, &mut cell);
                }
            }
        }
    }

    /// The particles of pins by rows and columns.
    fn for_each_cell(&self, grid: &ClothGrid, mut cell: impl FnMut(u32, u32)) {
        let (rows, columns) = (grid.rows(), grid.columns());
        let (last_row, last_column) = (rows - 1, columns - 1);
        match self {
            Self::Cell(row, column) => cell(*row, *column),
            Self::Row(row) => (0..columns).for_each(|column| cell(*row, column)),
            // The top of a rope is its first particle.
            Self::Top if rows == 1 => cell(0, 0),
            Self::Top => (0..columns).for_each(|column| cell(0, column)),
            Self::Column(column) => (0..rows).for_each(|row| cell(row, *column)),
            Self::Corner(Corner::TopLeft) => cell(0, 0),
            Self::Corner(Corner::TopRight) => cell(0, last_column),
            Self::Corner(Corner::BottomLeft) => cell(last_row, 0),
            Self::Corner(Corner::BottomRight) => cell(last_row, last_column),
            Self::Where(predicate) => {
                let found = grid
                    .cells()
                    .filter(|(row, column)| predicate.holds(*row, *column));
                found.for_each(|(row, column)| cell(row, column));
            }
            Self::Index(_)
            | Self::Vertex(_)
            | Self::Near { .. }
            | Self::AtRest(_)
            | Self::Attribute { .. } => {}
        }
    }
}
