//! Motion constraints: a particle stays within a ball around a moving place, and outside another ball.
//!
//! Both are XPBD constraints without compliance. They are applied after the springs of each sub-step, so that they hold
//! exactly at its end. A particle beyond its limit moves to the nearest allowed point, and its displacement changes by
//! as much:
//!
//! ```text
//!   max distance r around p:   |x − p| > r:   Δx = (p − x) (1 − r/|x − p|)
//!   backstop R around c:       |x − c| < R:   Δx = (x − c) (R/|x − c| − 1)
//! ```
//!
//! Around a place at rest, the first takes energy away or none. A ball is convex, and the nearest point of a convex set
//! is no farther from the particle's old position than its new one. The second is not convex, and a particle that
//! begins inside such a ball was moved there by nothing. So a displacement, relative to that of the place, is never
//! longer than before.

use bevy::math::Vec3;

use super::step::SubStep;
use crate::cloth::{Block, ClothParticles, LANES, Lanes, Layout, MapInline};

/// Max distances and backstops of the particles of a cloth in a tick. Empty, it costs nothing.
#[derive(Debug, Default, Clone)]
pub(crate) struct MotionConstraints {
    layout: Layout,
    balls: Vec<Balls>,
    /// None, or as many.
    backstops: Vec<Balls>,
    /// Largest displacement of any of its centres in the tick (m).
    travel: f32,
}

/// Eight balls that move along straight lines in the tick: their starts and their displacements (m).
#[derive(Debug, Clone, Copy)]
struct Balls {
    from: [Lanes; 3],
    displacement: [Lanes; 3],
    radius: Lanes,
}

impl Balls {
    const NONE: Self = Self {
        from: [[0.0; LANES]; 3],
        displacement: [[0.0; LANES]; 3],
        radius: [0.0; LANES],
    };

    fn set(&mut self, lane: usize, from: Vec3, to: Vec3, radius: f32) {
        let displacement = to - from;
        for axis in 0..3 {
            self.from[axis][lane] = from[axis];
            self.displacement[axis][lane] = displacement[axis];
        }
        self.radius[lane] = radius;
    }

    /// A centre when a part of the tick has passed (m).
    fn centre(&self, lane: usize, part: f32) -> Vec3 {
        let [from, displacement] = [self.from, self.displacement]
            .map_inline(|of| Vec3::from(of.map_inline(|axis| axis[lane])));
        from + displacement * part
    }

    /// Squared distances of eight particles from the centres (m²).
    #[inline(always)]
    fn squares(&self, block: &Block, part: f32) -> Lanes {
        let view = block.view();
        let mut squares = [0.0; LANES];
        for axis in 0..3 {
            for lane in 0..LANES {
                let centre = self.from[axis][lane] + self.displacement[axis][lane] * part;
                let offset = view[axis * LANES + lane] - centre;
                squares[lane] += offset * offset;
            }
        }
        squares
    }
}

/// A particle's ball and its backstop, as a sub-step ends.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    centre: Vec3,
    radius: f32,
    /// Centre and radius; a radius of 0 is none.
    backstop: (Vec3, f32),
}

impl Bounds {
    /// The nearest allowed place.
    fn nearest(&self, place: Vec3) -> Vec3 {
        let inside = self.within_ball(place);
        let (behind, radius) = self.backstop;
        let offset = inside - behind;
        if radius == 0.0 || offset.length_squared() >= radius * radius {
            return inside;
        }
        let axis = self.centre - behind;
        let distance = axis.length();
        // A ball that is all inside of the other has no place outside of that: the pose counts.
        if distance + self.radius <= radius {
            return inside;
        }
        let axis = axis / distance;
        let outside = behind + offset.normalize_or(axis) * radius;
        if self.radius.is_infinite()
            || outside.distance_squared(self.centre) <= self.radius * self.radius
        {
            return outside;
        }
        // Where the two surfaces meet: a circle about the axis.
        let along =
            (distance * distance + radius * radius - self.radius * self.radius) / (2.0 * distance);
        let across = (radius * radius - along * along).max(0.0).sqrt();
        let side = offset.reject_from_normalized(axis);
        let side = side.normalize_or(axis.any_orthonormal_vector());
        behind + axis * along + side * across
    }

    fn within_ball(&self, place: Vec3) -> Vec3 {
        let offset = place - self.centre;
        let square = offset.length_squared();
        if square <= self.radius * self.radius {
            place
        } else {
            self.centre + offset * (self.radius / square.sqrt())
        }
    }
}

