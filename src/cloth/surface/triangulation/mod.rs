//! The triangles on which a mesh bends.
//!
//! The energy of a face is exact for any quadratic surface. But where diagonals alternate, a constant curvature leaves forces
//! on the particles, outwards where eight faces meet and inwards where four do. The particles yield to these forces, and the
//! cloth bends a third too easily. Where diagonals are parallel there are none. On a flat quad, either diagonal may
//! serve: so they are turned, for bending alone.
//!
//! ```text
//!  a ―― d          the diagonal a b of two faces is turned to c d: if the circle around a b c holds d
//!  | \  |          (Delaunay 1934), or to be parallel with the diagonal beside it, if the four lie about on
//!  c ―― b          one circle
//! ```

mod faces;
#[cfg(test)]
mod tests;
mod turning;

pub(crate) use faces::Triangulation;
pub(super) use turning::turned;
