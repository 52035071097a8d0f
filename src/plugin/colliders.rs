//! How colliders move from tick to tick.

use bevy::{
    ecs::{
        component::Component,
        entity::Entity,
        entity_disabling::Disabled,
        hierarchy::{ChildOf, Children},
        lifecycle::{Remove, RemovedComponents},
        observer::On,
        query::{Allow, Changed, Or, With},
        system::{Commands, Local, Query, Res, ResMut, SystemParam},
    },
    math::{Isometry3d, Mat3, Vec3},
    time::Time,
    transform::{components::Transform, helper::TransformHelper},
};

use super::{
    ClothBody, ClothFault, ClothFrame,
    collider_tree::{Bounds, ColliderTree},
    frame::global_transform,
    naming::Part,
    source::{ColliderMeshes, Source},
};
use crate::{
    cloth::ClothError,
    contact::{ClothCollider, ColliderShape, MovingCollider},
    hierarchy::Core,
};

/// How much larger a box is made, against what its corners and the collider's points are rounded by.
const ROUNDING: f32 = 1.0e-5;

/// No collider is larger than this, nor farther from the world's origin (m): products of such lengths are finite.
const FARTHEST: f32 = 1.0e12;

/// A collider's way through the tick, in the world.
#[derive(Component, Debug, Default)]
pub(super) struct ColliderMotion {
    /// Its way; `None` before the first tick.
    way: Option<MovingCollider>,
    /// Where the last tick with time in it left it.
    last: Option<Isometry3d>,
    /// Middle of its way (m), and how far it is from there at most to any of the collider's points on it.
    middle: Vec3,
    reach: f32,
    /// Of a half-space that does not turn, its normal: what is far above it is not near.
    normal: Option<Vec3>,
    /// What holds it all along its way.
    bounds: Bounds,
    /// How many cloths pushed it in the last tick, if it is a body.
    cloths: u32,
    /// The shape and what it was built from, as a mesh of many triangles is built but once.
    built: Option<BuiltShape>,
}

/// A shape, and the collider and scale that it is of.
#[derive(Debug)]
struct BuiltShape {
    collider: ClothCollider,
    source: Option<Source>,
    scale: Vec3,
    shape: ColliderShape,
    offset: Isometry3d,
}

impl BuiltShape {
    fn is_of(&self, collider: &ClothCollider, source: Option<Source>, scale: Vec3) -> bool {
        // A scale that is read out of a rotating transform changes by rounding.
        self.collider == *collider
            && self.source == source
            && self.scale.abs_diff_eq(scale, 1.0e-5 * scale.length())
    }
}

/// A box around what is nearer than `radius` to a core (m).
fn bounds_of(core: &Core, radius: f32) -> Bounds {
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
        Core::HalfSpace { .. } => return Bounds::Unbounded,
    };
    around([low, high], radius)
}

/// A box that is larger by `reach` to each side (m), and by what rounding may do.
fn around([low, high]: [Vec3; 2], reach: f32) -> Bounds {
    let size = low.abs().max(high.abs()).max_element() + reach;
    let reach = Vec3::splat(reach + size * ROUNDING);
    Bounds::Box([low - reach, high + reach])
}

