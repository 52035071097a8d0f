//! The sharp edges of a collider against the triangles of the cloth, whose corners may all be outside.

mod clearance;
mod edge_contact;
mod fan_view;
mod shape_cache;
mod shape_memory;
mod sharp_edges;

pub(crate) use shape_cache::ShapeCache;
