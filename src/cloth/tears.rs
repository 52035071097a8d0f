//! The edges along which a cloth is torn.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    platform::collections::HashSet,
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::surface::Surface;

/// The edges along which a cloth is torn, in the order in which they were torn. It is empty until something tears:
/// `ClothTearing` under load, `ClothBlade` by a cut, or a game that calls [`tear`](Self::tear).
///
/// An edge is a pair of neighbouring particles of the cloth as it was spawned; on a grid, also the two ends of a diagonal of
/// [`Surface::triangles`]. A particle becomes two where torn edges separate its faces. One edge
/// alone opens nothing, unless an end of it is at a border.
///
/// Torn cloth keeps its particles, with their places, velocities and total mass. New particles follow after them. A pinned or
/// attached particle holds both sides of a tear through it. A torn grid is still solved as a grid, whose rows and columns
/// are cut; its faces are those of a mesh. Its parts stay one cloth. Each of them collides and
/// sleeps by itself. Scenes hold this component, and snapshots do, too.
///
/// To mend a cloth, empty it: `*tears = ClothTears::default()`. Edges that the cloth does not have are a fault,
/// [`NoSuchEdge`](crate::cloth::TearError::NoSuchEdge). So empty it when you give the entity another `Cloth`.
///
/// ```
/// use bevy_drape::prelude::*;
///
/// // 4 columns: a slit from the left border into the cloth, between the second and the third row.
/// let mut tears = ClothTears::default();
/// assert!(tears.tear([4, 5]) && tears.tear([5, 6]));
/// assert!(!tears.tear([6, 5]), "it is torn already");
/// ```
#[derive(Component, Reflect, Debug, Default, Clone, PartialEq, Eq)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothTears(Vec<[u32; 2]>);

impl ClothTears {
    /// Nothing torn.
    pub const fn none() -> Self {
        Self(Vec::new())
    }

    /// Tears along an edge. Returns whether it was whole.
    pub fn tear(&mut self, [a, b]: [u32; 2]) -> bool {
        let edge = [a.min(b), a.max(b)];
        let is_whole = !self.0.contains(&edge);
        if is_whole {
            self.0.push(edge);
        }
        is_whole
    }

    /// Tears along many edges. Returns how many of them were whole.
    pub fn tear_all(&mut self, edges: impl IntoIterator<Item = [u32; 2]>) -> usize {
        let before = self.0.len();
        let mut known: HashSet<[u32; 2]> = self.0.iter().copied().collect();
        for [a, b] in edges {
            let edge = [a.min(b), a.max(b)];
            if known.insert(edge) {
                self.0.push(edge);
            }
        }
        self.0.len() - before
    }

    /// Tears a face out, given by its particles: it comes off as a part of its own. Returns how many edges were whole:
    /// 0 of particles that do not exist.
    pub fn tear_out(&mut self, surface: &Surface, [a, b, c]: [u32; 3]) -> usize {
        let exist = [a, b, c].iter().all(|end| (*end as usize) < surface.len());
        // The segment of a rope is no face.
        if b == c || !exist {
            return 0;
        }
        let edges = [[a, b], [b, c], [c, a]];
        self.tear_all(edges.map(|edge| edge.map(|end| surface.origin_of(end))))
    }

    /// Tears the cloth off a particle, such as a pinned one: it keeps the faces around it, and the rest comes off. Returns how
    /// many edges were whole: 0 of a particle that does not exist.
    pub fn tear_off(&mut self, surface: &Surface, particle: u32) -> usize {
        if particle as usize >= surface.len() {
            return 0;
        }
        let edges = surface
            .faces_around(particle)
            .map(|[a, b, c]| match particle {
                of if of == a => [b, c],
                of if of == b => [c, a],
                _ => [a, b],
            });
        self.tear_all(edges.map(|edge| edge.map(|end| surface.origin_of(end))))
    }

    /// The torn edges, in the order in which they were torn. The smaller index of each comes first.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.0
    }

    /// Number of torn edges that are whole in another.
    pub(crate) fn count_beyond(&self, other: &Self) -> usize {
        let known: HashSet<&[u32; 2]> = other.0.iter().collect();
        self.0.iter().filter(|edge| !known.contains(edge)).count()
    }

    /// The first edges of these.
    pub(crate) fn first(&self, count: usize) -> Self {
        Self(self.0[..count.min(self.0.len())].to_vec())
    }

    /// Whether nothing is torn.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As many edges are mended as are torn: the torn ones count.
    #[test]
    fn mended_edges_do_not_count_against_torn_ones() {
        let [mut before, mut now] = [ClothTears::none(), ClothTears::none()];
        before.tear_all([[1, 2], [2, 3], [3, 4]]);
        now.tear_all([[3, 2], [8, 7], [8, 9]]);
        assert_eq!(now.count_beyond(&before), 2);
        assert_eq!(before.count_beyond(&now), 2);
        assert_eq!(now.count_beyond(&now), 0);
        assert_eq!(ClothTears::none().count_beyond(&now), 0);
    }
}
