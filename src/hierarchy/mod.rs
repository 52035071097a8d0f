//! Floor 1: searching a cloth: a quadtree over the particles, bounding volumes, the top-down query.
//!
#![doc = include_str!("../../assets/hierarchy.svg")]
//!
//! # The tree
//!
//! A [`QuadTree`] divides the particles into patches, and each patch into up to four, down to one particle in each
//! leaf. It depends only on the rest shape and is built once.
//!
//! - *Grids.* Rows and columns are halved on each level. No nodes are stored: the halves of the rows and columns define
//!   them. Columns are first split into strips, and all strips are then halved alike. So, where nodes are no wider than
//!   a strip, eight lanes hold eight nodes of one level, and one instruction works on all of them.
//! - *Meshes.* Any particles, joined by any springs. A patch is halved along its longest extent at rest. A patch is
//!   folded if its radius along the surface is at least 1.5 times that through space. Its particles are then
//!   divided by the nearer of its two ends along the surface, so the front of a sleeve soon shares few patches with its
//!   back. Distances along the springs are shortest paths (Dijkstra 1959).
//!
//! A node stores its *middle particle* *m*, and its *rest radius*: the largest distance at rest, along structural and
//! shear springs, from *m* to a particle of its patch. Leaves are all on the last level and have the radius 0.
//!
//! # Top down
//!
//! A [`TopDownQuery`] tests the root, and then, level by level, the children of each node that touches the [`Probe`]. A
//! tested node is *visited*. It is *touching* if its volume is within reach of the probe. Otherwise it is *pruned*, and
//! nothing below it is tested. A touching leaf is tested by the paper's equation (4): its particle is a *candidate* if
//! its distance from the probe's core is less than the sum of both radii.
//!
//! The leaf test uses `f64`, like [`brute_force`]. Volumes use `f32` and round towards touching. So if no volume misses
//! a particle, the candidates equal those of brute force.
//!
//! # The rules
//!
//! A [`BoundRule`] defines the volumes. `Paper`'s lengths are in spacings.
//!
//! | rule | position of the volume | cost of a tick | complete? |
//! |---|---|---|---|
//! | `RestShape` | around *m*; rest radius × (1 + largest stretch) | one number per cloth | yes |
//! | `Refit` | around the children's volumes, bottom up | all particles and nodes | yes |
//! | `Paper` | around the corners' mean; (longest side + 1)/2, halved on each level | all nodes | **no** |
//!
//! `Paper` is defined for grids; over a network `RestShape` replaces it. A sphere or an AABB supports all rules, an OBB
//! or a k-DOP only `Refit`.
//!
//! # Nothing is missed
//!
//! **Theorem.** Under `RestShape`, every particle that the probe meets is among the candidates.
//!
//! *Proof.* Let a node have the middle particle *m*, and let *p* be any particle of its patch. Some path of structural
//! and shear springs leads from *m* to *p*. Its length at rest is *d*(*m*, *p*). Let *s* be the largest stretch over
//! all of these springs. Each spring on the path is now no longer than its rest length × (1 + *s*). The
//! triangle inequality along the path gives |*x*ₘ − *x*ₚ| ≤ *d*(*m*, *p*) (1 + *s*) ≤ *r*. So the node's sphere contains
//! *p*, and so does the box around it.
//!
//! Now let the probe meet *p*. Then a point of the volume is within reach of the core, and the node touches. The
//! patches of the leaf of *p* and of all its ancestors contain *p*, so this holds for each of these nodes. By induction
//! from the root, which is always visited, all of them are visited and touch, and *p* passes the leaf's test. ∎ The
//! proof does not need a child's volume inside its parent's, and it may be outside.
//!
//! The proof assumes:
//!
//! 1. *s* is measured on the searched positions. The solver's last sub-step measures it, after its responses to
//!    contacts. If a game has written particles, it is measured again before the search.
//! 2. The springs exist as listed, with rest lengths above 0. If shear compliance is infinite, there are no diagonals:
//!    distances are along rows and columns. Without a path, the radius is infinite.
//! 3. Rounding is on the safe side. Radii and reaches grow by 10⁻⁵ each, which exceeds all rounding errors of a bound
//!    and its test together. Leaves are tested in `f64`.
//! 4. Particles move within a tick. The probe is the collider along its whole path, inflated by a *margin*. The largest
//!    displacement of each sub-step and the largest pushes are added up. If the sum exceeds the margin, the particles'
//!    displacement since the search is measured. If that exceeds the margin, too, the search is repeated before anything
//!    else is done.
//!
//! A tear takes springs away, and so it breaks the second assumption for the tree of the whole cloth. Therefore a torn cloth has a
//! tree of its own, over the springs that are left, before anything searches it. A particle that comes apart is two in that tree. Distances
//! along the springs grow, and a patch whose parts hang together no more has an infinite radius. Such a patch is halved between its
//! parts, as far as halves of equal size allow. The theorem holds for the torn cloth as for any network, with the stretch of the springs that are left.
//!
//! The proof does not assume that the cloth is flat, convex or smooth: it may be folded, crumpled, or intersect itself.
//! A network's path may leave its patch, because *s* is that of the whole cloth.
//!
//! `Refit` is complete, too. A leaf's volume contains its particle. If the volumes of a node's children contain their
//! particles, the node's volume, which contains the children's, contains them all. By induction every volume contains
//! its patch.
//!
//! `Paper` is not complete. On level *l* of 2ᵏ × 2ᵏ particles, patches have *n* = 2ᵏ⁻ˡ particles a side and the radius
//! (*n* + 2⁻ˡ)/2. But the corner of a flat patch is (*n* − 1)/√2 from the mean. For 16 × 16, the root has the radius
//! 8.5 and needs 7.5 √2 = 10.61. Level 1 has 4.25 and needs 4.95; level 2 just suffices, with 2.125 for 2.121. From 32
//! × 32 on, every node of 4 × 4 or more is too small: all levels but the last two. A ball at the corner of such a patch
//! is missed.
//!
//! Boxes with that half side contain flat patches along the axes on every level. They fail like spheres in three cases:
//!
//! - The patch is rotated by 45° in its plane.
//! - It is stretched by more than (1 + 2⁻ˡ)/(*n* − 1), 13 % for the root of 16 × 16.
//! - Its corners' mean is far from its middle, as in a patch folded along a diagonal.
//!
//! # When each volume pays
//!
//! A ball of 4 spacings, a draped cloth of 256 × 256 particles, one core of a 2.8 GHz Xeon; a scan takes 25 µs.
//!
//! | volume, rule | rebuild (µs) | query (µs) | nodes visited |
//! |---|---|---|---|
//! | spheres, `RestShape` | 0.01 | 0.9 | 141 |
//! | AABBs, `RestShape` | 0.01 | 2.1 | 209 |
//! | spheres, `Refit` | 49 | 0.8 | 109 |
//! | AABBs, `Refit` | 55 | 0.4 | 37 |
//! | OBBs, `Refit` | 2500 | 0.8 | 33 |
//! | 14-DOPs, `Refit` | 420 | 1.4 | 37 |
//! | 18-DOPs, `Refit` | 540 | 1.8 | 37 |
//! | 26-DOPs, `Refit` | 760 | 2.4 | 37 |
//!
//! `cargo bench --profile dev --bench hierarchy` prints these.
//!
//! For one ball, use spheres by the rest shape, at any size: a refit costs more than testing every particle. Below
//! about 64 × 64 particles, a scan of all of them, eight at a time, is as fast, and simpler. A refit costs once per
//! tick, a query once per collider. So AABBs by `Refit` pay from about one collider for every 600 particles on. Stretch
//! counts like colliders: the number of nodes that a search at rest radii visits grows with (1 + *s*)².
//!
//! OBBs and k-DOPs fit closer than spheres. But a node of theirs costs more to update and to test than its pruning
//! saves here; they are for comparison and study. [`SearchMethod::Auto`] chooses by these figures.

mod bounds;
mod method;
mod probe;
mod query;
mod ray;
mod rule;
mod scan;
mod search_buffers;
#[cfg(test)]
mod tests;
mod tree;
mod volume;

pub use bounds::NodeBounds;
#[doc(hidden)]
pub use method::SEARCH_FROM;
pub use method::{SearchMethod, SearchReason};
#[doc(hidden)]
pub use probe::{Core, Probe};
pub use query::{NodeState, TopDownQuery};
pub(crate) use ray::RayQuery;
pub use rule::BoundRule;
#[doc(hidden)]
pub use scan::brute_force;
pub use tree::{Node, QuadTree};
pub use volume::{BoundingVolume, KDop, NodeVolume, Obb};