impl ColliderMotion {
    fn follow(
        &mut self,
        collider: &ClothCollider,
        body: Option<&ClothBody>,
        transforms: &TransformHelper,
        meshes: &ColliderMeshes,
        entity: Entity,
        time_passes: bool,
    ) -> Result<(), ClothError> {
        let transform = global_transform(transforms, entity)?;
        let (scale, rotation, translation) = transform.to_scale_rotation_translation();
        let known = self.built.as_ref().and_then(|built| built.source);
        let source = meshes.find(entity, collider, known)?;
        let is_built = self
            .built
            .as_ref()
            .is_some_and(|built| built.is_of(collider, source, scale));
        if !is_built {
            self.built = None;
            let made = meshes.resolve(collider, source)?;
            self.built = Some(BuiltShape {
                shape: made.scaled(scale)?,
                offset: made.offset(),
                collider: collider.clone(),
                source,
                scale,
            });
        }
        let Some(BuiltShape { shape, offset, .. }) = &self.built else {
            return Ok(());
        };
        // An infinite extent is a half-space's.
        let extent = shape.extent();
        if extent.is_finite() {
            let is_in_reach = |extent: f32| extent <= FARTHEST;
            ClothError::check(
                extent,
                is_in_reach,
                "the collider's size (m)",
                "at most 10¹²",
            )?;
        }
        let is_far = translation.abs().max_element() > FARTHEST;
        if is_far || !(translation.is_finite() && rotation.is_finite()) {
            return Err(ClothError::Transform {
                transform: format!("{transform:?}"),
            });
        }
        let pose = Isometry3d::new(translation, rotation.normalize()) * *offset;
        let translation = Vec3::from(pose.translation);
        let from = self.last.unwrap_or(pose);
        let turned = pose.rotation * from.rotation.inverse();
        // Of the two quaternions of a rotation, the one of the shorter way round.
        let turned = if turned.w < 0.0 { -turned } else { turned };
        let way = MovingCollider {
            shape: shape.clone(),
            from,
            to: translation,
            turn: turned.to_scaled_axis(),
            body: match body {
                Some(body) => Some(body.mass_at(pose.rotation)?.part_of(self.cloths)),
                None => None,
            },
        };
        self.middle = translation.midpoint(from.translation.into());
        self.reach = way.travel() / 2.0 + shape.extent();
        self.normal = None;
        if *shape == ColliderShape::HalfSpace && way.turn == Vec3::ZERO {
            self.reach = way.travel() / 2.0;
            self.normal = Some(pose.rotation * Vec3::Y);
        }
        self.bounds = self.bounds(&way);
        self.way = Some(way);
        // What is moved while no time passes has its way still before it.
        self.last = Some(if time_passes { pose } else { from });
        Ok(())
    }

    /// What holds it all along its way: two boxes where it does not turn, else the ball that its bounds are.
    fn bounds(&self, way: &MovingCollider) -> Bounds {
        if self.normal.is_some() || self.reach.is_infinite() {
            return Bounds::Unbounded;
        }
        if way.turn != Vec3::ZERO {
            return around([self.middle; 2], self.reach);
        }
        let [from, to] = [0.0, 1.0].map(|part| {
            let (core, radius) = way.shape.core(way.pose_at(part));
            bounds_of(&core, radius)
        });
        from.union(to)
    }

    /// Whether the next tick begins with another way, whether anyone moves the collider or not.
    fn is_moving(&self) -> bool {
        self.way
            .as_ref()
            .is_some_and(|way| way.turn != Vec3::ZERO || way.travel() > 0.0)
    }

    /// How many cloths are expected to push it: each has a part of its mass.
    pub fn cloths(&self) -> u32 {
        self.cloths.max(1)
    }

    /// Cloth has moved it, and so many cloths have pushed it. Its next way begins where it is now.
    pub fn pushed(&mut self, cloths: u32, moved: impl FnOnce(&mut Isometry3d)) {
        self.cloths = cloths;
        if let Some(last) = &mut self.last {
            moved(last);
        }
    }

    /// The mesh asset that its shape is made of.
    #[cfg(feature = "mesh")]
    pub fn source(&self) -> Option<Source> {
        self.built.as_ref()?.source
    }

    /// Whether the collider may come within `reach` of a point of the world (m).
    pub fn comes_near(&self, point: Vec3, reach: f32) -> bool {
        let offset = point - self.middle;
        if let Some(normal) = self.normal {
            return normal.dot(offset) <= self.reach + reach + offset.length() * ROUNDING;
        }
        let is_in_ball = offset.length_squared() <= (self.reach + reach) * (self.reach + reach);
        let is_at_box = match self.bounds {
            Bounds::Absent => false,
            Bounds::Unbounded => true,
            Bounds::Box([low, high]) => {
                let offset = point - point.max(low).min(high);
                offset.length_squared() <= reach * reach
            }
        };
        is_at_box && is_in_ball
    }

    /// The collider's way through the tick in a cloth's frame.
    pub fn seen_from(&self, frame: &ClothFrame) -> Option<MovingCollider> {
        let way = self.way.as_ref()?;
        let inverse = frame.isometry().inverse();
        Some(MovingCollider {
            shape: way.shape.clone(),
            from: inverse * way.from,
            to: inverse * way.to,
            turn: inverse.rotation * way.turn,
            body: way.body.map(|body| body.turned(inverse.rotation)),
        })
    }
}

