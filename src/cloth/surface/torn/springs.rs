//! The springs that tears leave.

use bevy::math::Vec2;

use crate::cloth::{
    arrays::sorted,
    spring::SpringKind::{self, Bend, Shear, Structural},
    surface::{
        Link, Surface, Torn,
        springs::{Side, face_area, for_each_pair},
    },
};

impl Torn {
    /// The springs, and the particles at a border. A spring along a torn edge becomes one for each side, and stands for
    /// the area on its side. Those across a torn edge are gone.
    pub fn links(&self) -> (Vec<Link>, Vec<bool>) {
        let whole = &self.whole;
        let faces = whole.triangles();
        let is_grid = whole.as_grid().is_some();
        let first_along = (whole.links).partition_point(|link| link.kind != Structural);
        let (known_across, known_along) = whole.links.split_at(first_along);
        let (mut known_across, mut known_along) = (known_across.iter(), known_along.iter());
        let (mut across, mut along) = (Vec::new(), Vec::new());
        let mut is_border = vec![false; self.origin.len()];
        let area = |side: &Side| face_area(faces[side.face as usize], &whole.rest);
        let mut own = Vec::new();
        for sides in (whole.incidence().sides).chunk_by(|a, b| a.ends == b.ends) {
            let is_diagonal =
                is_grid && whole.diagonal_of(faces[sides[0].face as usize]) == sides[0].ends;
            let known = if is_grid { None } else { known_along.next() };
            own.clear();
            own.extend(sides.iter().map(|side| self.ends(side)));
            let is_torn = own.iter().any(|ends| *ends != own[0]);
            for (index, ends) in own.iter().enumerate() {
                if own[..index].contains(ends) {
                    continue;
                }
                let alike = sides.iter().zip(&own).filter(|(_, other)| *other == ends);
                let count = alike.clone().count() as u32;
                if count != 2 {
                    ends.iter().for_each(|end| is_border[*end as usize] = true);
                }
                match known {
                    Some(known) => {
                        let mut link = *known;
                        link.ends = *ends;
                        if is_torn {
                            let total: f32 = sides.iter().map(area).sum();
                            link.slenderness *=
                                total / alike.map(|(side, _)| area(side)).sum::<f32>();
                        }
                        along.push(link);
                    }
                    None if is_diagonal => across.push(whole.grid_link(Shear, *ends, self, count)),
                    None => along.push(whole.grid_link(Structural, *ends, self, count)),
                }
            }
            for_each_pair(sides, &whole.rest, |one, other| {
                let known = if is_grid { None } else { known_across.next() };
                if self.ends(one) != self.ends(other) || is_grid && !is_diagonal {
                    return;
                }
                let ends = sorted([one, other].map(|side| self.opposite(side)));
                across.push(match known {
                    Some(known) => Link { ends, ..*known },
                    None => whole.grid_link(Shear, ends, self, 2),
                });
            });
        }
        across.append(&mut along);
        (across, is_border)
    }

    /// The sides of its faces, which are in the order of the whole surface's. Those at one edge follow each other.
    pub fn sides(&self) -> Vec<Side> {
        let of_whole = &self.whole.incidence().sides;
        let mut all: Vec<Side> = Vec::with_capacity(of_whole.len());
        for sides in of_whole.chunk_by(|a, b| a.ends == b.ends) {
            let begin = all.len();
            for side in sides {
                let own = Side {
                    ends: self.ends(side),
                    face: side.face,
                    opposite: self.opposite(side),
                };
                let mut beside = all[begin..].iter();
                let beside = beside.rposition(|known| known.ends == own.ends);
                all.insert(beside.map_or(all.len(), |at| begin + at + 1), own);
            }
        }
        all
    }

    /// The particle at a corner of a face, by the particle of the whole surface.
    pub(super) fn corner(&self, face: u32, particle: u32) -> u32 {
        let face = face as usize;
        let at = (self.whole.triangles()[face].iter()).position(|corner| *corner == particle);
        self.corners[face][at.unwrap_or(0)]
    }

    /// The ends of a face's side.
    fn ends(&self, side: &Side) -> [u32; 2] {
        sorted(self.ends_of(side))
    }
}

impl Surface {
    /// A spring of a grid with this number of faces at its side: of a strip that is as wide as a cell for two.
    fn grid_link(&self, kind: SpringKind, ends: [u32; 2], torn: &Torn, faces: u32) -> Link {
        let [a, b] = ends.map(|end| torn.origin[end as usize]);
        let spacing = self.grid.map_or(Vec2::ONE, |grid| grid.spacing());
        let rest_length = self.rest[a as usize].distance(self.rest[b as usize]);
        let width = match kind {
            Structural if a.abs_diff(b) == 1 => spacing.y,
            Structural => spacing.x,
            Shear | Bend => rest_length,
        };
        Link {
            kind,
            ends,
            rest_length,
            slenderness: rest_length / width * 2.0 / faces as f32,
        }
    }
}
