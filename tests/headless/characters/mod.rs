//! Cloth on characters: skinned poses, what it feels of their motion, colliders on their bones.

pub mod arm;
mod body;
mod bones;
mod cost;
mod errors;
mod file;
mod inertia;
mod limits;
mod pose;
pub mod rig;
mod teleports;