/// What a collider is read from. Disabled ones are followed too: whoever enables one again finds it where it is.
type Reading = (
    &'static ClothCollider,
    &'static mut ColliderMotion,
    Option<&'static ClothBody>,
    Option<&'static ClothFault>,
);

/// Where a collider's own components have changed.
type OwnChange = (
    With<ColliderMotion>,
    Or<(Changed<Transform>, Changed<ClothCollider>, Changed<ChildOf>)>,
    Allow<Disabled>,
);

/// Entities that others are children of.
type ParentChange = (
    With<Children>,
    Or<(Changed<Transform>, Changed<ChildOf>)>,
    Allow<Disabled>,
);

/// What tells which colliders have moved.
#[derive(SystemParam)]
pub(super) struct Changes<'w, 's> {
    own: Query<'w, 's, Entity, OwnChange>,
    bodies: Query<'w, 's, Entity, (With<ColliderMotion>, With<ClothBody>, Allow<Disabled>)>,
    unbodied: RemovedComponents<'w, 's, ClothBody>,
    parents: Query<'w, 's, Entity, ParentChange>,
    children: Query<'w, 's, &'static Children, Allow<Disabled>>,
    unparented: RemovedComponents<'w, 's, ChildOf>,
    unplaced: RemovedComponents<'w, 's, Transform>,
}

/// The colliders to be looked at in a tick.
#[derive(Debug, Default)]
pub(super) struct Awaited {
    /// Those to look at now, each once.
    now: Vec<Entity>,
    /// Those on their way: in the next tick they may have arrived.
    moving: Vec<Entity>,
    /// Whose children are to be looked at.
    stack: Vec<Entity>,
}

impl Awaited {
    /// Those that moved in the last tick, or of which anything has changed since, their ancestors included.
    fn find(&mut self, changes: &mut Changes) {
        self.now.clear();
        self.now.append(&mut self.moving);
        self.now.extend(&changes.own);
        self.now.extend(&changes.bodies);
        self.now.extend(changes.unbodied.read());
        self.stack.clear();
        self.stack.extend(&changes.parents);
        self.stack.extend(changes.unplaced.read());
        for entity in changes.unparented.read() {
            self.now.push(entity);
            self.stack.push(entity);
        }
        // Below what has changed; what no longer exists has no children.
        while let Some(parent) = self.stack.pop() {
            if let Ok(children) = changes.children.get(parent) {
                self.now.extend(children);
                self.stack.extend(children);
            }
        }
        self.now.sort_unstable();
        self.now.dedup();
    }
}

/// Follows the colliders that move, and notes where they are.
pub(super) fn prepare_colliders(
    mut awaited: Local<Awaited>,
    mut changes: Changes,
    mut colliders: Query<Reading, Allow<Disabled>>,
    mut tree: ResMut<ColliderTree>,
    transforms: TransformHelper,
    meshes: ColliderMeshes,
    time: Res<Time>,
    mut commands: Commands,
) {
    awaited.find(&mut changes);
    let time_passes = time.delta_secs() > 0.0;
    let Awaited { now, moving, .. } = &mut *awaited;
    for &entity in now.iter() {
        let Ok((collider, mut motion, body, fault)) = colliders.get_mut(entity) else {
            continue;
        };
        let outcome = motion.follow(collider, body, &transforms, &meshes, entity, time_passes);
        if outcome.is_err() {
            *motion = ColliderMotion::default();
        }
        tree.set(entity, motion.bounds);
        // What is made of an asset has to be there, and may become another.
        if motion.is_moving() || matches!(collider, ClothCollider::Mesh(_)) {
            moving.push(entity);
        }
        // What is on its way is no fault.
        let outcome = match outcome {
            Err(ClothError::MeshLoading) => Ok(()),
            outcome => outcome,
        };
        ClothFault::report(&mut commands, entity, fault, Part::Collider, outcome);
    }
}

/// What is no collider any more is not searched for.
pub(super) fn forget_collider(removed: On<Remove, ColliderMotion>, mut tree: ResMut<ColliderTree>) {
    tree.remove(removed.entity);
}
