//! The stencils of a torn grid against bending: chains of three particles along its rows and columns, and its cells.

use crate::cloth::surface::{Surface, Torn, springs::Side};

/// No face is on that side of an edge.
const NONE: [u32; 2] = [u32::MAX; 2];

/// Particles of a torn grid that resist bending together. Those that tears made are beyond the particles of the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum StencilKind {
    /// Three in a row, in the faces on one side of it: both ends, then the middle twice.
    Across,
    /// The same in a column.
    Down,
    /// The ends of a cell's diagonal, then its other two corners.
    Twist,
}

impl Surface {
    /// Calls `visit` with each stencil that tears leave of a grid, and nothing of another surface: its kind, a particle of the whole
    /// grid, and its own particles. The first is the middle of a chain, or the corner of a cell with the lowest row and column.
    pub(crate) fn for_each_stencil(&self, mut visit: impl FnMut(StencilKind, u32, [u32; 4])) {
        let Some((torn, grid)) = self.torn.as_ref().zip(self.rest_grid()) else {
            return;
        };
        let (columns, count) = (grid.columns(), torn.whole.len());
        // The ends of the edges that begin at each particle of the grid, in the faces on both sides of the edge.
        let [mut across, mut down] = [(); 2].map(|()| vec![[NONE; 2]; count]);
        let place = |particle: u32| (particle / columns, particle % columns);
        for sides in (torn.whole.incidence().sides).chunk_by(|a, b| a.ends == b.ends) {
            let [a, b] = sides[0].ends;
            let ([row, column], [below, beside]) = (<[u32; 2]>::from(place(a)), place(b).into());
            for side in sides {
                let own = torn.ends_of(side);
                let opposite = place(side.opposite);
                if row == below {
                    across[a as usize][usize::from(opposite.0 > row)] = own;
                } else if column == beside {
                    down[a as usize][usize::from(opposite.1 > column)] = own;
                }
            }
            let is_whole = |one, other| torn.ends_of(one) == torn.ends_of(other);
            if let [one, other] = sides
                && row != below
                && column != beside
                && is_whole(one, other)
            {
                let [from, to] = torn.ends_of(one);
                let [left, right] = [one, other].map(|side| torn.opposite(side));
                let at = row.min(below) * columns + column.min(beside);
                visit(StencilKind::Twist, at, [from, to, left, right]);
            }
        }
        for at in 0..count as u32 {
            let (row, column) = place(at);
            let chains = [
                (StencilKind::Across, &across, column, 1),
                (StencilKind::Down, &down, row, columns),
            ];
            for side in 0..2 {
                for (kind, of, along, step) in chains {
                    if along == 0 {
                        continue;
                    }
                    let [before, after] = [at - step, at].map(|at| of[at as usize][side]);
                    if before[1] == after[0] && before != NONE {
                        visit(kind, at, [before[0], after[1], after[0], after[0]]);
                    }
                }
            }
        }
    }
}

impl Torn {
    /// The ends of a side of the whole surface, in their order there.
    pub(super) fn ends_of(&self, side: &Side) -> [u32; 2] {
        side.ends.map(|end| self.corner(side.face, end))
    }

    /// The particle of a side's face that is not on the side.
    pub(super) fn opposite(&self, side: &Side) -> u32 {
        self.corner(side.face, side.opposite)
    }
}
