//! Values for each particle.

use bevy::{
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
};
use thiserror::Error;

use crate::cloth::{
    function::define_function,
    quantity::{Allowed, QuantityError},
    surface::{Surface, VertexAttribute},
};

/// A value for each particle of a cloth: uniform, painted by an artist, or computed by code.
///
/// ```
/// use bevy_drape::prelude::*;
///
/// let all = ClothPaint::from(0.2);
/// // Full red moves by up to half a metre; particles without red are held.
/// let red = ClothPaint::color(0, 0.5);
/// let code = ClothPaint::at_rest(|place| (1.4 - place.y).max(0.0));
/// # let _ = (all, red, code);
/// ```
#[derive(Reflect, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ClothPaint {
    /// One value for all particles.
    Uniform(f32),
    /// A vertex attribute times a scale. A particle of several vertices takes their largest value.
    Attribute {
        /// The name of the attribute, as in [`Pin::Attribute`](crate::cloth::Pin::Attribute).
        name: String,
        /// The channel, from 0.
        channel: usize,
        /// The factor for its values.
        scale: f32,
    },
    /// A function of the position at rest. Closures cannot be serialized: loaded from a scene file, it returns 0.
    AtRest(#[reflect(ignore)] RestFunction),
    /// One value for each vertex of the mesh, or for each particle of a grid. A particle of several vertices takes
    /// their largest value.
    Vertices(Vec<f32>),
}

define_function! {
    /// A function of a particle's position at rest, in the entity's frame (m), before the transform's scale. The default
    /// returns 0.
    RestFunction,
    /// Wraps a function of the position at rest.
    of(place: Vec3) -> f32, 0.0
}

impl Default for ClothPaint {
    /// 0 for all.
    fn default() -> Self {
        Self::Uniform(0.0)
    }
}

impl From<f32> for ClothPaint {
    fn from(value: f32) -> Self {
        Self::Uniform(value)
    }
}

/// The reason why a paint gives no values.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[type_path = "bevy_drape"]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum PaintError {
    /// A paint names a vertex attribute or a channel that does not exist.
    #[error("no channel {channel} of a vertex attribute \"{name}\"; the cloth has: {attributes}")]
    NoSuchChannel {
        /// The name of the attribute.
        name: String,
        /// The channel, from 0.
        channel: usize,
        /// The names of the cloth's attributes.
        attributes: String,
    },
    /// A paint does not have one value for each vertex.
    #[error("{found} values were given for {expected} vertices: give one for each vertex")]
    Count {
        /// Number of vertices.
        expected: usize,
        /// Number of values.
        found: usize,
    },
    /// A value is out of range.
    #[error(transparent)]
    Quantity(#[from] QuantityError),
}

impl ClothPaint {
    /// A channel of the vertex colours times a scale: 0 for red, 3 for alpha.
    pub fn color(channel: usize, scale: f32) -> Self {
        Self::attribute("Vertex_Color", channel, scale)
    }

    /// A channel of a vertex attribute, from 0, times a scale.
    pub fn attribute(name: impl Into<String>, channel: usize, scale: f32) -> Self {
        Self::Attribute {
            name: name.into(),
            channel,
            scale,
        }
    }

    /// A function of each particle's position at rest, in the entity's frame (m), before the transform's scale.
    pub fn at_rest(of: impl Fn(Vec3) -> f32 + Send + Sync + 'static) -> Self {
        Self::AtRest(RestFunction::new(of))
    }

    /// One value for each vertex of the mesh, or for each particle of a grid.
    pub fn vertices(values: impl IntoIterator<Item = f32>) -> Self {
        Self::Vertices(values.into_iter().collect())
    }

    /// The value of each particle of `surface`, none of them NaN or negative. Errors name them by `quantity`.
    ///
    /// # Errors
    /// [`PaintError::Quantity`] for the first that is NaN or negative; [`PaintError::NoSuchChannel`];
    /// [`PaintError::Count`].
    pub(crate) fn values(
        &self,
        surface: &Surface,
        quantity: &'static str,
    ) -> Result<Vec<f32>, PaintError> {
        let values = match self {
            Self::Uniform(value) => vec![*value; surface.len()],
            Self::Attribute {
                name,
                channel,
                scale,
            } => attribute(surface, name, *channel)?
                .iter()
                // 0 stays 0 under an infinite scale.
                .map(|value| {
                    let value = value[*channel];
                    if value == 0.0 { 0.0 } else { value * scale }
                })
                .collect(),
            Self::AtRest(function) => {
                let value = |place| function.of(place / surface.scale());
                surface.whole_positions().map(value).collect()
            }
            Self::Vertices(values) => of_vertices(surface, values)?,
        };
        let zero_or_more = Allowed(|v| v >= 0.0, "zero or more");
        zero_or_more.check(quantity, values.iter().copied())?;
        Ok(values)
    }
}

