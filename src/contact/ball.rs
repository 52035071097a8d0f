//! A moving ball against particles.

use bevy::math::Vec3;

use crate::{
    cloth::{ClothParticles, Slot},
    hierarchy::Probe,
    solver::SubStep,
};

/// A ball on its way through a tick, in the cloth's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingBall {
    /// Centre as the tick begins (m).
    pub from: Vec3,
    /// Centre as the tick ends (m).
    pub to: Vec3,
    /// How far it turns in the tick: axis × angle (rad).
    pub turn: Vec3,
    /// Radius (m).
    pub radius: f32,
}

impl MovingBall {
    /// How far its centre moves in the tick (m).
    pub fn travel(&self) -> f32 {
        self.from.distance(self.to)
    }

    /// How far its surface moves at most, by travel and turn: how far it can drag what sticks to it (m).
    pub fn drag(&self) -> f32 {
        self.travel() + self.turn.length() * self.radius
    }

    /// The ball around all of its way, inflated by `margin` (m), as what a query searches for.
    pub fn probe(&self, margin: f32, particle_radius: f32) -> Probe {
        Probe {
            centre: self.from.midpoint(self.to),
            radius: self.radius + self.travel() / 2.0 + margin,
            particle_radius,
        }
    }
}

/// Pushes those of `candidates` that are inside of `ball` out along the contact normal, and slows them against
/// its moving surface by Coulomb's law: the tangential move is taken away up to μ times the normal one. A
/// particle that was inside already leaves without gaining speed. Marks
/// in `touched`, one flag a candidate, which they were. Returns how deep the deepest was (m), 0 if none was.
///
/// Pinned particles are left where they are.
pub fn push_out(
    particles: &mut ClothParticles,
    candidates: &[u32],
    touched: &mut [bool],
    ball: &MovingBall,
    particle_radius: f32,
    friction: f32,
    substep: SubStep,
) -> f32 {
    let centre = ball.from.lerp(ball.to, substep.end());
    let (slide, turn) = (
        (ball.to - ball.from) / substep.count as f32,
        ball.turn / substep.count as f32,
    );
    let reach = ball.radius + particle_radius;
    let layout = particles.layout();
    let mut deepest = 0.0_f32;
    for (&particle, touched) in candidates.iter().zip(touched) {
        let Slot { block, lane } = layout.slot_of(particle as usize);
        let block = &mut particles.blocks_mut()[block];
        if block.inverse_mass(lane) == 0.0 {
            continue;
        }
        let (position, displacement) = (block.position(lane), block.displacement(lane));
        let offset = position - centre;
        let distance = offset.length();
        let depth = reach - distance;
        if depth <= 0.0 {
            continue;
        }
        *touched = true;
        deepest = deepest.max(depth);
        // A particle in the very centre may leave either way.
        let normal = if distance > 0.0 {
            offset / distance
        } else {
            Vec3::Y
        };
        let surface = slide + turn.cross(normal * ball.radius);
        let relative = displacement - surface;
        let tangential = relative - normal * normal.dot(relative);
        // What the ball and the particle came towards each other in this sub-step is what its velocity has to
        // lose, and what friction can hold against. An older overlap is no velocity, and must not become one.
        let stopped = depth.min(-normal.dot(relative)).max(0.0);
        let slip = tangential.length();
        let grip = if slip > friction * stopped {
            friction * stopped / slip
        } else {
            1.0
        };
        block.set_position(lane, position + (normal * depth - tangential * grip));
        block.set_displacement(lane, displacement + (normal * stopped - tangential * grip));
    }
    deepest
}