impl MotionConstraints {
    /// Whether there are no constraints.
    pub fn is_empty(&self) -> bool {
        self.balls.is_empty()
    }

    /// Removes all constraints.
    pub fn clear(&mut self) {
        self.balls.clear();
        self.backstops.clear();
        self.travel = 0.0;
    }

    /// Begins with a free constraint for each of `particles`.
    pub fn begin(&mut self, particles: &ClothParticles, has_backstops: bool) {
        self.clear();
        self.layout = particles.layout();
        let blocks = self.layout.blocks();
        let free = Balls {
            radius: [f32::INFINITY; LANES],
            ..Balls::NONE
        };
        self.balls.resize(blocks, free);
        if has_backstops {
            self.backstops.resize(blocks, Balls::NONE);
        }
    }

    /// Keeps a particle within `radius` (m) of a place that moves from `from` to `to` in the tick.
    pub fn set_ball(&mut self, particle: usize, [from, to]: [Vec3; 2], radius: f32) {
        let slot = self.layout.slot_of(particle);
        self.balls[slot.block].set(slot.lane, from, to, radius);
        self.travel = self.travel.max(from.distance(to));
    }

    /// Keeps a particle out of a ball of `radius` (m), whose centre moves from `from` to `to` in the tick.
    pub fn set_backstop(&mut self, particle: usize, [from, to]: [Vec3; 2], radius: f32) {
        let slot = self.layout.slot_of(particle);
        self.backstops[slot.block].set(slot.lane, from, to, radius);
        self.travel = self.travel.max(from.distance(to));
    }

    /// Largest displacement of any of its centres in the tick (m).
    pub fn travel(&self) -> f32 {
        self.travel
    }

    /// Moves particles to allowed positions as a sub-step ends, and notes the largest displacement. Returns whether any
    /// was moved.
    pub fn hold(&self, particles: &mut ClothParticles, substep: &mut SubStep) -> bool {
        let part = substep.end();
        let mut is_moved = false;
        let mut farthest = substep.farthest_move * substep.farthest_move;
        for (index, (block, balls)) in particles
            .blocks_mut()
            .iter_mut()
            .zip(&self.balls)
            .enumerate()
        {
            let squares = balls.squares(block, part);
            let backstops = self.backstops.get(index);
            let behind = backstops.map(|balls| (balls, balls.squares(block, part)));
            let mut is_beyond = [false; LANES];
            for lane in 0..LANES {
                let radius = balls.radius[lane];
                is_beyond[lane] = squares[lane] > radius * radius;
            }
            if let Some((balls, squares)) = &behind {
                for lane in 0..LANES {
                    let radius = balls.radius[lane];
                    is_beyond[lane] |= squares[lane] < radius * radius;
                }
            }
            if is_beyond == [false; LANES] {
                continue;
            }
            for lane in 0..LANES {
                if !is_beyond[lane] || block.inverse_mass(lane) == 0.0 {
                    continue;
                }
                let allowed = Bounds {
                    centre: balls.centre(lane, part),
                    radius: balls.radius[lane],
                    backstop: behind.map_or((Vec3::ZERO, 0.0), |(balls, _)| {
                        (balls.centre(lane, part), balls.radius[lane])
                    }),
                };
                let displacement = Vec3::from(balls.displacement.map_inline(|axis| axis[lane]))
                    / substep.count as f32;
                let place = block.position(lane);
                let pushed = allowed.nearest(place) - place;
                let moved = with_push(block.displacement(lane), pushed, displacement);
                block.set_position(lane, place + pushed);
                block.set_displacement(lane, moved);
                farthest = farthest.max((moved.length() + pushed.length()).powi(2));
                is_moved = true;
            }
        }
        substep.farthest_move = farthest.sqrt();
        is_moved
    }
}

