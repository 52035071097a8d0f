//! A tick sub-step by sub-step: so that cloths which touch each other can be moved together.

use super::{AFTER_CONTACT, RESOLVED, Solver, UNSOLVED, WARY_TICKS};
use crate::{
    cloth::{Block, ClothParticles, Earlier, StepKind},
    solver::{
        bending::BendingSchedule,
        damping_reference::DampingReference,
        energy::Energy,
        kernels::{ForceStep, Kernels, Prediction, StepScale, weight},
        partitions::in_partitions,
        spin::Spin,
        spring_solver::Motion,
        step::{DAMPING_REFERENCE, PinMotion, SubStep, TickStep, TimeOrder, existing, put_pins},
        stretch::Stretch,
    },
};

/// A tick that has begun and not ended.
#[derive(Debug)]
pub(crate) struct StartedTick {
    step: TickStep,
    /// The sub-step to come.
    next: u32,
    /// Whether springs push by their forces.
    is_explicit: bool,
    bending: BendingSchedule,
    /// The cloth's energy as the tick began, if it is watched.
    watched: Option<Energy>,
    spin: Option<Spin>,
    damping_reference: DampingReference,
    is_pushed: bool,
    /// The stretch, where it was measured on the way.
    measured: Option<Stretch>,
    /// The stretch of the material, likewise.
    material: f32,
    /// Frequency of ripples (rad/s).
    ripple: f32,
}

impl StartedTick {
    /// Sub-steps in it.
    pub(crate) fn substeps(&self) -> u32 {
        self.step.substeps.max(1)
    }

    /// Length of a sub-step (s).
    fn substep(&self) -> f32 {
        self.step.seconds / self.substeps() as f32
    }

    /// Call this after a sub-step at whose end particles were pushed: their past does not predict their motion any
    /// more.
    pub(crate) fn note_push(&mut self, particles: &mut ClothParticles) {
        self.is_pushed = true;
        self.measured = None;
        self.bending.bend_in_each();
        self.damping_reference.note_push();
        if !self.is_explicit {
            particles.forget_past(AFTER_CONTACT);
        }
    }
}

impl Solver {
    /// Begins a tick of `particles`. Then call its [sub-steps](Self::substep), and its [end](Self::end).
    ///
    /// # Panics
    /// If the solver was made for other particles.
    pub(crate) fn begin(
        &mut self,
        particles: &mut ClothParticles,
        step: TickStep,
        pins: &[PinMotion],
    ) -> StartedTick {
        assert!(
            particles.layout() == self.layout,
            "particles of the solver's own"
        );
        let step = self.allowed(step);
        let mut tick = StartedTick {
            step,
            next: 0,
            is_explicit: false,
            bending: BendingSchedule::new(1),
            watched: None,
            spin: None,
            damping_reference: DampingReference::of(&step),
            is_pushed: false,
            measured: None,
            material: 0.0,
            ripple: 0.0,
        };
        if step.seconds <= 0.0 {
            tick.next = u32::MAX;
            return tick;
        }
        let dt = tick.substep();
        self.forces.begin(step.seconds, tick.substeps());
        // Jolts keep cloth that touches something awake, and two layers may pass each other by one.
        if let Some(bending) = &self.bending
            && step.order == TimeOrder::Second
            && !step.has_layers
            && !particles.past.is_ignored()
        {
            tick.bending = BendingSchedule::new(bending.stride(particles.blocks(), dt));
        }
        tick.is_explicit = self.is_explicit(particles, &step);
        if tick.is_explicit {
            particles.set_substep(dt);
            particles.end_past();
            particles.zero_pin_displacements();
            return tick;
        }
        // The work of forces is no excess, and not known here.
        if self.forces.are_none() {
            tick.watched = Energy::watched(particles, dt, step.acceleration);
        }
        particles.set_substep(dt);
        particles.zero_pin_displacements();
        if step.order == TimeOrder::First {
            particles.past.forget(0);
        }
        // Other causes that turn the cloth are not known here.
        if self.forces.are_none() {
            let [drift, _] = tick.damping_reference.follow(particles.blocks());
            tick.spin = Spin::of(particles, &step, pins, drift, &self.free_pieces);
        }
        tick
    }

    /// A step of the order that is safe with what solves the springs.
    fn allowed(&self, step: TickStep) -> TickStep {
        let order = if self.spring_solver.is_exact() {
            step.order
        } else {
            TimeOrder::First
        };
        TickStep { order, ..step }
    }

