//! The seams of an island, in their tick.

use bevy::{
    ecs::world::Mut,
    prelude::{Isometry3d, Query},
};

use super::member::{Few, Member};
use crate::{
    contact::MutualContact,
    plugin::{
        authoring::{ClothSeam, ClothStitches},
        frame::relative,
        prepare::Island,
    },
    solver::{SeamPull, StartedTick, SubStep, Substepping},
};

pub(crate) type SewnSeams<'w, 's> = Query<'w, 's, (&'static ClothSeam, &'static mut ClothStitches)>;

/// How many times as many sub-steps a load may ask for.
const MOST: u32 = 4;

/// The seams of an island, in the order in which they are solved.
#[derive(Default)]
pub(super) struct Sewing<'w>(Few<Sewn<'w>>);

/// A seam between two members of an island, or of one with itself.
struct Sewn<'w> {
    stitches: Mut<'w, ClothStitches>,
    pull: SeamPull,
    members: [usize; 2],
    /// From the second one's frame to the first one's.
    from_second: Option<Isometry3d>,
}

impl<'w> Sewing<'w> {
    /// Begins the tick of those whose cloths are both among the members.
    pub fn begin(island: &Island, members: &[Member], seams: &'w mut SewnSeams) -> Self {
        if island.seams.is_empty() {
            return Self::default();
        }
        let sewn = seams
            .iter_many_unique_mut(&island.seams)
            .filter_map(|(seam, mut stitches)| {
                let place = |cloth| members.iter().position(|of| of.cloth.entity == cloth);
                let [Some(a), Some(b)] = stitches.cloths?.map(place) else {
                    return None;
                };
                let [first, second] = [a, b].map(|place| members[place].cloth.frame.isometry());
                stitches.seam.begin();
                Some(Sewn {
                    stitches,
                    pull: seam.pull(),
                    members: [a, b],
                    from_second: (first != second).then(|| relative(first, second)),
                })
            });
        Self(sewn.collect())
    }

    /// Goes back to where the tick began.
    pub fn restart(&mut self) {
        self.0
            .iter_mut()
            .for_each(|sewn| sewn.stitches.seam.restart());
    }

    /// Ends the tick of this many seconds.
    pub fn end(&mut self, seconds: f32) {
        for Sewn { stitches, pull, .. } in &mut self.0 {
            stitches.seam.end(seconds, pull);
        }
    }

    /// Tells contact of cloth with cloth which particles are sewn together.
    pub fn tell(&self, contact: &mut MutualContact, members: &[Member]) {
        let first = |of: usize| {
            let before = members[..of].iter();
            let lengths = before.map(|member| member.cloth.particles.len() as u32);
            lengths.sum::<u32>()
        };
        let touches = |of: &usize| members[*of].cloth.scratch.self_collision.is_some();
        let sewn = self
            .0
            .iter()
            .filter(|sewn| sewn.members.iter().all(touches));
        contact.set_joined(sewn.flat_map(|sewn| {
            let firsts = sewn.members.map(first);
            let joined = sewn.stitches.seam.joined();
            joined.map(move |pair| pair.map(|[cloth, particle]| firsts[cloth as usize] + particle))
        }));
    }

    /// Sub-steps that hold two cloths together: those of one that is as long as both, and up to [`MOST`] times as many under a load.
    pub fn needed(&self, members: &[Member]) -> u32 {
        let each = self.0.iter().filter_map(|sewn| {
            let of = sewn.members;
            let surface = |of: usize| {
                let cloth = &members[of].cloth;
                let is_free = cloth.scratch.substepping == Substepping::Automatic;
                is_free.then(|| cloth.built.surface())
            };
            let both = [surface(of[0])?, surface(of[1])?];
            let [a, b] = both.map(|surface| surface.particles_along());
            let along = if of[0] == of[1] { a } else { a + b };
            let seconds = of.iter().find_map(|&of| members[of].step)?.seconds;
            // Some springs of a mesh are shorter than is typical.
            let spacing = both.map(|surface| {
                let of = surface.spacing();
                (of.shortest + of.typical) / 2.0
            });
            let unloaded = Substepping::needed(along, seconds);
            let loaded = (sewn.stitches.seam).needed(spacing[0].min(spacing[1]), seconds);
            Some(loaded.clamp(unloaded, MOST * unloaded))
        });
        each.max().unwrap_or(0)
    }

    /// Closes all gaps at the end of a sub-step of `dt` (s), `seconds` after the tick began.
    pub fn close(
        &mut self,
        members: &mut [Member],
        ticks: &mut [Option<StartedTick>],
        moved: &mut [Option<SubStep>],
        seconds: f32,
        dt: f32,
    ) {
        for sewn in &mut self.0 {
            let (seam, pull) = (&mut sewn.stitches.seam, &sewn.pull);
            let farthest = match members.get_disjoint_mut(sewn.members) {
                Ok([first, second]) => {
                    let cloths = &mut [first.sewn(None), second.sewn(sewn.from_second)];
                    seam.close(cloths, pull, seconds, dt)
                }
                // One cloth twice.
                Err(_) => {
                    let cloth = members[sewn.members[0]].sewn(None);
                    seam.close(&mut [cloth], pull, seconds, dt)
                }
            };
            let [a, b] = sewn.members;
            for of in [Some(a), (a != b).then_some(b)].into_iter().flatten() {
                if let (Some(tick), Some(substep)) = (&mut ticks[of], &mut moved[of]) {
                    tick.note_push(&mut members[of].cloth.particles);
                    substep.farthest_move += farthest;
                }
            }
        }
    }
}
