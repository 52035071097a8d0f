//! Finds the cloths and the particles of seams.

use std::sync::Arc;

use bevy::{
    ecs::query::QueryData,
    prelude::{Commands, Entity, On, Query, Remove, Res, ResMut, Resource, Vec3, With},
};

use super::{
    named::NamedTargets,
    neighbour::{Neighbour, NeighbourReadOnlyItem},
};
use crate::{
    cloth::{Cloth, ClothError, SewnSide, Surface, TargetError, stitches},
    plugin::{
        authoring::{ClothSeam, ClothStitches, Ordered},
        frame::relative,
        naming::Part,
        state::ClothFault,
    },
    solver::Seam,
};

/// The seams that hold cloths together in the tick.
#[derive(Resource, Debug, Default)]
pub(crate) struct Seams {
    /// In the order in which they are solved.
    pub active: Vec<ActiveSeam>,
    /// Those of the tick before.
    before: Vec<ActiveSeam>,
}

/// A seam that holds cloths together in the tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct ActiveSeam {
    pub cloths: [Ordered; 2],
    /// Its first particles: two seams of the same cloths are solved in the order of these.
    first: [[u32; 2]; 2],
    pub seam: Entity,
}

#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct SeamQuery {
    entity: Entity,
    seam: &'static ClothSeam,
    stitches: &'static mut ClothStitches,
    fault: Option<&'static ClothFault>,
}

impl Seams {
    /// Whether there were any in the tick before.
    pub fn were_there(seams: Res<Self>) -> bool {
        !seams.active.is_empty()
    }

    /// Whether a cloth is sewn to anything.
    pub fn hold(&self, cloth: Entity) -> bool {
        let mut cloths = self.active.iter().flat_map(|seam| seam.cloths);
        cloths.any(|(_, each)| each == cloth)
    }
}

/// Finds the particles of seams that are new or whose cloths are new, and wakes what they move.
pub(crate) fn prepare_seams(
    mut seams: Query<SeamQuery>,
    mut cloths: Query<Neighbour>,
    names: NamedTargets<With<Cloth>>,
    mut all: ResMut<Seams>,
    mut commands: Commands,
) {
    let all = &mut *all;
    std::mem::swap(&mut all.active, &mut all.before);
    all.active.clear();
    for mut seam in &mut seams {
        let active = seam.prepare(&mut cloths, &names);
        let outcome = active.map(|active| all.active.extend(active));
        ClothFault::report(&mut commands, seam.entity, seam.fault, Part::Seam, outcome);
    }
    // Whichever was spawned first.
    all.active.sort_unstable();
    for gone in &all.before {
        let is_left = |seam: &ActiveSeam| seam.seam == gone.seam && seam.cloths == gone.cloths;
        if !all.active.iter().any(is_left) {
            wake(gone.cloths.map(|(_, cloth)| cloth), &mut cloths);
        }
    }
}

/// Forgets the stitches of a seam that is removed.
pub(crate) fn forget_stitches(
    removed: On<Remove, ClothSeam>,
    mut seams: Query<(&mut ClothStitches, Option<&ClothFault>)>,
    mut commands: Commands,
) {
    let Ok((mut stitches, fault)) = seams.get_mut(removed.entity) else {
        return;
    };
    *stitches = ClothStitches::default();
    ClothFault::report(&mut commands, removed.entity, fault, Part::Seam, Ok(()));
}

fn wake(of: [Entity; 2], cloths: &mut Query<Neighbour>) {
    for cloth in of {
        if let Ok(mut cloth) = cloths.get_mut(cloth)
            && cloth.state.rest.is_asleep()
        {
            cloth.wake();
        }
    }
}

impl SeamQueryItem<'_, '_> {
    /// The cloths that its sides name: those that it joins already, as long as they are so called.
    fn cloths(&self, names: &NamedTargets<With<Cloth>>) -> Result<[Entity; 2], ClothError> {
        let [first, second] = [0, 1].map(|place| {
            let side = self.seam.sides()[place];
            let known = self.stitches.cloths.map(|cloths| cloths[place]);
            let pin = || format!("{:?}", side.along);
            names.find(&side.cloth, self.entity, known, |_| true, pin)
        });
        Ok([first?, second?])
    }