    /// How many partitions a tick's sub-steps are cut into.
    pub(crate) fn partitions_of(&self, tick: &StartedTick) -> usize {
        match &self.soft_springs {
            Some(soft_springs) if tick.is_explicit => soft_springs.partitions(),
            _ => self.partitions(),
        }
    }

    /// Moves `particles` by the next sub-step; `None` if there is none left. A caller that then pushes any calls
    /// [`note_push`](StartedTick::note_push).
    pub(crate) fn substep(
        &mut self,
        particles: &mut ClothParticles,
        pins: &[PinMotion],
        tick: &mut StartedTick,
    ) -> Option<SubStep> {
        if tick.next == u32::MAX {
            return None;
        }
        let kernels = self.simd_level.kernels();
        let mut substep = SubStep {
            index: tick.next,
            ..SubStep::first_of(tick.substeps())
        };
        if substep.index < substep.count {
            (self.forces).before_substep(substep.index, particles, &kernels);
            (tick.damping_reference).set_force(self.forces.memory.force);
            for pin in existing(pins, particles.len()) {
                let target = pin.from.lerp(pin.to, substep.end());
                particles.set_pin_target(pin.particle as usize, target);
            }
        }
        if tick.is_explicit {
            return self.substep_explicitly(particles, tick, substep, &kernels);
        }
        if substep.index == substep.count {
            return None;
        }
        let step = tick.step;
        let dt = tick.substep();
        self.tethers.locate(particles.blocks(), &mut self.anchors);
        let kind = match step.order {
            TimeOrder::First => StepKind::First,
            TimeOrder::Second => particles.next_step(),
        };
        let weight_dt2 = weight(kind) * dt * dt;
        let pull = step.acceleration * weight_dt2;
        self.predict(particles, tick, kind, weight_dt2, &kernels);
        let blocks = particles.blocks_mut();
        self.forces.press(blocks, weight_dt2);
        let bends_for = tick.bending.next(tick.next, tick.substeps());
        if let Some(bending) = &mut self.bending
            && bends_for > 0
        {
            bending.prepare(blocks, weight_dt2 * bends_for as f32);
            bending.solve(blocks, &kernels);
        }
        particles.put_loads_on(pull);
        self.spring_solver
            .set_step_scale(StepScale::new(weight_dt2, dt, self.retardation));
        let begins = tick.next == 0;
        tick.next += 1;
        let motion = Motion {
            begins,
            kernels: &kernels,
            tethers: &self.tethers,
            anchors: &self.anchors,
            measures: tick.next == tick.substeps(),
        };
        let blocks = particles.blocks_mut();
        let swept = self.spring_solver.substep(blocks, &motion, self.partitions);
        particles.take_loads_off();
        let (blocks, past) = particles.blocks_and_past();
        if kind == StepKind::Start {
            (kernels.begin_past)(blocks, past);
        }
        (tick.measured, tick.ripple) = (swept.stretch, swept.ripple);
        tick.material = swept.stretch.map_or(0.0, |stretch| stretch.material);
        substep.farthest_move = swept.moved.into_iter().fold(0.0, f32::max).sqrt();
        Some(substep)
    }

