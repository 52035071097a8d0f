//! The faces of particles, and what they feel.
