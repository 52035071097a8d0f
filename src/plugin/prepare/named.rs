//! Finds the entities that attachments and seams name.

use std::iter;

use bevy::{
    ecs::{entity_disabling::Disabled, query::QueryFilter, system::SystemParam},
    math::Affine3A,
    prelude::{Allow, ChildOf, Entity, GlobalTransform, Name, Query, TransformHelper},
};

use crate::{
    cloth::{ClothError, Surface, TargetError},
    plugin::{
        authoring::{ClothAttachment, ClothTarget},
        frame::Places,
    },
};

/// Names of the entities that pass `F`, and the hierarchy.
#[derive(SystemParam)]
pub(crate) struct NamedTargets<'w, 's, F: QueryFilter + Send + Sync + 'static> {
    names: Query<'w, 's, (Entity, &'static Name), F>,
    /// Also of what is disabled for a while.
    known: Query<'w, 's, &'static Name, (F, Allow<Disabled>)>,
    parents: Query<'w, 's, &'static ChildOf, Allow<Disabled>>,
}

impl<F: QueryFilter + Send + Sync + 'static> NamedTargets<'_, '_, F> {
    /// The entity that `target` names, as seen from the entity `from`. A `known` one stays while it has the name. Of others
    /// for which `exists` holds, it is the one with the nearest common ancestor. Among equals it is the one with the lowest generation and index.
    ///
    /// # Errors
    /// [`TargetError::NoTargetNamed`], with the text of a pin.
    pub fn find(
        &self,
        target: &ClothTarget,
        from: Entity,
        known: Option<Entity>,
        exists: impl Fn(Entity) -> bool,
        pin: impl Fn() -> String,
    ) -> Result<Entity, TargetError> {
        let name = match target {
            ClothTarget::Entity(entity) => return Ok(*entity),
            ClothTarget::Named(name) => name,
        };
        let is_so_called =
            |entity: &Entity| (self.known.get(*entity)).is_ok_and(|its| its.as_str() == name);
        let find = || {
            let called = self.names.iter().filter(|(_, its)| its.as_str() == name);
            called
                .map(|(entity, _)| entity)
                .filter(|entity| exists(*entity))
                .min_by_key(|entity| {
                    let steps = self.steps_up(from, *entity).unwrap_or(usize::MAX);
                    (steps, entity.generation().to_bits(), entity.index_u32())
                })
        };
        known
            .filter(is_so_called)
            .or_else(find)
            .ok_or_else(|| TargetError::NoTargetNamed {
                pin: pin(),
                name: name.clone(),
            })
    }

    /// How far above `from` the first entity is that is `to`, or above it. 0 is `from` itself.
    fn steps_up(&self, from: Entity, to: Entity) -> Option<usize> {
        let line = |of: Entity| iter::once(of).chain(self.parents.iter_ancestors(of));
        line(from).position(|above| line(to).any(|of| of == above))
    }
}

/// Transforms and names of entities.
#[derive(SystemParam)]
pub(crate) struct Targets<'w, 's> {
    transforms: TransformHelper<'w, 's>,
    /// Where cloths are, also below what is disabled.
    pub cloths: Places<'w, 's>,
    named: NamedTargets<'w, 's, ()>,
}

impl Targets<'_, '_> {
    /// An entity's global transform as of now, not as of the last frame, if it and all above it have one.
    pub fn place(&self, entity: Entity) -> Option<GlobalTransform> {
        self.transforms.compute_global_transform(entity).ok()
    }

    /// Finds the places of the targets of a cloth's attachments; `known` are the attachments of the last tick.
    ///
    /// # Errors
    /// [`TargetError::NoTarget`] for a target that does not exist, has no transform, or is scaled to zero;
    /// [`TargetError::NoTargetNamed`]; or the error of a pin.
    pub fn find(
        &self,
        cloth: Entity,
        attachments: &[ClothAttachment],
        known: &[ClothAttachment],
        surface: &Surface,
        entities: &mut Vec<Entity>,
        places: &mut Vec<Affine3A>,
    ) -> Result<(), ClothError> {
        places.clear();
        // Known attachments were valid.
        if attachments != known {
            attachments
                .iter()
                .try_for_each(|each| each.pin.validate(surface))?;
        }
        for (index, attachment) in attachments.iter().enumerate() {
            let known = entities.get(index).copied();
            let exists = |entity| self.place(entity).is_some();
            let pin = || format!("{:?}", attachment.pin);
            let target = (self.named).find(&attachment.target, cloth, known, exists, pin)?;
            let affine = self.place(target).map(|place| place.affine());
            let place = affine.filter(|affine| affine.inverse().is_finite());
            places.push(place.ok_or_else(|| TargetError::NoTarget { pin: pin(), target })?);
            if index < entities.len() {
                entities[index] = target;
            } else {
                entities.push(target);
            }
        }
        entities.truncate(attachments.len());
        Ok(())
    }
}