    /// Moves the particles by the next sub-step of the kind under gravity and forces alone. `weight` is that of a force in it (s²).
    fn predict(
        &mut self,
        particles: &mut ClothParticles,
        tick: &mut StartedTick,
        kind: StepKind,
        weight: f32,
        kernels: &Kernels,
    ) {
        let (step, dt) = (tick.step, tick.substep());
        let partitions = self.partitions();
        let kept = (1.0 - step.damping).powf(dt / DAMPING_REFERENCE);
        let pull = step.acceleration * weight;
        (self.free_pieces).measure(particles.blocks(), step.damping);
        let frame = tick.damping_reference.follow(particles.blocks());
        let prediction = Prediction::new(kind, kept, pull, frame);
        // The displacement of a first sub-step is half a sub-step behind the velocity at its end.
        tick.damping_reference
            .gain(if kind == StepKind::Start { 0.5 } else { 1.0 });
        let force_step = ForceStep {
            weight,
            inverse_substep: 1.0 / dt,
        };
        let linearized = self.forces.linearized();
        let (blocks, past) = particles.blocks_and_past();
        match (step.order, linearized) {
            (TimeOrder::First, None) => (kernels.predict_first)(blocks, &prediction),
            (TimeOrder::First, Some(linearized)) => {
                (kernels.predict_first_forced)(blocks, linearized, &prediction, &force_step);
            }
            (TimeOrder::Second, linearized) => {
                let predict = |first: usize, blocks: &mut [Block], past: &mut [Earlier]| {
                    let Some(linearized) = linearized else {
                        return (kernels.predict)(blocks, past, &prediction);
                    };
                    let linearized = &linearized[first..first + blocks.len()];
                    (kernels.predict_forced)(blocks, past, linearized, &prediction, &force_step);
                };
                if partitions > 1 {
                    let size = blocks.len().div_ceil(partitions);
                    let parts = blocks.chunks_mut(size).zip(past.chunks_mut(size));
                    in_partitions(parts.enumerate(), |(partition, (blocks, past))| {
                        predict(partition * size, blocks, past);
                    });
                } else {
                    predict(0, blocks, past);
                }
            }
        }
        let gain = step.acceleration * dt * dt;
        (self.free_pieces).shift(particles.blocks_mut(), |displacement| {
            prediction.given_back([displacement - frame[0], gain - frame[1]])
        });
    }

    /// The next sub-step of a tick of explicit springs. The call after the last one ends the tick.
    fn substep_explicitly(
        &mut self,
        particles: &mut ClothParticles,
        tick: &mut StartedTick,
        mut substep: SubStep,
        kernels: &Kernels,
    ) -> Option<SubStep> {
        let soft_springs = self.soft_springs.as_mut().expect("soft springs");
        let bends_for = tick.bending.for_kick(substep.index, substep.count);
        let bending = self.bending.as_mut().map(|bending| (bending, bends_for));
        substep.farthest_move = soft_springs.substep(
            particles.blocks_mut(),
            &tick.step,
            substep,
            &mut tick.damping_reference,
            bending,
            self.forces.linearized(),
            &mut self.free_pieces,
            kernels,
        );
        let is_moved = substep.index < substep.count;
        tick.next = if is_moved { tick.next + 1 } else { u32::MAX };
        is_moved.then_some(substep)
    }

    /// Ends a tick of which all sub-steps are done, and measures the stretch.
    pub(crate) fn end(
        &mut self,
        particles: &mut ClothParticles,
        pins: &[PinMotion],
        tick: StartedTick,
    ) -> Stretch {
        let is_moved = tick.step.seconds > 0.0;
        let stretch = self.settle(particles, pins, tick);
        if let Some(bending) = &mut self.bending
            && is_moved
        {
            bending.crease(particles.blocks());
        }
        stretch
    }

    fn settle(
        &mut self,
        particles: &mut ClothParticles,
        pins: &[PinMotion],
        tick: StartedTick,
    ) -> Stretch {
        let StartedTick {
            step,
            is_pushed,
            measured,
            material,
            ripple,
            ..
        } = tick;
        if step.seconds <= 0.0 {
            return self.measure(particles);
        }
        (self.forces).settle(particles, &self.simd_level.kernels());
        if tick.is_explicit {
            put_pins(particles, pins);
            particles.past.set_moved();
            let stretch = self.measure(particles);
            return Stretch {
                material: stretch.structural,
                ..stretch
            };
        }
        let stretch = Stretch {
            ripple_substeps: step.seconds * ripple / RESOLVED,
            material,
            ..measured.unwrap_or_else(|| self.measure(particles))
        };
        let is_still = pins.iter().all(|pin| pin.from == pin.to);
        // The stretch of the material comes back by itself, and pushes and carriers give a cloth energy.
        let given = step.material_stretch.max(stretch.material);
        let is_unsolved = stretch.structural > 2.0 * given;
        if let Some(before) = tick.watched
            && is_unsolved
            && is_still
            && !is_pushed
        {
            before.limit(particles, step.acceleration);
        } else {
            particles.past.set_lost(0.0);
        }
        particles.past.set_moved();
        if let Some(spin) = tick.spin
            && !is_pushed
        {
            let kept = (1.0 - step.damping).powf(step.seconds / DAMPING_REFERENCE);
            spin.restore(particles, kept, &self.free_pieces);
        }
        put_pins(particles, pins);
        if stretch.structural > step.material_stretch + UNSOLVED {
            particles.past.forget(WARY_TICKS * step.substeps);
        }
        stretch
    }
}
