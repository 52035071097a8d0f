//! One tree over the bounds of all colliders, so that a cloth looks only at those around it.

use bevy::prelude::{Entity, Mat3, Resource, Vec3};
use parry3d::{
    bounding_volume::Aabb,
    partitioning::{Bvh, BvhBuildStrategy, BvhLeafUpdateStatus, BvhNode, BvhWorkspace},
};

use crate::hierarchy::Core;

/// Margin of a box against rounding of its corners and of the collider's points.
pub(super) const ROUNDING: f32 = 1.0e-5;

/// A leaf is stored larger than its collider by this part of its size, so that slow colliders change the tree only now
/// and then.
const MARGIN: f32 = 0.1;

/// Where fewer leaves than one in this many have changed, only the paths above them are refitted.
const FEW: usize = 8;

/// The tree is built anew after this many changes a leaf: leaves that have moved far from where they were make the nodes above
/// them large.
const MAX_CHANGES: usize = 16;

/// Colliders that reach beyond this (m) are kept aside, and read by each cloth. It is less than the largest reach of a
/// collider, so that the tree's sums of areas, of many boxes at once, stay finite.
const TREE_REACH: f32 = 1.0e9;

/// The bounds of all colliders. Kept from tick to tick: a collider that does not move costs nothing.
#[derive(Resource, Default)]
pub(crate) struct ColliderTree {
    tree: Bvh,
    workspace: BvhWorkspace,
    /// By the index of the entity, which is also what the tree knows a leaf by. As long as the highest index of a collider: 40 bytes for
    /// each, about what Bevy itself keeps of an entity.
    leaves: Vec<Leaf>,
    /// Colliders without a finite box.
    unbounded: Vec<Entity>,
    /// Leaves that have changed since the tree was brought up to date.
    changed: Vec<u32>,
    /// How many have changed since the tree was built.
    changes: usize,
    /// How many colliders there are.
    count: usize,
}

#[derive(Debug, Clone, Copy)]
struct Leaf {
    entity: Entity,
    bounds: Bounds,
    is_changed: bool,
}

/// The bounds of a collider along its whole path through the tick, in the world.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(crate) enum Bounds {
    /// Nothing: there is no collider.
    #[default]
    Absent,
    /// Everything.
    Unbounded,
    /// A box, from its lowest to its highest corner (m).
    Box([Vec3; 2]),
}

impl Bounds {
    /// A box around all points nearer than `radius` to a core (m).
    pub fn of_core(core: &Core, radius: f32) -> Self {
        let [low, high] = match *core {
            Core::Point(point) => [point; 2],
            Core::Segment([a, b]) => [a.min(b), a.max(b)],
            Core::Cuboid { pose, half_size } => {
                let axes = Mat3::from_quat(pose.rotation);
                let half = axes.x_axis.abs() * half_size.x
                    + axes.y_axis.abs() * half_size.y
                    + axes.z_axis.abs() * half_size.z;
                let centre = Vec3::from(pose.translation);
                [centre - half, centre + half]
            }
            Core::HalfSpace { .. } => return Self::Unbounded,
        };
        Self::around([low, high], radius)
    }

    /// A box that is larger by `reach` to each side (m), and by the effect of rounding.
    pub fn around([low, high]: [Vec3; 2], reach: f32) -> Self {
        let size = low.abs().max(high.abs()).max_element() + reach;
        let reach = Vec3::splat(reach + size * ROUNDING);
        Self::Box([low - reach, high + reach])
    }

    /// The smallest box around both.
    pub fn union(self, other: Self) -> Self {
        match (self, other) {
            (Self::Box(a), Self::Box(b)) => Self::Box([a[0].min(b[0]), a[1].max(b[1])]),
            (Self::Absent, some) | (some, Self::Absent) => some,
            _ => Self::Unbounded,
        }
    }

    /// A box as such, if it can be stored.
    fn checked(self) -> Self {
        let is_near = |corner: &Vec3| corner.abs().max_element() < TREE_REACH && corner.is_finite();
        match self {
            Self::Box(corners) if !corners.iter().all(is_near) => Self::Unbounded,
            _ => self,
        }
    }
}

impl ColliderTree {
    /// Whether there is no collider.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Takes over where a collider is.
    pub fn set(&mut self, entity: Entity, bounds: Bounds) {
        let bounds = bounds.checked();
        let index = entity.index_u32();
        let none = Leaf {
            entity: Entity::PLACEHOLDER,
            bounds: Bounds::Absent,
            is_changed: false,
        };
        if self.leaves.len() <= index as usize {
            self.leaves.resize(index as usize + 1, none);
        }
        let leaf = &mut self.leaves[index as usize];
        let before = leaf.bounds;
        (leaf.entity, leaf.bounds) = (entity, bounds);
        if before == bounds {
            return;
        }
        if matches!(bounds, Bounds::Box(_)) && !leaf.is_changed {
            leaf.is_changed = true;
            self.changed.push(index);
        }
        self.count += usize::from(bounds != Bounds::Absent);
        self.count -= usize::from(before != Bounds::Absent);
        match before {
            Bounds::Box(_) if !matches!(bounds, Bounds::Box(_)) => self.tree.remove(index),
            Bounds::Unbounded => self.unbounded.retain(|each| *each != entity),
            _ => {}
        }
        if bounds == Bounds::Unbounded {
            self.unbounded.push(entity);
        }
    }

