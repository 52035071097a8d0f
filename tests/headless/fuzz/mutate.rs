//! Writes into components as an inspector does, field by field.

use std::any::TypeId;

use bevy::{
    ecs::{component::ComponentId, reflect::AppTypeRegistry},
    prelude::*,
    reflect::{
        PartialReflect, ReflectMut, TypeInfo,
        enums::{DynamicEnum, DynamicVariant, VariantInfo},
    },
};
use bevy_drape::prelude::*;

use super::random::Random;

/// All layers but those of what nobody touches.
pub const OTHERS: u32 = u32::MAX >> 1;

/// Components that the plugin alone writes. A frame with an infinite rotation, put between two systems of a tick, makes that
/// cloth's own figures NaN for the tick. It harms nobody else, and no game does it.
fn is_result(id: TypeId) -> bool {
    let results = [
        TypeId::of::<ClothContacts>(),
        TypeId::of::<ClothFrame>(),
        TypeId::of::<ClothStats>(),
    ];
    results.contains(&id)
}

/// Which components of an entity are of the crate, known to reflection, and no results of a tick.
pub fn components(world: &World, entity: Entity) -> Vec<ReflectComponent> {
    let registry = world.resource::<AppTypeRegistry>().read();
    let entity = world.entity(entity);
    let archetype = entity.archetype();
    let known = archetype
        .components()
        .iter()
        .filter_map(|id: &ComponentId| {
            let info = world.components().get_info(*id)?;
            let registration = registry.get(info.type_id()?)?;
            let id = registration.type_id();
            // Particles are written by their own functions.
            let is_left_alone = is_result(id) || id == TypeId::of::<ClothParticles>();
            let path = registration.type_info().type_path();
            (path.starts_with("bevy_drape::") && !is_left_alone || path.ends_with("::Transform"))
                .then(|| registration.data::<ReflectComponent>().cloned())
                .flatten()
        });
    known.collect()
}

/// All of the crate's components that can be made from nothing, but for results of a tick. Resources are components of
/// entities of their own.
pub fn makers(world: &World) -> Vec<(ReflectComponent, ReflectDefault)> {
    let registry = world.resource::<AppTypeRegistry>().read();
    let mut all: Vec<_> = registry
        .iter()
        .filter(|of| of.type_info().type_path().starts_with("bevy_drape::"))
        .filter(|of| of.data::<ReflectResource>().is_none() && !is_result(of.type_id()))
        .filter_map(|of| {
            let component = of.data::<ReflectComponent>()?.clone();
            let default = of.data::<ReflectDefault>()?.clone();
            Some((of.type_info().type_path(), component, default))
        })
        .collect();
    // The registry's order is another in each run.
    all.sort_unstable_by_key(|(path, ..)| *path);
    all.into_iter()
        .map(|(_, component, default)| (component, default))
        .collect()
}

/// Writes one of the numbers, flags, lists or variants somewhere in a value, chosen at random on the way down.
pub fn mutate(value: &mut dyn PartialReflect, random: &mut Random) {
    if let Some(number) = value.try_downcast_mut::<f32>() {
        *number = random.number();
    } else if let Some(flag) = value.try_downcast_mut::<bool>() {
        *flag = !*flag;
    } else if let Some(count) = value.try_downcast_mut::<u32>() {
        *count = [0, 1, 2, 7, 16, 1_000, OTHERS][random.below(7)];
    } else if let Some(count) = value.try_downcast_mut::<usize>() {
        *count = [0, 1, 3, 40, usize::MAX][random.below(5)];
    } else if let Some(count) = value.try_downcast_mut::<i32>() {
        *count = random.next() as i32;
    } else if let Some(place) = value.try_downcast_mut::<Vec3>() {
        *place = random.vector();
    } else if let Some(turn) = value.try_downcast_mut::<Quat>() {
        *turn = Quat::from_xyzw(
            random.number(),
            random.number(),
            random.number(),
            random.number(),
        );
    } else {
        match value.reflect_mut() {
            ReflectMut::Struct(of) => {
                let index = random.below(of.field_len());
                if let Some(field) = of.field_at_mut(index) {
                    mutate(field, random);
                }
            }
            ReflectMut::TupleStruct(of) => {
                let index = random.below(of.field_len());
                if let Some(field) = of.field_mut(index) {
                    mutate(field, random);
                }
            }
            ReflectMut::Tuple(of) => {
                let index = random.below(of.field_len());
                if let Some(field) = of.field_mut(index) {
                    mutate(field, random);
                }
            }
            ReflectMut::List(of) => {
                let index = random.below(of.len());
                if random.one_in(4) && !of.is_empty() {
                    of.remove(index);
                } else if let Some(field) = of.get_mut(index) {
                    mutate(field, random);
                }
            }
            ReflectMut::Array(of) => {
                let index = random.below(of.len());
                if let Some(field) = of.get_mut(index) {
                    mutate(field, random);
                }
            }
            ReflectMut::Enum(of) => {
                let fields = of.field_len();
                if fields > 0 && !random.one_in(4) {
                    let index = random.below(fields);
                    if let Some(field) = of.field_at_mut(index) {
                        return mutate(field, random);
                    }
                }
                other_variant(value, random);
            }
            _ => {}
        }
    }
}

/// Has an enum be another of its variants without fields, if it has any.
fn other_variant(value: &mut dyn PartialReflect, random: &mut Random) {
    let Some(TypeInfo::Enum(info)) = value.get_represented_type_info() else {
        return;
    };
    let units: Vec<&str> = (info.iter())
        .filter_map(|variant| match variant {
            VariantInfo::Unit(unit) => Some(unit.name()),
            _ => None,
        })
        .collect();
    if let Some(name) = random.pick(&units) {
        let mut other = DynamicEnum::new(*name, DynamicVariant::Unit);
        other.set_represented_type(value.get_represented_type_info());
        value.apply(&other);
    }
}
