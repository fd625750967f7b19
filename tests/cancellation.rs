//! A compilation tells where it stands, and stops when it is asked to.

mod common;

use common::paper;
use std::ops::ControlFlow;
use stickslip::model::{Phase, Progress};
use stickslip::{Error, ErrorCode, Scene, compile};
use stickslip::{NoFiles, compile_with};

/// What the observer saw, and what came of stopping at its `last` call.
fn observed(scene: &Scene, last: usize) -> (Vec<Progress>, Option<Error>) {
    let mut seen = Vec::new();
    let outcome = compile_with(scene, &NoFiles, &mut |now| {
        seen.push(now);
        match seen.len() < last {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        }
    });
    (seen, outcome.err())
}

#[test]
fn progress_rises_to_one_through_the_phases_and_changes_nothing() {
    for model in ["full", "condensed", "reduced", "auto"] {
        let scene = paper(16, &[("fidelity.model", model)]);
        let (seen, error) = observed(&scene, usize::MAX);
        assert!(error.is_none(), "{error:?}");
        assert!(
            seen.is_sorted_by(|a, b| a.phase <= b.phase && a.fraction <= b.fraction),
            "{seen:?}"
        );
        assert_eq!(
            seen[0],
            Progress {
                phase: Phase::Assembly,
                fraction: 0.0
            }
        );
        assert_eq!(
            seen[seen.len() - 1],
            Progress {
                phase: Phase::Certificate,
                fraction: 1.0
            }
        );
        // a reduction tells of each of its factorizations
        let least = if model == "reduced" { 12 } else { 5 };
        assert!(seen.len() >= least, "{model}: {}", seen.len());
        let plain = compile(&scene).unwrap().fingerprint();
        let told = compile_with(&scene, &NoFiles, &mut |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(told.fingerprint(), plain);
    }
}

#[test]
fn stopping_at_any_call_is_the_last_call() {
    let scene = paper(8, &[]);
    let (all, _) = observed(&scene, usize::MAX);
    for last in 1..=all.len() {
        let (seen, error) = observed(&scene, last);
        assert_eq!(seen.len(), last);
        let error = error.unwrap();
        assert_eq!(
            error,
            Error::Cancelled {
                phase: all[last - 1].phase.name()
            }
        );
        assert_eq!(
            (error.code(), error.code() as i32),
            (ErrorCode::Cancelled, -17)
        );
    }
}

#[test]
fn a_search_for_a_target_is_stopped_too() {
    let scene = paper(8, &[("fidelity.target_error", "0.05")]);
    for last in [1, 3] {
        let (seen, error) = observed(&scene, last);
        assert_eq!(seen.len(), last);
        assert!(
            seen.iter()
                .all(|now| now.phase == Phase::Selection && now.fraction == 0.0)
        );
        assert!(matches!(error, Some(Error::Cancelled { .. })), "{error:?}");
    }
}
