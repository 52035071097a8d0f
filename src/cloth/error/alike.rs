//! Which errors are alike, and what they name.

use bevy::{
    ecs::entity::{EntityMapper, MapEntities},
    reflect::{PartialReflect, enums::Enum},
};

use super::{ClothError, TargetError, TransformError};
use crate::cloth::{
    grid::GridError,
    quantity::QuantityError,
    skin::{PaintError, SkinError},
    surface::MeshError,
};

impl MapEntities for ClothError {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        match self {
            Self::Target(
                TargetError::NoTarget { target: entity, .. }
                | TargetError::NoSuchCloth { cloth: entity },
            )
            | Self::Transform(TransformError::Missing { entity, .. })
            | Self::Skin(SkinError::Joint { entity, .. }) => {
                *entity = mapper.get_mapped(*entity);
            }
            _ => {}
        }
    }
}

impl ClothError {
    /// The number that is out of its range, whichever module found it.
    pub fn quantity(&self) -> Option<&QuantityError> {
        match self {
            Self::Quantity(error)
            | Self::Grid(GridError::Quantity(error))
            | Self::Mesh(MeshError::Quantity(error))
            | Self::Paint(PaintError::Quantity(error)) => Some(error),
            _ => None,
        }
    }

    /// Whether `other` is at fault in the same place, whatever the value.
    pub(crate) fn is_same_fault(&self, other: &Self) -> bool {
        if let Self::Target(TargetError::NoTarget { .. }) = self {
            return self == other;
        }
        let name = |error: &Self| error.quantity().map(|number| number.quantity);
        name(self) == name(other) && self.kind() == other.kind()
    }

    /// The names of the variant and of the one in it.
    fn kind(&self) -> (&str, Option<&str>) {
        let inner = self.field_at(0).map(PartialReflect::reflect_ref);
        let inner = inner.and_then(|inner| inner.as_enum().ok());
        (self.variant_name(), inner.map(Enum::variant_name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_tell_no_faults_apart() {
        let small = |columns| ClothError::from(GridError::TooSmall { columns, rows: 1 });
        assert!(small(0).is_same_fault(&small(1)));
        assert!(!small(0).is_same_fault(&GridError::NotAGrid.into()));
        assert!(!small(0).is_same_fault(&MeshError::Loading.into()));
        let number = |quantity, value| {
            let error = crate::cloth::Allowed(|_| false, "more").check(quantity, [value]);
            ClothError::from(error.expect_err("out of range"))
        };
        assert!(number("mass", 0.0).is_same_fault(&number("mass", 1.0)));
        assert!(!number("mass", 0.0).is_same_fault(&number("length", 0.0)));
    }
}
