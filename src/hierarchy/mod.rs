//! Floor 1: how a cloth is *searched*: a quad-tree over the particles, bounding volumes, the top-down query.
//!
#![doc = include_str!("../../assets/hierarchy.svg")]
//!
//! # The tree
//!
//! A [`QuadTree`] parts the particles into patches, each into four at most, down to one particle a leaf. It
//! depends on the rest shape alone and is made once.
//!
//! - *Grids.* Rows and columns are halved on each level. Nothing is stored a node: the halves of the rows and
//!   those of the columns say all. Columns are split strip by strip first, and all strips are then halved
//!   alike. So, where nodes are no wider than a strip, eight lanes hold eight nodes of one level, and one
//!   instruction works on all of them.
//! - *Meshes.* Any particles, joined by any springs. A patch is halved along its longest extent at rest, and each
//!   half along its own. Where it is folded, its radius along the surface 1.5 times that through space, it is halved
//!   by which of its two ends is nearer along the surface: the front of a sleeve soon shares few patches with its back.
//!   Distances along the springs are shortest paths (Dijkstra 1959).
//!
//! A node knows its *middle particle* *m*, and its *rest radius*: the largest distance at rest, along
//! structural and shear springs, from *m* to a particle of its patch. Leaves, all on the last level, have 0.
//!
//! # Top down
//!
//! A [`TopDownQuery`] looks at the root, and then, level by level, at the children of whatever touches the
//! [`Probe`]. A node that it looks at is *visited*. It is *touching* if its volume is within reach of the
//! probe, and otherwise *pruned*: nothing below it is looked at. A leaf that touches is tested by the paper's
//! equation (4): its particle is a *candidate* if it is nearer to the probe's core than both radii together.
//! That test is made in `f64`, and it is the one that [`brute_force`] makes. Volumes are computed in `f32`
//! and err towards touching. So where no volume leaves a particle out, the candidates are those of brute
//! force: no more, no fewer.
//!
//! # The rules
//!
//! A [`BoundRule`] says where the volumes are. `Paper`'s lengths are in spacings.
//!
//! | rule | where the volume is | a tick costs | complete? |
//! |---|---|---|---|
//! | `RestShape` | around *m*; rest radius × (1 + largest stretch) | one number a cloth | yes |
//! | `Refit` | around the children's volumes, bottom up | all particles and nodes | yes |
//! | `Paper` | around the corners' mean; (longest side + 1)/2, halved a level | all nodes | **no** |
//!
//! `Paper` is of grids; over a network `RestShape` takes its place. A sphere or an AABB may follow any rule,
//! an OBB or a k-DOP only `Refit`.
//!
//! # Nothing is missed
//!
//! **Theorem.** Under `RestShape`, every particle that the probe meets is among the candidates.
//!
//! *Proof.* Let a node have the middle particle *m*, and let *p* be any particle of its patch. Some path of
//! structural and shear springs leads from *m* to *p* and is *d*(*m*, *p*) long at rest. Let *s* be the
//! largest stretch over all of these springs. Each spring on the path is now no longer than its rest length ×
//! (1 + *s*). By the triangle inequality along the path, |*x*ₘ − *x*ₚ| ≤ *d*(*m*, *p*) (1 + *s*) ≤ *r*: the
//! node's sphere holds *p*, and so does the box around it. Now let the probe meet *p*: then a point of the
//! volume is within reach of the core, and the node touches. This holds for the leaf of *p* and for each of
//! its ancestors by itself, as the patch of each holds *p*. By induction from the root, which is always
//! visited, all of them are visited and touch, and *p* passes the leaf's test. ∎ Nothing here needs a child's
//! volume to be inside its parent's, and it need not be.
//!
//! What the proof assumes:
//!
//! 1. *s* is measured on the positions that are searched. The solver's last sub-step measures it, after its
//!    responses to contacts; where a game has written particles, it is measured again before the search.
//! 2. The springs are there as listed, with rest lengths above 0. Where shear compliance is infinite there
//!    are no diagonals: distances are along rows and columns. Where no path leads, the radius is infinite.
//! 3. Rounding is on the safe side. Radii and reaches grow by 10⁻⁵ each, which is more than all roundings of
//!    a bound and its test together. Leaves are tested in `f64`.
//! 4. Within a tick, particles move on. The probe is the collider along all of its way, inflated by a
//!    *margin*. The largest displacement of each sub-step and the largest pushes are added up. Where the sum
//!    exceeds the margin, how far particles are from where they were searched is measured; if that exceeds it
//!    too, all of them are searched again before anything else is done.
//!
//! What need not hold: the cloth need not be flat, convex or smooth; it may be folded, crumpled, or passed
//! through itself. A network's path may leave its patch, as *s* is that of the whole cloth.
//!
//! `Refit` is complete, too. A leaf's volume holds its particle. If the volumes of a node's children hold
//! their particles, the node's, which holds the children's, holds them all. By induction every volume holds
//! its patch.
//!
//! `Paper` is not. On level *l* of 2ᵏ × 2ᵏ particles, patches have *n* = 2ᵏ⁻ˡ a side and the radius (*n* +
//! 2⁻ˡ)/2, but the corner of a flat one is (*n* − 1)/√2 from the mean. Of 16 × 16 the root has 8.5 where 7.5
//! √2 = 10.61 is needed, and level 1 has 4.25 for 4.95; level 2 just suffices, 2.125 for 2.121. From 32 × 32
//! on, every node of 4 × 4 or more falls short: all levels but the last two. A ball at the corner of such a
//! patch is missed. Boxes of that half side hold flat patches along the axes on every level. They fail as
//! spheres do where the patch is turned by 45° in its plane, where it is stretched by more than (1 +
//! 2⁻ˡ)/(*n* − 1), 13 % for the root of 16 × 16, or where its corners' mean is far from its middle, as when
//! it is folded along a diagonal.
//!
//! # When each volume pays
//!
//! A ball of 4 spacings, a draped cloth of 256 × 256 particles, a core of a 2.8 GHz Xeon; a scan takes 25 µs.
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
//! For one ball, take spheres by the rest shape, at any size: a refit costs more than testing every particle.
//! Below about 64 × 64 particles a scan of all of them, eight at a time, is as fast, and simpler. A refit is
//! paid once a tick, a query once a collider. So from about one collider for every 600 particles on, AABBs by
//! `Refit` pay. Stretch counts as colliders do: what a search at rest radii visits grows with (1 + *s*)².
//! OBBs and k-DOPs fit closer than spheres do, but a node of theirs costs more to keep and to test than its
//! pruning saves here; they are for comparison and study. [`SearchMethod::Auto`] chooses by these figures.

mod bounds;
mod brute;
mod found;
mod method;
mod probe;
mod query;
mod refit;
mod rule;
mod scan;
mod stored;
#[cfg(test)]
mod tests;
mod tree;
mod volume;

pub use bounds::NodeBounds;
#[doc(hidden)]
pub use brute::brute_force;
#[doc(hidden)]
pub use method::SEARCH_FROM;
pub use method::{SearchMethod, SearchReason};
#[doc(hidden)]
pub use probe::{Core, Probe};
pub use query::{NodeState, TopDownQuery};
pub use rule::BoundRule;
pub use tree::{Node, QuadTree};
pub use volume::{BoundingVolume, KDop, NodeVolume, Obb};