/// How deep the deepest free particle is inside of a ball (m), 0 if none is: over all of them, in f64.
pub fn deepest_penetration(
    particles: &ClothParticles,
    centre: Vec3,
    radius: f32,
    particle_radius: f32,
) -> f64 {
    let reach = f64::from(radius) + f64::from(particle_radius);
    let free = particles
        .positions()
        .zip(particles.inverse_masses())
        .filter(|&(_, mass)| mass > 0.0);
    let depth = free.map(|(position, _)| reach - position.as_dvec3().distance(centre.as_dvec3()));
    depth.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        cloth::{Cloth, ClothMaterial, Springs},
        solver::{Solver, TickStep},
    };

    const GRAVITY: f32 = 9.81;

    /// A particle on a ball of radius 1, `slope` radians from its top, without springs, after 0.1 s under
    /// gravity: its angle from the top.
    fn slide(slope: f32, friction: f32, ball: MovingBall) -> f32 {
        let grid = Cloth::new(2, 2, 1.0).grid(Vec3::ONE).expect("a sound grid");
        let mut particles =
            ClothParticles::at_rest(&grid, &ClothMaterial::COTTON).expect("a sound material");
        particles
            .set_position(0, Vec3::new(slope.sin(), slope.cos(), 0.0))
            .expect("it exists");
        let step = TickStep {
            seconds: 0.1,
            substeps: 20,
            acceleration: Vec3::NEG_Y * GRAVITY,
            damping: 0.0,
        };
        let mut solver = Solver::new(&Springs::default(), &particles);
        solver.advance(&mut particles, step, &[], |particles, substep| {
            push_out(particles, &[0], &mut [false], &ball, 0.0, friction, substep) > 0.0
        });
        let position = particles.position(0).expect("it exists");
        assert!(
            (position.length() - 1.0).abs() < 1e-6,
            "it lies on the surface"
        );
        position.x.atan2(position.y)
    }

    const STILL: MovingBall = MovingBall {
        from: Vec3::ZERO,
        to: Vec3::ZERO,
        turn: Vec3::ZERO,
        radius: 1.0,
    };

    /// Below tan θ = μ it sticks; above it slides g (sin θ − μ cos θ) t²/2. The discrete formula falls short
    /// of or exceeds that by t Δt/2 in t² (5 %), and over the slide of 1 to 3 cm the slope's change adds less
    /// than 3 %.
    #[test]
    fn sticks_or_slips_by_coulombs_law() {
        for slope in [0.2_f32, 0.5, 0.8] {
            let stuck = slide(slope, slope.tan() * 1.02, STILL) - slope;
            assert!(stuck.abs() < 1e-5, "{slope}: {stuck}");
            let friction = slope.tan() * 0.5;
            let slid = slide(slope, friction, STILL) - slope;
            let expected = 0.5 * GRAVITY * (slope.sin() - friction * slope.cos()) * 0.01;
            assert!(
                (slid / expected - 1.0).abs() < 0.08,
                "{slope}: {slid} {expected}"
            );
        }
    }

    /// A ball that turns about z carries what sticks to it along: by its own angle.
    #[test]
    fn a_turning_ball_carries_what_sticks() {
        let turning = MovingBall {
            turn: Vec3::new(0.0, 0.0, -0.02),
            ..STILL
        };
        let carried = slide(0.0, 2.0, turning);
        // The first sub-step's surface speed has to be gained from μ g Δt, which 0.02/0.1 rad/s is below
        // after three of the 20 sub-steps.
        assert!(carried > 0.017 && carried <= 0.0201, "{carried}");
        assert!(slide(0.0, 0.0, turning).abs() < 1e-6);
    }

    #[test]
    fn pushes_out_exactly_and_leaves_pins_and_neighbours() {
        let grid = Cloth::new(3, 3, 1.0).grid(Vec3::ONE).expect("a sound grid");
        let mut particles =
            ClothParticles::at_rest(&grid, &ClothMaterial::COTTON).expect("a sound material");
        particles.set_inverse_mass(0, 0.0).expect("it exists");
        let ball = MovingBall {
            from: Vec3::new(0.5, -0.5, 1.0),
            to: Vec3::new(0.5, -0.5, 0.4),
            turn: Vec3::ZERO,
            radius: 1.0,
        };
        let before: Vec<Vec3> = particles.positions().collect();
        let mut touched = [false; 9];
        let candidates = [0, 1, 2, 3, 4, 5, 6, 7, 8];
        let substep = SubStep { index: 0, count: 1 };
        let deepest = push_out(
            &mut particles,
            &candidates,
            &mut touched,
            &ball,
            0.05,
            0.3,
            substep,
        );
        assert_eq!(
            touched,
            [false, true, false, true, true, false, false, false, false]
        );
        let depth = 1.05 - ball.to.distance(before[4]);
        assert!((deepest - depth).abs() < 1e-6);
        assert!(deepest_penetration(&particles, ball.to, 1.0, 0.05) < 1e-6);
        for index in [0, 2, 5, 6, 7, 8] {
            assert_eq!(particles.position(index), Some(before[index]));
        }
    }

    /// A ball that appears inside of a cloth moves it aside, and does not shoot it away.
    #[test]
    fn an_overlap_becomes_no_speed() {
        let grid = Cloth::new(2, 2, 1.0).grid(Vec3::ONE).expect("a sound grid");
        for (moving, left) in [
            // It was coming, and is stopped; it was leaving, and goes on.
            (Vec3::NEG_Y * 0.01, Vec3::ZERO),
            (Vec3::Y * 0.01, Vec3::Y * 0.01),
        ] {
            let mut particles =
                ClothParticles::at_rest(&grid, &ClothMaterial::COTTON).expect("a sound material");
            particles.set_position(0, Vec3::Y * 0.7).expect("it exists");
            particles.set_displacement(0, moving).expect("it exists");
            let substep = SubStep { index: 0, count: 1 };
            let mut touched = [false];
            push_out(
                &mut particles,
                &[0],
                &mut touched,
                &STILL,
                0.0,
                0.0,
                substep,
            );
            assert_eq!(particles.position(0), Some(Vec3::Y));
            assert_eq!(particles.displacement(0), Some(left));
        }
    }

    #[test]
    fn a_particle_in_the_centre_finds_a_way_out() {
        let grid = Cloth::new(2, 2, 1.0).grid(Vec3::ONE).expect("a sound grid");
        let mut particles =
            ClothParticles::at_rest(&grid, &ClothMaterial::COTTON).expect("a sound material");
        push_out(
            &mut particles,
            &[0],
            &mut [false],
            &STILL,
            0.0,
            0.5,
            SubStep { index: 0, count: 1 },
        );
        assert!((particles.position(0).expect("it exists").length() - 1.0).abs() < 1e-6);
    }
}
