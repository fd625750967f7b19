//! The runs of a study on several threads. What a run gives does not depend on who takes it, nor on what was taken before.

use super::record::Watch;
use super::study::Study;
use std::collections::HashMap;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use stickslip::simulator::drive::Drive;
use stickslip::{Result, Simulator};

/// What a run gave.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The numbers of its columns; not a number where the run failed.
    pub values: Vec<f64>,
    /// Why it failed.
    pub error: Option<String>,
}

/// Takes the runs `todo` on `workers` threads and shows each to `observe` on this one, as they come; `Break` ends the sweep.
pub fn work(
    study: &Study,
    todo: Vec<usize>,
    workers: usize,
    observe: &mut dyn FnMut(usize, Row) -> ControlFlow<()>,
) {
    let order = study.order(todo);
    // a model goes when the last of its runs has been taken
    let last: HashMap<_, _> = order.iter().map(|run| (study.key(*run), *run)).collect();
    let (next, is_over) = (AtomicUsize::new(0), AtomicBool::new(false));
    std::thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        for _ in 0..workers.clamp(1, order.len().max(1)) {
            let (sender, order, last) = (sender.clone(), &order, &last);
            let (next, is_over) = (&next, &is_over);
            scope.spawn(move || {
                let mut worker = Worker::default();
                while !is_over.load(Ordering::Relaxed) {
                    let Some(run) = order.get(next.fetch_add(1, Ordering::Relaxed)) else {
                        break;
                    };
                    let row = worker.row(study, *run);
                    if last.get(&study.key(*run)) == Some(run) {
                        study.forget(*run);
                    }
                    if sender.send((*run, row)).is_err() {
                        break;
                    }
                }
            });
        }
        drop(sender);
        for (run, row) in receiver {
            if observe(run, row).is_break() {
                is_over.store(true, Ordering::Relaxed);
                break;
            }
        }
    });
}

/// What one thread keeps from run to run: the simulator of the last model.
#[derive(Default)]
struct Worker {
    ready: Option<(Vec<String>, Simulator, Watch)>,
}

impl Worker {
    fn row(&mut self, study: &Study, run: usize) -> Row {
        match self.run(study, run) {
            Ok(values) => Row {
                values,
                error: None,
            },
            Err(error) => Row {
                values: vec![f64::NAN; study.record.columns().len()],
                error: Some(error.to_string()),
            },
        }
    }

    fn run(&mut self, study: &Study, run: usize) -> Result<Vec<f64>> {
        let key = study.key(run);
        if self.ready.as_ref().is_none_or(|(known, ..)| *known != key) {
            self.ready = None;
            let model = study.model(run)?;
            let watch = study.record.watch(&model)?;
            self.ready = Some((key, Simulator::new(model), watch));
        }
        let Some((_, simulator, watch)) = &mut self.ready else {
            return Ok(Vec::new());
        };
        simulator.reset();
        let course = study.course(run)?;
        let (references, values) = study.parameters(run, simulator.model())?;
        simulator.set_many(&references, &values)?;
        let mut drive = Drive::start(&course, simulator)?;
        watch.begin(drive.simulator())?;
        while let Some(simulator) = drive.step()? {
            watch.pass(simulator)?;
        }
        Ok(watch.finish())
    }
}