    /// Forgets a collider.
    pub fn remove(&mut self, entity: Entity) {
        let leaf = self.leaves.get(entity.index_u32() as usize);
        if leaf.is_some_and(|leaf| leaf.entity == entity) {
            self.set(entity, Bounds::Absent);
        }
    }

    /// Brings the tree up to date, to be searched.
    pub fn refit(&mut self) {
        if self.changed.is_empty() {
            return;
        }
        let known = self.tree.leaf_count() as usize;
        let mut inserted = 0;
        for &index in &self.changed {
            let leaf = &mut self.leaves[index as usize];
            leaf.is_changed = false;
            let Bounds::Box([low, high]) = leaf.bounds else {
                continue;
            };
            let margin = MARGIN * low.distance(high);
            let status = self
                .tree
                .insert_or_update_partially(Aabb::new(low, high), index, margin);
            inserted += usize::from(status == BvhLeafUpdateStatus::Inserted);
            self.changes += usize::from(status != BvhLeafUpdateStatus::Unchanged);
        }
        if self.changed.len() * FEW < known {
            self.tree.refit_partial(&[], &self.changed);
        } else {
            self.tree.refit(&mut self.workspace);
        }
        self.changed.clear();
        let count = self.tree.leaf_count() as usize;
        if 2 * inserted > count || self.changes > MAX_CHANGES * count {
            self.tree
                .rebuild(&mut self.workspace, BvhBuildStrategy::Binned);
            self.changes = 0;
        }
    }

    /// The colliders that may be within `reach` of a point (m), and some that are a little farther: in no order.
    pub fn near(&self, point: Vec3, reach: f32) -> impl Iterator<Item = Entity> + '_ {
        let is_near = move |node: &BvhNode| {
            let offset = point - point.max(node.mins()).min(node.maxs());
            offset.length_squared() <= reach * reach
        };
        let bounded = self.tree.leaves(is_near);
        let bounded = bounded.filter_map(|leaf| Some(self.leaves.get(leaf as usize)?.entity));
        self.unbounded.iter().copied().chain(bounded)
    }
}

#[cfg(test)]
mod tests {
    use bevy::ecs::entity::EntityIndex;
    use proptest::prelude::*;

    use super::*;

    fn entity(index: u32) -> Entity {
        Entity::from_index(EntityIndex::from_raw_u32(index).expect("a small number"))
    }

    fn meets([low, high]: [Vec3; 2], point: Vec3, reach: f32) -> bool {
        let nearest = point.as_dvec3().clamp(low.as_dvec3(), high.as_dvec3());
        nearest.distance(point.as_dvec3()) <= f64::from(reach)
    }

    fn boxes() -> impl Strategy<Value = Bounds> {
        let place = prop::array::uniform3(-20.0_f32..20.0);
        let size = prop::array::uniform3(0.0_f32..3.0);
        prop_oneof![
            8 => (place, size).prop_map(|(place, size)| {
                let low = Vec3::from(place);
                Bounds::Box([low, low + Vec3::from(size)])
            }),
            1 => Just(Bounds::Absent),
            1 => Just(Bounds::Unbounded),
            1 => Just(Bounds::Box([Vec3::NAN, Vec3::NAN])),
            1 => Just(Bounds::Box([Vec3::splat(-1.0e30), Vec3::splat(1.0e30)])),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Whatever comes, moves and goes in whatever order: none that is near is missed, what is found exists, once.
        #[test]
        fn nothing_near_is_missed(
            ticks in prop::collection::vec(
                (
                    prop::collection::vec((0_u32..40, boxes()), 0..60),
                    prop::array::uniform3(-25.0_f32..25.0),
                    0.0_f32..10.0,
                ),
                1..30,
            ),
        ) {
            let mut tree = ColliderTree::default();
            let mut known = [Bounds::Absent; 40];
            for (changes, point, reach) in ticks {
                for (index, bounds) in changes {
                    if bounds == Bounds::Absent {
                        tree.remove(entity(index));
                    } else {
                        tree.set(entity(index), bounds);
                    }
                    known[index as usize] = bounds;
                }
                tree.refit();
                let point = Vec3::from(point);
                let mut found: Vec<Entity> = tree.near(point, reach).collect();
                found.sort_unstable();
                let all = found.len();
                found.dedup();
                prop_assert_eq!(found.len(), all, "each once");
                let mut count = 0;
                for (index, bounds) in known.into_iter().enumerate() {
                    let is_found = found.contains(&entity(index as u32));
                    count += usize::from(bounds != Bounds::Absent);
                    match bounds {
                        Bounds::Absent => prop_assert!(!is_found, "{index} is gone"),
                        Bounds::Box(corners) if corners[0].abs().max_element() < TREE_REACH => {
                            // The stored box is a tenth of its size larger to each side at most.
                            let loose = reach + 2.0 * MARGIN * corners[0].distance(corners[1]) + 1.0;
                            prop_assert!(is_found || !meets(corners, point, reach), "{index}");
                            prop_assert!(!is_found || meets(corners, point, loose), "{index}");
                        }
                        _ => prop_assert!(is_found, "{index}"),
                    }
                }
                prop_assert_eq!(tree.is_empty(), count == 0);
            }
        }
    }
}
