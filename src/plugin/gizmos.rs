//! Draws the bounding spheres, red where they touch and green where they don't, and the springs.

use std::ops::RangeInclusive;

use bevy::{
    app::{App, Plugin, PostUpdate},
    camera::visibility::{ViewVisibility, VisibilitySystems},
    color::{Color, Srgba},
    ecs::{
        component::Component,
        schedule::IntoScheduleConfigs,
        system::{Query, Res},
    },
    gizmos::{
        AppGizmoBuilder, GizmoPlugin,
        config::{GizmoConfigGroup, GizmoConfigStore},
        gizmos::Gizmos,
    },
    math::Isometry3d,
    reflect::{Reflect, std_traits::ReflectDefault},
    transform::TransformSystems,
};

use super::{ClothFrame, ClothSearch, ClothSystems, ClothTopology, components::ClothTick};
use crate::{
    cloth::{ClothParticles, SpringKind},
    hierarchy::NodeState,
};

/// How cloths' gizmos look. They show the last tick, whereas the mesh is drawn up to a tick behind it. A gizmo config
/// group: line width and depth are those of its `GizmoConfig`.
#[derive(GizmoConfigGroup, Reflect, Debug, Clone)]
#[reflect(Default, Debug, Clone)]
pub struct ClothGizmos {
    /// Draws the spheres of every cloth's finest level, those without a [`ShowClothGizmos`] too.
    pub draw_all: bool,
    /// Spheres that nothing touches.
    pub untouched: Color,
    /// Spheres that a ball touches, or may touch within the tick.
    pub touching: Color,
    /// Structural springs; shear and bend springs are drawn fainter.
    pub springs: Color,
    /// Line segments a circle.
    pub resolution: u32,
    /// Spheres are drawn with at least this radius, in spacings: a leaf's own is that of its particle, too
    /// small to see.
    pub smallest: f32,
}

impl Default for ClothGizmos {
    fn default() -> Self {
        Self {
            draw_all: false,
            untouched: Color::Srgba(Srgba::new(0.35, 0.95, 0.45, 1.0)),
            touching: Color::Srgba(Srgba::new(0.9, 0.05, 0.05, 1.0)),
            springs: Color::Srgba(Srgba::new(0.9, 0.8, 0.4, 0.6)),
            resolution: 16,
            smallest: 0.45,
        }
    }
}

/// Draws the gizmos of one visible cloth, as Bevy's `ShowAabbGizmo` does an entity's box.
#[derive(Component, Reflect, Debug, Clone, PartialEq, Eq)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct ShowClothGizmos {
    /// Levels of the tree whose spheres are drawn, 0 for the root; those deeper than the tree are its leaves'.
    /// `None` for no spheres.
    pub levels: Option<RangeInclusive<usize>>,
    /// Whether the springs are drawn.
    pub springs: bool,
}

impl Default for ShowClothGizmos {
    /// The spheres of the leaves.
    fn default() -> Self {
        Self::level(usize::MAX)
    }
}

impl ShowClothGizmos {
    /// The spheres of one level.
    pub fn level(level: usize) -> Self {
        Self::levels(level..=level)
    }

    /// The spheres of several levels.
    pub fn levels(levels: RangeInclusive<usize>) -> Self {
        Self {
            levels: Some(levels),
            springs: false,
        }
    }

    /// The springs and no spheres.
    pub fn springs() -> Self {
        Self {
            levels: None,
            springs: true,
        }
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

fn draw_cloths(
    cloths: Query<(
        &ClothTopology,
        &ClothParticles,
        &ClothSearch,
        &ClothFrame,
        Option<&ShowClothGizmos>,
        Option<&ViewVisibility>,
        &ClothTick,
    )>,
    store: Res<GizmoConfigStore>,
    mut gizmos: Gizmos<ClothGizmos>,
) {
    let look = store.config::<ClothGizmos>().1;
    let everywhere = look.draw_all.then(ShowClothGizmos::default);
    for (topology, particles, search, frame, show, visible, tick) in &cloths {
        if let Some(show) = show.or(everywhere.as_ref())
            && tick.sound
            && topology.fits(particles)
            && visible.is_none_or(|visible| visible.get())
        {
            draw_spheres(topology, particles, search, frame, show, look, &mut gizmos);
            if show.springs {
                draw_springs(topology, particles, frame, look, &mut gizmos);
            }
        }
    }
}

fn draw_spheres(
    topology: &ClothTopology,
    particles: &ClothParticles,
    search: &ClothSearch,
    frame: &ClothFrame,
    show: &ShowClothGizmos,
    look: &ClothGizmos,
    gizmos: &mut Gizmos<ClothGizmos>,
) {
    let (tree, states) = (&topology.tree, search.query.states());
    let (Some(levels), Some(leaves)) = (&show.levels, tree.levels().len().checked_sub(1)) else {
        return;
    };
    let smallest = look.smallest * topology.grid.spacing().min_element();
    for level in *levels.start().min(&leaves)..=*levels.end().min(&leaves) {
        for node in tree.levels()[level].clone() {
            let touching = states.get(node as usize) == Some(&NodeState::Touching);
            let color = if touching {
                look.touching
            } else {
                look.untouched
            };
            let sphere = search.bounds.sphere(tree, particles, node);
            let place = Isometry3d::new(
                frame.to_world(sphere.center.into()),
                frame.isometry().rotation,
            );
            gizmos
                .sphere(place, sphere.radius().max(smallest), color)
                .resolution(look.resolution);
        }
    }
}

fn draw_springs(
    topology: &ClothTopology,
    particles: &ClothParticles,
    frame: &ClothFrame,
    look: &ClothGizmos,
    gizmos: &mut Gizmos<ClothGizmos>,
) {
    use bevy::color::Alpha;
    topology.springs.for_each(|_, spring| {
        let color = match spring.kind {
            SpringKind::Structural => look.springs,
            SpringKind::Shear => look.springs.with_alpha(look.springs.alpha() * 0.5),
            SpringKind::Bend => look.springs.with_alpha(look.springs.alpha() * 0.25),
        };
        let [a, b] = spring.ends.map(|end| particles.position(end as usize));
        if let (Some(a), Some(b)) = (a, b) {
            gizmos.line(frame.to_world(a), frame.to_world(b), color);
        }
    });
}
