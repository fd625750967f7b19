//! Sequences in which all nodes open, close, stick and slip at once, each solve starting from the last.

use crate::body::condensed;
use crate::cases::Solver;
use crate::check::violation;
use crate::hard::{CONDITIONS, draw};
use crate::laws::Coefficient;
use crate::random::Random;
use stickslip::contact::pressed::NormalCondition;

#[test]
fn whole_contacts_open_and_close_at_once() {
    let mut random = Random::new(5);
    let bodies = [
        condensed(&[8, 4], 0.02),
        condensed(&[24, 12], 0.02),
        condensed(&[4, 3, 2], 0.02),
    ];
    for body in &bodies {
        for condition in CONDITIONS {
            for coefficient in [
                Coefficient::Constant(0.3),
                Coefficient::Constant(1.5),
                Coefficient::Decaying(0.5, 0.2, 30.0),
                Coefficient::Creeping(0.02, 1e-9),
            ] {
                let mut case = draw(&mut random, body, coefficient, condition, 0.02);
                let (mut solver, mut found) = (Solver::new(&case), case.start());
                let label = format!("{} {condition:?} {coefficient:?}", case.nodes());
                let (mut all_open, mut most_closed) = (0, 0);
                for step in 0..60 {
                    // pressed on, pulled off, or neither, with noise
                    let pressure = random.one_of(&[-3.0, -0.3, 0.0, 0.3, 3.0]);
                    let size = 10.0_f64.powf(random.between(-3.0, -1.0));
                    let free: Vec<f64> =
                        case.r.iter().map(|_| random.between(-size, size)).collect();
                    case.set_free_velocity(&free);
                    for r in case
                        .r
                        .iter_mut()
                        .skip(case.components)
                        .step_by(case.components + 1)
                    {
                        *r -= pressure * body.weight;
                    }
                    if condition != NormalCondition::Bilateral {
                        let gaps = case.gap_base.iter_mut();
                        gaps.for_each(|gap| *gap = 0.02 * random.between(-size, size));
                    }
                    let reached = solver.solve(&case, &mut found);
                    assert!(reached.converged, "{label}, step {step}: {reached:?}");
                    let violation = violation(&case, &found);
                    assert!(violation < 1e-9, "{label}, step {step}: {violation:e}");
                    let d = case.components + 1;
                    let open = found.force.chunks(d).filter(|f| f[d - 1] == 0.0).count();
                    all_open += usize::from(open == case.nodes());
                    most_closed += usize::from(2 * open < case.nodes());
                }
                let work = solver.ws.work();
                println!("{label}: all open {all_open}, most closed {most_closed}, {work:?}");
                assert!(most_closed > 5, "{label}: {most_closed}");
                assert!(all_open > 5 || condition == NormalCondition::Bilateral);
            }
        }
    }
}