/// A displacement with a push, as seen from a place that is displaced by `displacement` (m): no longer than it was.
fn with_push(moved: Vec3, pushed: Vec3, displacement: Vec3) -> Vec3 {
    let before = moved - displacement;
    let after = before + pushed;
    displacement + after.clamp_length_max(before.length())
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUBSTEP: SubStep = SubStep {
        index: 0,
        count: 1,
        farthest_move: 0.0,
    };

    fn scattered(index: u32) -> Vec3 {
        Vec3::new(
            index as f32,
            1.3 * index as f32 + 0.4,
            0.7 * index as f32 + 2.0,
        )
        .map(f32::sin)
    }

    /// Wherever a particle is, it goes to the nearest of many places that are allowed, to the fineness of those.
    #[test]
    fn what_is_beyond_goes_to_the_nearest_allowed_place() {
        for case in 0..40 {
            let [centre, place] = [scattered(case), scattered(case + 77)];
            let normal = scattered(case + 50).normalize();
            let (radius, behind, back) = (0.6, 0.1 * (case % 4) as f32, 0.8);
            let allowed = Bounds {
                centre,
                radius,
                backstop: (centre - normal * (behind + back), back),
            };
            let (other, _) = allowed.backstop;
            let is_allowed = |at: Vec3, clearance: f32| {
                at.distance(centre) <= radius + clearance && at.distance(other) >= back - clearance
            };
            let found = allowed.nearest(place);
            assert!(is_allowed(found, 1.0e-5), "{case}: {found}");
            let mut least = f32::INFINITY;
            for each in 0..60 * 60 * 60 {
                let [x, y, z] =
                    [each % 60, each / 60 % 60, each / 3600].map(|at| at as f32 / 29.5 - 1.0);
                let at = centre + Vec3::new(x, y, z) * radius;
                if is_allowed(at, 0.0) {
                    least = least.min(at.distance(place));
                }
            }
            // Cells of 0.02 m: the nearest grid point is up to a cell's diagonal farther. Projected one after the other,
            // a point is no farther than by the curvature of both.
            let went = found.distance(place);
            assert!(went <= least + 0.06, "{case}: {went} {least}");
        }
    }

    /// A free particle under gravity, held by a ball, and one that is thrown onto a backstop: neither gains energy.
    #[test]
    fn neither_constraint_feeds_in_energy() {
        let dt = 1.0 / 1280.0;
        let gravity = Vec3::new(0.0, -9.81, 0.0);
        for case in 0..50 {
            let mut particles = ClothParticles::new(&[scattered(case)], &[1.0]).expect("one");
            let velocity = 3.0 * scattered(case + 31);
            particles
                .set_displacement(0, velocity * dt)
                .expect("it exists");
            let energy = |particles: &ClothParticles| {
                let moved = particles.displacement(0).expect("it exists") / dt;
                let place = particles.position(0).expect("it exists");
                0.5 * moved.length_squared() - gravity.dot(place)
            };
            let mut constraints = MotionConstraints::default();
            constraints.begin(&particles, true);
            constraints.set_ball(0, [Vec3::ZERO; 2], 2.0);
            constraints.set_backstop(0, [Vec3::NEG_Y * 2.5; 2], 1.0);
            let start = energy(&particles);
            let mut held = 0;
            for _ in 0..4000 {
                let moved = particles.displacement(0).expect("it exists") + gravity * dt * dt;
                let place = particles.position(0).expect("it exists") + moved;
                particles.set_displacement(0, moved).expect("it exists");
                particles.set_position(0, place).expect("it exists");
                held += u32::from(constraints.hold(&mut particles, &mut SUBSTEP.clone()));
                // A free fall of first order in the larger of two energies loses ½ g² Δt² a sub-step.
                let now = energy(&particles);
                assert!(now <= start + 1.0e-3, "{case}: {now} {start}");
            }
            assert!(held > 100, "{case}: {held}");
        }
    }

    /// One that is far outside of a ball that has jumped is brought there without the speed of the jump.
    #[test]
    fn a_jump_gives_no_speed() {
        let mut particles = ClothParticles::new(&[Vec3::X * 100.0], &[1.0]).expect("one");
        particles
            .set_displacement(0, Vec3::Y * 0.01)
            .expect("it exists");
        let mut constraints = MotionConstraints::default();
        constraints.begin(&particles, false);
        constraints.set_ball(0, [Vec3::ZERO; 2], 0.5);
        let mut substep = SUBSTEP;
        assert!(constraints.hold(&mut particles, &mut substep));
        assert_eq!(particles.position(0), Some(Vec3::X * 0.5));
        let moved = particles.displacement(0).expect("it exists");
        assert!(moved.length() <= 0.01 * (1.0 + 1.0e-6), "{moved}");
        assert!(
            substep.farthest_move > 99.0,
            "who looks for contacts is told"
        );
        assert!(!constraints.hold(&mut particles, &mut SUBSTEP.clone()));
    }
}