fn attribute<'a>(
    surface: &'a Surface,
    name: &str,
    channel: usize,
) -> Result<&'a [[f32; 4]], PaintError> {
    let attributes = surface.attributes();
    let found = attributes.iter().find(|each| each.name() == name);
    found
        .filter(|_| channel < 4)
        .map(VertexAttribute::values)
        .ok_or_else(|| PaintError::NoSuchChannel {
            name: name.into(),
            channel,
            attributes: VertexAttribute::names(attributes),
        })
}

fn of_vertices(surface: &Surface, values: &[f32]) -> Result<Vec<f32>, PaintError> {
    if values.len() != surface.vertices() {
        return Err(PaintError::Count {
            expected: surface.vertices(),
            found: values.len(),
        });
    }
    let mut of_particles = vec![f32::NEG_INFINITY; surface.len()];
    for (vertex, value) in values.iter().enumerate() {
        if let Some(particle) = surface.particle_of_vertex(vertex) {
            let known = &mut of_particles[particle];
            // Keeps NaN, so that it is found.
            *known = if *known > *value { *known } else { *value };
        }
    }
    surface.share_with_copies(&mut of_particles);
    Ok(of_particles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloth::{Cloth, TriangleMesh};

    /// Two triangles with a seam between them, painted differently on both sides of it.
    fn seamed() -> Surface {
        let places = [
            (0.0, 0.0),
            (1.0, 0.0),
            (0.0, 1.0),
            (1.0, 0.0),
            (0.0, 1.0),
            (1.0, 1.0),
        ];
        let numbers = [0.0, 0.1, 0.2, 0.3, 0.1, 0.5].map(|value| [value, 0.0, 0.0, 1.0]);
        let mesh = TriangleMesh {
            positions: places.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
            triangles: vec![[0, 1, 2], [3, 5, 4]],
            attributes: vec![VertexAttribute::new("Slack", numbers.to_vec())],
            ..TriangleMesh::default()
        };
        Surface::of_mesh(&mesh, 1.0e-5, Vec3::splat(2.0)).expect("a surface")
    }

    fn by_vertex(surface: &Surface, paint: &ClothPaint) -> Vec<f32> {
        let values = paint.values(surface, "a number").expect("valid");
        let of = |vertex| values[surface.particle_of_vertex(vertex).expect("a particle")];
        (0..6).map(of).collect()
    }

    #[test]
    fn each_kind_of_paint_gives_each_particle_its_number() {
        let surface = seamed();
        let of = |paint: ClothPaint| by_vertex(&surface, &paint);
        assert_eq!(of(0.7.into()), [0.7; 6]);
        let painted = of(ClothPaint::attribute("Slack", 0, 10.0));
        assert_eq!(
            painted,
            [0.0, 3.0, 2.0, 3.0, 2.0, 5.0],
            "the larger of a seam's"
        );
        let free = of(ClothPaint::attribute("Slack", 0, f32::INFINITY));
        assert_eq!((free[0], free[5]), (0.0, f32::INFINITY));
        let places = of(ClothPaint::at_rest(|place| place.x + 2.0 * place.y));
        assert_eq!(places, [0.0, 1.0, 2.0, 1.0, 2.0, 3.0], "before the scale");
        let given = of(ClothPaint::vertices([0.0, 1.0, 2.0, 3.0, 1.0, 5.0]));
        assert_eq!(given, [0.0, 3.0, 2.0, 3.0, 2.0, 5.0]);
    }

    #[test]
    fn what_is_no_paint_is_refused() {
        let surface = seamed();
        let of = |paint: ClothPaint| paint.values(&surface, "a number");
        for bad in [f32::NAN, -0.1] {
            for paint in [
                ClothPaint::from(bad),
                ClothPaint::at_rest(move |_| bad),
                ClothPaint::vertices([bad; 6]),
            ] {
                let error = of(paint).expect_err("not a number of metres");
                assert!(matches!(error, PaintError::Quantity(_)), "{error}");
            }
        }
        let error = of(ClothPaint::color(0, 1.0)).expect_err("not painted");
        assert!(error.to_string().contains("Slack"), "{error}");
        assert!(of(ClothPaint::attribute("Slack", 4, 1.0)).is_err());
        let error = of(ClothPaint::vertices([1.0; 5])).expect_err("too few");
        let count = PaintError::Count {
            expected: 6,
            found: 5,
        };
        assert_eq!(error, count);
        let grid = Cloth::new(2, 2, 0.1).surface(Vec3::ONE).expect("a grid");
        let own = ClothPaint::vertices([1.0, 2.0, 3.0, 4.0]).values(&grid, "a number");
        assert_eq!(own, Ok(vec![1.0, 2.0, 3.0, 4.0]));
    }
}
