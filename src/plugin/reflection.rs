//! Registration of components with lists, as scenes and inspectors apply them.

use bevy::{
    ecs::{component::Mutable, reflect::ReflectComponentFns},
    prelude::{
        App, AppTypeRegistry, Component, FromReflect, PartialReflect, ReflectComponent, TypePath,
    },
    reflect::{GetTypeRegistration, ReflectMut, ReflectRef},
};

/// Registers a component whose lists are cut to the length of the lists that are applied to them. Bevy keeps the
/// surplus of a longer list: a scene that pins nothing would leave the top row pinned, wherever it names the pins after
/// the cloth.
pub(crate) fn register_with_lists<C>(app: &mut App)
where
    C: Component<Mutability = Mutable> + FromReflect + TypePath + GetTypeRegistration + Clone,
{
    app.register_type::<C>();
    let mut functions = ReflectComponentFns::new::<C>();
    functions.apply = |mut entity, value| {
        if let Some(mut component) = entity.get_mut::<C>() {
            apply(&mut *component, value);
        }
    };
    functions.apply_or_insert_mapped = |entity, value, registry, mut mapper, hooks| {
        if let Some(mut component) = entity.get_mut::<C>() {
            apply(&mut *component, value);
            C::map_entities(&mut component, &mut mapper);
        } else {
            let own = ReflectComponentFns::new::<C>();
            (own.apply_or_insert_mapped)(entity, value, registry, mapper, hooks);
        }
    };
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let mut registry = registry.write();
    if let Some(registration) = registry.get_mut(std::any::TypeId::of::<C>()) {
        registration.insert(ReflectComponent::new(functions));
    }
}

/// Applies a value, and takes its lists whole.
fn apply<C: FromReflect + Clone>(component: &mut C, value: &dyn PartialReflect) {
    if let Some(own) = value.try_downcast_ref::<C>() {
        // A closure, which can't be reflected.
        *component = own.clone();
        return;
    }
    shorten(component, value);
    component.apply(value);
}

/// Cuts each list to the length of that of a value.
fn shorten(own: &mut dyn PartialReflect, value: &dyn PartialReflect) {
    match (own.reflect_mut(), value.reflect_ref()) {
        (ReflectMut::List(own), ReflectRef::List(value)) => {
            while own.len() > value.len() {
                own.pop();
            }
            for (index, value) in value.iter().enumerate() {
                shorten_at(own.get_mut(index), Some(value));
            }
        }
        (ReflectMut::Struct(own), ReflectRef::Struct(value)) => {
            for index in 0..value.field_len() {
                let own = value.name_at(index).and_then(|name| own.field_mut(name));
                shorten_at(own, value.field_at(index));
            }
        }
        (ReflectMut::TupleStruct(own), ReflectRef::TupleStruct(value)) => {
            for index in 0..value.field_len() {
                shorten_at(own.field_mut(index), value.field(index));
            }
        }
        (ReflectMut::Tuple(own), ReflectRef::Tuple(value)) => {
            for index in 0..value.field_len() {
                shorten_at(own.field_mut(index), value.field(index));
            }
        }
        (ReflectMut::Enum(own), ReflectRef::Enum(value))
            if own.variant_name() == value.variant_name() =>
        {
            for index in 0..value.field_len() {
                let (own, value) = match value.name_at(index) {
                    Some(name) => (own.field_mut(name), value.field(name)),
                    None => (own.field_at_mut(index), value.field_at(index)),
                };
                shorten_at(own, value);
            }
        }
        _ => {}
    }
}

fn shorten_at(own: Option<&mut dyn PartialReflect>, value: Option<&dyn PartialReflect>) {
    if let (Some(own), Some(value)) = (own, value) {
        shorten(own, value);
    }
}
