//! One side of a seam: lines along a surface, or a region of it.

use std::collections::BTreeMap;

use super::line::Line;
use crate::cloth::{
    arrays::distinct,
    lines::{EdgeLine, edge_lines},
    pins::{Pin, PinError},
    surface::Surface,
};

/// The particles of one side of a seam.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum SewnSide {
    /// Lines, each in the order of its particles.
    Lines(Vec<Line>),
    /// Faces, whose nearest points are sewn.
    Region(Vec<[u32; 3]>),
}

impl SewnSide {
    /// The particles that `pins` name on `surface`. A list of single particles keeps its order. Particles along the border
    /// follow it, and other particles follow edges. Where these enclose faces, they are a region.
    ///
    /// # Errors
    /// Those of [`Pin::validate`], and [`PinError::FindsNothing`].
    pub fn of(surface: &Surface, pins: &[Pin]) -> Result<Self, PinError> {
        pins.iter().try_for_each(|pin| pin.validate(surface))?;
        let mut named: Vec<u32> = Vec::new();
        for pin in pins {
            pin.for_each(surface, |particle| named.push(particle as u32));
        }
        if named.is_empty() {
            let pin = format!("{pins:?}");
            return Err(PinError::FindsNothing { pin });
        }
        let is_single = |pin: &Pin| {
            matches!(
                pin,
                Pin::Index(_) | Pin::Vertex(_) | Pin::Cell(..) | Pin::Corner(_)
            )
        };
        if pins.iter().all(is_single) {
            named.dedup();
            let is_ring = named.len() > 3 && named.first() == named.last();
            if is_ring {
                named.pop();
            }
            let line = Line::new(named, is_ring, surface.rest_positions());
            return Ok(Self::Lines(vec![line]));
        }
        Ok(Self::selected(surface, &distinct(named)))
    }

    /// Lines or a region of these particles, ascending.
    fn selected(surface: &Surface, selected: &[u32]) -> Self {
        let is_selected = |particle: &u32| selected.binary_search(particle).is_ok();
        let mut faces = Vec::new();
        let mut uses = BTreeMap::<[u32; 2], u32>::new();
        for face in surface.triangles() {
            if face.iter().all(is_selected) {
                faces.push(*face);
            }
            let [a, b, c] = *face;
            for [p, q] in [[a, b], [b, c], [c, a]] {
                if is_selected(&p) && is_selected(&q) {
                    *uses.entry([p.min(q), p.max(q)]).or_default() += 1;
                }
            }
        }
        if surface.rope_radius().is_some() {
            let beside = selected.windows(2).filter(|ends| ends[1] == ends[0] + 1);
            uses.extend(beside.map(|ends| ([ends[0], ends[1]], 1)));
        }
        let border = uses.iter().filter(|(_, count)| **count == 1);
        let border: Vec<[u32; 2]> = border.map(|(edge, _)| *edge).collect();
        let is_at_border = |particle: &u32| border.iter().any(|edge| edge.contains(particle));
        if faces.is_empty() {
            let all: Vec<[u32; 2]> = uses.into_keys().collect();
            Self::Lines(lines(surface, selected, &all))
        } else if selected.iter().all(is_at_border) && !encloses(&border, selected, &faces) {
            Self::Lines(lines(surface, selected, &border))
        } else {
            Self::Region(faces)
        }
    }

    /// Its lines, if it has any.
    pub fn lines(&self) -> &[Line] {
        match self {
            Self::Lines(lines) => lines,
            Self::Region(_) => &[],
        }
    }

    /// Number of particles, a common one counted each time.
    pub fn len(&self) -> usize {
        match self {
            Self::Lines(lines) => lines.iter().map(|line| line.particles.len()).sum(),
            Self::Region(faces) => 3 * faces.len(),
        }
    }
}

/// Whether particles are a narrow strip of faces rather than a line: most of them would be corners.
fn encloses(border: &[[u32; 2]], selected: &[u32], faces: &[[u32; 3]]) -> bool {
    faces.len() > selected.len() / 2 || border.len() > selected.len() + 1
}

/// The lines of edges between `selected` particles. Each begins at the end with the lower vertex.
fn lines(surface: &Surface, selected: &[u32], edges: &[[u32; 2]]) -> Vec<Line> {
    let place = |particle: u32| selected.binary_search(&particle).ok();
    let mut vertex_of = vec![usize::MAX; selected.len()];
    for vertex in (0..surface.vertices()).rev() {
        let particle = surface.particle_of_vertex(vertex);
        if let Some(place) = particle.and_then(|particle| place(particle as u32)) {
            vertex_of[place] = vertex;
        }
    }
    let mut beside = vec![Vec::new(); selected.len()];
    for [a, b] in edges {
        if let (Some(a), Some(b)) = (place(*a), place(*b)) {
            beside[a].push(b);
            beside[b].push(a);
        }
    }
    let line = |EdgeLine { places, is_ring }| {
        let particles = places.into_iter().map(|place| selected[place]).collect();
        Line::new(particles, is_ring, surface.rest_positions())
    };
    let lines = edge_lines(&mut beside, |place| vertex_of[place]);
    lines.into_iter().map(line).collect()
}
