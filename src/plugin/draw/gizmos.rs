//! Draws the bounding volumes, red where they touch and green where they don't, and the springs.

use std::ops::RangeInclusive;

use bevy::{
    camera::visibility::VisibilitySystems,
    ecs::query::QueryData,
    gizmos::{
        AppGizmoBuilder, GizmoPlugin,
        config::{GizmoConfigGroup, GizmoConfigStore},
        gizmos::Gizmos,
    },
    prelude::{
        App, Color, Component, IntoScheduleConfigs, Isometry3d, Local, Plugin, PostUpdate, Quat,
        Query, Rect, Reflect, ReflectComponent, ReflectDefault, Res, Srgba, Transform,
        TransformSystems, Vec3, ViewVisibility,
    },
};

use crate::{
    cloth::{ClothParticles, SpringKind, Surface},
    hierarchy::{
        BoundRule, BoundingVolume, NodeBounds, NodeState, NodeVolume, SearchMethod, TopDownQuery,
    },
    plugin::{
        frame::ClothFrame,
        sets::ClothSystems,
        state::{ClothBuilt, ClothScratch, ClothSearch, ClothState, ClothStats},
    },
};

/// The look of the gizmos of cloths: a gizmo config group, whose `GizmoConfig` sets line width and depth. Gizmos show
/// the last tick, whereas the mesh is drawn up to a tick behind it.
#[derive(GizmoConfigGroup, Reflect, Debug, Clone)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug, Clone)]
pub struct ClothGizmos {
    /// Draws the finest level's volumes of every cloth, even without a [`ShowClothGizmos`].
    pub draw_all: bool,
    /// Volumes that the search did not reach, because nothing touches a volume above them.
    pub unvisited: Color,
    /// Volumes that the search visited and nothing touches: everything below them was pruned.
    pub untouched: Color,
    /// Volumes that a collider touches, or may touch within the tick.
    pub touching: Color,
    /// Structural springs; shear and bend springs are drawn fainter.
    pub springs: Color,
    /// Line segments per circle.
    pub resolution: u32,
    /// Smallest radius with which leaves are drawn, in spacings. Their own radius is that of a particle, too small to
    /// see.
    pub smallest: f32,
}

impl Default for ClothGizmos {
    fn default() -> Self {
        Self {
            draw_all: false,
            unvisited: Color::Srgba(Srgba::new(0.3, 0.75, 0.4, 0.35)),
            untouched: Color::Srgba(Srgba::new(0.35, 0.95, 0.45, 1.0)),
            touching: Color::Srgba(Srgba::new(0.9, 0.05, 0.05, 1.0)),
            springs: Color::Srgba(Srgba::new(0.9, 0.8, 0.4, 0.6)),
            resolution: 16,
            smallest: 0.45,
        }
    }
}

/// Draws the gizmos of one visible cloth, as Bevy's `ShowAabbGizmo` draws the bounding box of an entity.
///
/// Volumes on one half of the cloth, and the other half as it looks in the game:
///
/// ```
/// use bevy::math::Rect;
/// use bevy_drape::prelude::*;
///
/// let right_half = ShowClothGizmos::level(4).within(Rect::new(0.5, 0.0, 1.0, 1.0));
/// # assert_eq!(right_half.region.min.x, 0.5);
/// ```
#[derive(Component, Reflect, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ShowClothGizmos {
    /// The first and the last level of the tree whose volumes are drawn, 0 for the root. Levels deeper than the tree
    /// are its leaves. `None` draws no volumes. The cloth's [`SearchMethod`] decides which kind of volume is drawn, by
    /// default spheres.
    pub levels: Option<[usize; 2]>,
    /// Whether the springs are drawn.
    pub springs: bool,
    /// The part of the cloth that is drawn, in the UV coordinates of its mesh; by default all of it. On a grid they go
    /// from (0, 0), at particle 0, to (1, 1). A mesh without UVs is drawn whole. A volume is drawn if the middle of its
    /// patch is inside, a spring if both its ends are.
    pub region: Rect,
}

impl Default for ShowClothGizmos {
    /// The volumes of the leaves.
    fn default() -> Self {
        Self::level(usize::MAX)
    }
}

impl ShowClothGizmos {
    /// The volumes of one level.
    pub fn level(level: usize) -> Self {
        Self::levels(level..=level)
    }