    /// Finds its stitches. `None` if it joins nothing, or before it has begun.
    fn prepare(
        &mut self,
        cloths: &mut Query<Neighbour>,
        names: &NamedTargets<With<Cloth>>,
    ) -> Result<Option<ActiveSeam>, ClothError> {
        self.seam.validate()?;
        let of = self.cloths(names)?;
        let is_known = self.stitches.known.as_ref() == Some(self.seam);
        let get = |cloth| {
            cloths
                .get(cloth)
                .map_err(|_| TargetError::NoSuchCloth { cloth })
        };
        let joined = [get(of[0])?, get(of[1])?];
        let order = |of: &NeighbourReadOnlyItem| (of.order.copied().unwrap_or_default(), of.entity);
        let orders = joined.each_ref().map(order);
        let is_ready = |of: &NeighbourReadOnlyItem| {
            of.scratch.step.is_some() && of.built.matches(of.particles)
        };
        if !joined.iter().all(is_ready) {
            let has_begun = self.stitches.cloths == Some(of);
            return Ok(has_begun.then(|| self.active(orders)).flatten());
        }
        let surfaces = joined.each_ref().map(|of| of.built.surface().clone());
        let begins = !self.is_of(of, &surfaces);
        if begins {
            self.begin(of, &surfaces, joined)?;
        }
        self.stitches.surfaces = Some(surfaces);
        if !is_known {
            self.stitches.known = Some(self.seam.clone());
        }
        let stitches = &self.stitches.seam;
        if begins || !is_known || stitches.is_closing(&self.seam.pull()) {
            wake(of, cloths);
        }
        Ok(self.active(orders))
    }

    /// The seam of these cloths, unless it joins nothing.
    fn active(&self, cloths: [Ordered; 2]) -> Option<ActiveSeam> {
        let first = self.stitches.seam.joined().next();
        first.map(|first| ActiveSeam {
            cloths,
            first,
            seam: self.entity,
        })
    }

    /// Whether its stitches are those of the same sides of the same surfaces.
    fn is_of(&self, cloths: [Entity; 2], surfaces: &[Arc<Surface>; 2]) -> bool {
        let stitches = &*self.stitches;
        let is_same = match &stitches.surfaces {
            Some(known) => known.iter().zip(surfaces).all(|(a, b)| Arc::ptr_eq(a, b)),
            None => {
                let counts = surfaces.each_ref().map(|surface| surface.len());
                stitches.seam.is_of(counts)
            }
        };
        is_same && self.joins(cloths)
    }

    /// Whether its stitches are those of the same sides of the same cloths.
    fn joins(&self, cloths: [Entity; 2]) -> bool {
        let known = self.stitches.known.as_ref();
        self.stitches.cloths == Some(cloths)
            && known.is_some_and(|known| known.sides() == self.seam.sides())
    }

    /// Begins anew, from where the particles are.
    fn begin(
        &mut self,
        of: [Entity; 2],
        surfaces: &[Arc<Surface>; 2],
        [a, b]: [NeighbourReadOnlyItem; 2],
    ) -> Result<(), ClothError> {
        let [first, second] = self.seam.sides();
        let first = SewnSide::of(&surfaces[0], &first.along)?;
        let second = SewnSide::of(&surfaces[1], &second.along)?;
        let from_second = relative(a.frame.isometry(), b.frame.isometry());
        let own: Vec<Vec3> = a.particles.positions().collect();
        let others = b.particles.positions().map(|place| from_second * place);
        let places = [&own[..], &others.collect::<Vec<_>>()];
        let [spacing, other] = surfaces.each_ref().map(|surface| surface.spacing().typical);
        let spacing = spacing.min(other);
        let all = stitches([&first, &second], places, spacing);
        let mut new = Seam::new(&all, places, of[0] == of[1]);
        if self.joins(of) {
            // Another resolution of the same cloths.
            new.resume(&self.stitches.seam);
        }
        self.stitches.seam = new;
        self.stitches.cloths = Some(of);
        Ok(())
    }
}
