//! scratch
use bevy_drape::{cloth::SpringKind, solver::methods::Scene};
use std::time::Instant;
fn main() {
    let args: Vec<u32> = std::env::args().skip(1).map(|a| a.parse().unwrap()).collect();
    for &(side, from, to, by) in &[(args[0], args[1], args[2], args[3])] {
      for substeps in (from..=to).step_by(by as usize) {
        let scene = Scene::hung_by_corners(side, 2.0).unwrap();
        let mut p = scene.particles.clone();
        let mut solver = scene.solver(args.get(4) != Some(&0));
        let springs = scene.springs.to_vec();
        let (mut worst, mut sq, mut n) = (0.0f32, 0.0, 0);
        let mut times = vec![];
        for frame in 0..180 {
            let t = Instant::now();
            let st = solver.advance(&mut p, scene.step(substeps), &[], |_, _| false);
            times.push(t.elapsed().as_secs_f64() * 1e3);
            if frame >= 120 {
                worst = worst.max(st.structural);
                for s in &springs { if s.kind == SpringKind::Structural { let [a, b] = s.ends.map(|e| p.position(e as usize).unwrap()); let d = (a.distance(b) / s.rest_length - 1.0) as f64; sq += d * d; n += 1; } }
            }
        }
        times.sort_by(f64::total_cmp);
        println!("H({side}) {substeps}: {:.3} ms ({:.2} us a sub-step)  {:.2} % ({:.3})", times[90], times[90] / substeps as f64 * 1e3, worst * 100.0, (sq / n as f64).sqrt() * 100.0);
      }
    }
}