    /// The volumes of several levels.
    pub fn levels(levels: RangeInclusive<usize>) -> Self {
        Self {
            levels: Some([*levels.start(), *levels.end()]),
            ..Self::nothing()
        }
    }

    /// The springs and no volumes.
    pub fn springs() -> Self {
        Self {
            springs: true,
            ..Self::nothing()
        }
    }

    /// Neither volumes nor springs, for a key or a panel to switch on later.
    pub fn nothing() -> Self {
        Self {
            levels: None,
            springs: false,
            region: Rect::new(0.0, 0.0, 1.0, 1.0),
        }
    }

    /// Draws only this [`region`](Self::region), in UV coordinates.
    pub fn within(mut self, region: Rect) -> Self {
        self.region = region;
        self
    }

    /// Whether a particle lies in the region.
    fn contains(&self, surface: &Surface, particle: u32) -> bool {
        let place = surface.uvs().get(particle as usize);
        place.is_none_or(|place| self.region.contains(*place))
    }
}

/// Draws the gizmos of cloths with a [`ShowClothGizmos`]. Does nothing in an app without Bevy's `GizmoPlugin`.
#[derive(Debug, Default, Clone, Copy)]
pub struct ClothGizmosPlugin;

impl Plugin for ClothGizmosPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<ShowClothGizmos>();
    }

    fn finish(&self, app: &mut App) {
        if app.is_plugin_added::<GizmoPlugin>() {
            app.init_gizmo_group::<ClothGizmos>().add_systems(
                PostUpdate,
                draw_cloths
                    .after(TransformSystems::Propagate)
                    .after(VisibilitySystems::MarkNewlyHiddenEntitiesInvisible)
                    .after(ClothSystems::WriteBack),
            );
        }
    }
}

/// Volumes and a search of the gizmos' own, kept from frame to frame: the tick's search may have touched no volume at
/// all.
#[derive(Default)]
struct GizmoMemory {
    bounds: NodeBounds,
    query: TopDownQuery,
    states: Vec<NodeState>,
}

#[derive(QueryData)]
struct Drawn {
    built: &'static ClothBuilt,
    particles: &'static ClothParticles,
    frame: &'static ClothFrame,
    search: &'static ClothSearch,
    show: Option<&'static ShowClothGizmos>,
    visible: Option<&'static ViewVisibility>,
    state: &'static ClothState,
    scratch: &'static ClothScratch,
    stats: &'static ClothStats,
}

fn draw_cloths(
    cloths: Query<Drawn>,
    store: Res<GizmoConfigStore>,
    mut drawing: Local<GizmoMemory>,
    mut gizmos: Gizmos<ClothGizmos>,
) {
    let look = store.config::<ClothGizmos>().1;
    let everywhere = look.draw_all.then(ShowClothGizmos::default);
    for cloth in &cloths {
        if let Some(show) = cloth.show.or(everywhere.as_ref())
            && cloth.state.is_valid
            && cloth.built.matches(cloth.particles)
            && cloth.visible.is_none_or(|visible| visible.get())
        {
            if let Some(levels) = show.levels {
                drawing.search(&cloth);
                drawing.draw(&cloth, show, levels, look, &mut gizmos);
            }
            if show.springs {
                draw_springs(&cloth, show, look, &mut gizmos);
            }
        }
    }
}

impl GizmoMemory {
    /// Finds the current place of each volume, and whether it was visited or touched.
    fn search(&mut self, cloth: &DrawnItem) {
        let (tree, surface) = (cloth.built.tree(), cloth.built.surface());
        let scratch = cloth.scratch;
        let choice = match (scratch.search, cloth.stats.search) {
            (SearchMethod::Tree(volume, rule), _) | (_, SearchMethod::Tree(volume, rule)) => {
                (volume, rule)
            }
            _ => (BoundingVolume::Sphere, BoundRule::RestShape),
        };
        let stretch = cloth.state.stretch.bound;
        let rebuilt = (self.bounds).rebuild(choice, tree, cloth.particles, stretch);
        if rebuilt.is_err() {
            return;
        }
        if matches!(cloth.stats.search, SearchMethod::Tree(..)) {
            cloth.search.query.states_into(tree, &mut self.states);
            return;
        }
        // Where nothing was searched, or all particles were scanned: the result that a search would have.
        self.query.clear();
        let root = tree.root_sphere(cloth.particles, stretch);
        for (_, collider) in &scratch.near {
            let (detection, settings) = (&scratch.detection, &scratch.contact_settings);
            let (probe, _) = detection.probe(collider, settings, surface, 0.0, &root);
            (self.query).search(tree, &self.bounds, cloth.particles, &probe);
        }
        self.query.states_into(tree, &mut self.states);
    }

