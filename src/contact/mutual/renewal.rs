//! Repeats the search for pairs of features.

use super::{
    LONGEST_WAIT, MutualContact, Starts,
    motion::{relative_motion, room_in_flat},
    pair::{NOBODY, Nearest, Pair, VERTEX_AND_FACE},
    participant::Participant,
};

/// Number of sub-steps at the current speed that a search should last.
const SUBSTEPS: f32 = 8.0;

/// Smallest margin of a search, and the largest unless the motion needs more, as a fraction of the shortest spacing.
const MARGINS: [f32; 2] = [0.05, 0.25];

impl MutualContact {
    /// Keeps nothing apart for a while.
    pub(super) fn lose(&mut self) {
        self.is_lost = true;
        (self.wait, self.waited) = (LONGEST_WAIT, 0);
        self.near.forget();
        self.pairs.clear();
        self.members.clear();
        self.member_of.clear();
    }

    /// Searches for all pairs that may come near each other within an approach of the margin. Adds those that may have
    /// met during an approach of `missed` (m).
    pub(super) fn search(
        &mut self,
        cloths: &[Participant],
        meets: impl Fn(usize, usize) -> bool,
        missed: f32,
        starts: Starts,
    ) {
        self.searches += 1;
        self.is_searched = true;
        self.is_lost = false;
        self.wait = 0;
        self.near.forget();
        let spacing = cloths
            .iter()
            .map(|cloth| cloth.sheet.surface().spacing().shortest)
            .fold(f32::INFINITY, f32::min);
        let substep = relative_motion(cloths);
        let [least, most] = MARGINS.map(|part| part * spacing);
        self.margin = (SUBSTEPS * substep)
            .clamp(least, most)
            .max(1.5 * substep)
            .min(spacing);
        self.origin.set(cloths);
        self.nearer = 0.0;
        if let Some(room) = room_in_flat(cloths)
            && room > self.margin + missed
        {
            self.margin = (room - missed).min(spacing);
            self.pairs.clear();
            self.members.clear();
            self.member_of.clear();
            return;
        }
        let (search, work) = (&mut self.search, &mut self.work);
        if !search.find(cloths, &meets, self.margin + missed, work) {
            // Features that have passed through meanwhile cannot be found; those that are near now can.
            if missed == 0.0 || !search.find(cloths, &meets, self.margin, work) {
                self.lose();
                return;
            }
            self.lost += 1;
        }
        std::mem::swap(&mut self.members, &mut self.members_before);
        std::mem::swap(&mut self.member_of, &mut self.member_of_before);
        self.members.clear();
        self.pairs.clear();
        self.member_of.resize_with(cloths.len(), Vec::new);
        for (of, cloth) in self.member_of.iter_mut().zip(cloths) {
            of.clear();
            if !self.search.found.is_empty() {
                of.resize(cloth.particles.len(), NOBODY);
            }
        }
        let mut last_of = std::mem::take(&mut self.last_of);
        last_of.clear();
        for found in &self.search.found {
            let mut members = [0; 4];
            for (index, &particle) in found.particles.iter().enumerate() {
                let cloth = found.cloths[usize::from(index >= found.split)] as usize;
                let place = &mut self.member_of[cloth][particle as usize];
                if *place == NOBODY {
                    let known = self.member_of_before.get(cloth);
                    let known = known.and_then(|known| known.get(particle as usize).copied());
                    let known = known.filter(|&member| member != NOBODY);
                    let known = known.map(|member| (&self.members_before, member));
                    let of = &cloths[cloth];
                    let slot = of.particles.layout().slot_of(particle as usize);
                    let start = match known {
                        Some((members, member)) => members.start(member),
                        None => match starts {
                            Starts::Here => of.place(slot),
                            Starts::Passed => of.point(self.passed.place(cloth, slot)),
                        },
                    };
                    *place = self.members.add(cloth as u32, slot, start, known);
                }
                members[index] = *place;
            }
            let [a, b] = found.cloths.map(|cloth| cloths[cloth as usize].settings);
            last_of.resize(self.members.len(), NOBODY);
            let mut before = NOBODY;
            if found.split == VERTEX_AND_FACE {
                before = last_of[members[0] as usize];
                last_of[members[0] as usize] = self.pairs.len() as u32;
            }
            self.pairs.push(Pair {
                members,
                split: found.split,
                thickness: found.thickness,
                friction: (a.friction * b.friction).sqrt(),
                before,
                far_until: f32::NEG_INFINITY,
                is_near: false,
                nearest: Nearest::default(),
                found_in: NOBODY,
            });
        }
        self.last_of = last_of;
        if self.pairs.is_empty() {
            return;
        }
        self.hold.clear(cloths);
        if let Starts::Here = starts {
            self.passed.set(cloths);
        }
    }
}