    fn draw(
        &self,
        cloth: &DrawnItem,
        show: &ShowClothGizmos,
        [first, last]: [usize; 2],
        look: &ClothGizmos,
        gizmos: &mut Gizmos<ClothGizmos>,
    ) {
        let (tree, surface) = (cloth.built.tree(), cloth.built.surface());
        let Some(leaves) = tree.levels().len().checked_sub(1) else {
            return;
        };
        let radius = cloth.scratch.contact_settings.particle_radius;
        let smallest = look.smallest * surface.spacing().typical;
        for level in first.min(leaves)..=last.min(leaves) {
            let least = if level == leaves { smallest } else { radius };
            let radius = radius.max(least);
            for node in tree.levels()[level].clone() {
                if !show.contains(surface, tree.node(node).middle) {
                    continue;
                }
                let color = match self.states.get(node as usize) {
                    Some(NodeState::Touching) => look.touching,
                    Some(NodeState::Untouched) => look.untouched,
                    Some(NodeState::Unvisited) | None => look.unvisited,
                };
                let volume = self.bounds.node(tree, cloth.particles, node, radius);
                let frame = cloth.frame.isometry();
                draw_volume(&volume, frame, color, look.resolution, gizmos);
            }
        }
    }
}

/// Draws each volume in its own shape.
fn draw_volume(
    volume: &NodeVolume,
    frame: Isometry3d,
    color: Color,
    resolution: u32,
    gizmos: &mut Gizmos<ClothGizmos>,
) {
    let mut draw_box = |pose: Isometry3d, size: Vec3| {
        let pose = frame * pose;
        let transform = Transform::from_isometry(pose).with_scale(size);
        gizmos.cube(transform, color);
    };
    match volume {
        // In a cloth of several pieces, a volume from the rest shape does not enclose all of them.
        NodeVolume::Sphere(sphere) if !sphere.radius().is_finite() => {}
        NodeVolume::Aabb(aabb) if !aabb.max.is_finite() => {}
        NodeVolume::Sphere(sphere) => {
            let place = frame * Isometry3d::from_translation(sphere.center);
            gizmos
                .sphere(place, sphere.radius(), color)
                .resolution(resolution);
        }
        NodeVolume::Aabb(aabb) => {
            let middle = Isometry3d::from_translation(aabb.min.midpoint(aabb.max));
            draw_box(middle, Vec3::from(aabb.max - aabb.min));
        }
        NodeVolume::Obb(obb) => {
            let rotation = Quat::from_mat3(&obb.axes);
            draw_box(Isometry3d::new(obb.centre, rotation), 2.0 * obb.half_size);
        }
        other => {
            for face in other.faces() {
                let corners = face.iter().chain(face.first());
                gizmos.linestrip(corners.map(|&corner| frame * corner), color);
            }
        }
    }
}

fn draw_springs(
    cloth: &DrawnItem,
    show: &ShowClothGizmos,
    look: &ClothGizmos,
    gizmos: &mut Gizmos<ClothGizmos>,
) {
    use bevy::color::Alpha;
    let (springs, surface) = (cloth.built.springs(), cloth.built.surface());
    springs.for_each(|_, spring| {
        if !spring.ends.iter().all(|&end| show.contains(surface, end)) {
            return;
        }
        let color = match spring.kind {
            SpringKind::Structural => look.springs,
            SpringKind::Shear => look.springs.with_alpha(look.springs.alpha() * 0.5),
            SpringKind::Bend => look.springs.with_alpha(look.springs.alpha() * 0.25),
        };
        let places = (spring.ends).map(|end| cloth.particles.position(end as usize));
        if let [Some(a), Some(b)] = places {
            gizmos.line(cloth.frame.to_world(a), cloth.frame.to_world(b), color);
        }
    });
}
