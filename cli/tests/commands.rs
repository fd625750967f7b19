//! The commands beside `run`: what they print, how they fail, and that the paper is reproduced.

mod common;

use common::Shell;
use std::io::Read;
use std::process::Stdio;

#[test]
fn schema_is_the_library_s() {
    let printed = Shell::new().succeed(&["schema"]);
    assert_eq!(
        printed.trim_end(),
        stickslip::scene::json_schema().trim_end()
    );
}

#[test]
fn examples_are_listed_and_printed_as_scenes() {
    let shell = Shell::new();
    let names = shell.succeed(&["example"]);
    let names: Vec<_> = names.lines().collect();
    assert_eq!(names, stickslip::scene::example_names().collect::<Vec<_>>());
    for name in names {
        let text = shell.succeed(&["example", name]);
        shell.write("scene.json", &text);
        let from_file = shell.succeed(&["check", "scene.json", "--set", "name=x"]);
        assert!(from_file.starts_with("scene.json: valid"));
    }
    assert!(shell.fail(&["example", "unknown"]).contains("kazmi2014"));
}

#[test]
fn check_prints_ports_certificate_rates_and_step() {
    let shell = Shell::new();
    let printed = shell.succeed(&["check", "kazmi2014"]);
    let words: Vec<_> = printed.split_whitespace().collect();
    let printed = words.join(" ");
    for promised in [
        "c0²",
        "L_g 0.200000 Pa s/m",
        "m_A 0.100000 Pa s",
        "does not hold: c0² L_g = 0.24",
        "(3.6) guarantees no step",
        "does not hold at time.step = 0.03125",
        // measured by an independent solver: the relaxation rates lie in [7.69, 14.56]
        "7.6923 to 14.5604 1/s",
        // 1 / (2 14.56)
        "0.034340 s (k r <= 1/2",
        "contact.tangential_stress",
        "press.displacement",
        "solver.residual",
        "contact.friction.alpha",
        "parameter",
        "input",
    ] {
        assert!(
            printed.contains(promised),
            "{promised} is not in\n{printed}"
        );
    }
    assert!(!printed.contains("lost digits"));
    // steps of 1e14 relaxation times: the sums of the trapezoid cancel, those of an L-stable scheme do not
    let stiff = [
        "check",
        "kazmi2014",
        "--set",
        "material.elasticity.young=1e15",
    ];
    let told = shell.succeed(&stiff);
    assert!(
        told.contains("lost digits") && told.contains("backward_euler"),
        "{told}"
    );
    let stable = [&stiff[..], &["--set", "time.scheme=backward_euler"]].concat();
    assert!(!shell.succeed(&stable).contains("lost digits"));
    let unstable = shell.run(&[
        "check",
        "kazmi2014",
        "--set",
        "time.scheme=rectangle",
        "--set",
        "time.step=0.2",
    ]);
    // the table with the limit is shown, but the scene is refused
    assert_eq!(unstable.status, 1);
    assert!(
        unstable.stdout.contains("UNSTABLE") && unstable.stdout.contains("refused for its step")
    );
    assert!(unstable.stderr.contains("stability limit"));
}

#[test]
fn errors_are_one_line_with_file_and_path() {
    let shell = Shell::new();
    shell.write("broken.json", "{\"schema_version\": 1,\n");
    shell.write("empty.json", "{}");
    for (arguments, expected) in [
        (
            vec!["run", "nowhere.json"],
            vec!["nowhere.json", "kazmi2014"],
        ),
        (vec!["run", "."], vec!["cannot read"]),
        (vec!["check", "broken.json"], vec!["broken.json"]),
        (vec!["check", "empty.json"], vec!["empty.json: at "]),
        (
            vec!["run", "seal", "--set", "contact.friction.bound=-1"],
            vec!["seal: at contact.friction.bound", "-1"],
        ),
        (
            vec!["run", "seal", "--set", "contact.friction.bond=1"],
            vec!["seal: at contact.friction", "bond"],
        ),
        (
            vec!["run", "seal", "--set", "contact.part=roof"],
            vec!["seal: at contact.part", "roof"],
        ),
        (
            vec!["run", "seal", "--until", "-1"],
            vec!["seal: at run.until", "-1"],
        ),
        (
            vec!["run", "seal", "--step", "0"],
            vec!["seal: at run.step"],
        ),
        (
            // two iterations do not settle the slip-weakening law
            vec![
                "run",
                "kazmi2014",
                "--set",
                "fidelity.solver={\"kind\":\"fixed_point\",\"max_iterations\":2}",
            ],
            vec!["kazmi2014: friction did not converge at time"],
        ),
        (
            vec!["run", "seal", "--csv", "empty.json/x.csv"],
            vec!["empty.json", "cannot write"],
        ),
        (
            vec!["run", "seal", "--plots", "empty.json"],
            vec!["empty.json", "cannot write"],
        ),
        (
            vec!["run", "seal", "--vtk", "empty.json"],
            vec!["empty.json", "cannot write"],
        ),
    ] {
        let line = shell.fail(&arguments);
        for part in expected {
            assert!(line.contains(part), "{part} is not in {line}");
        }
    }
}

#[test]
fn mistakes_in_the_use_are_status_2() {
    let shell = Shell::new();
    for arguments in [
        vec!["walk"],
        vec!["run"],
        vec!["run", "seal", "--set", "novalue"],
        vec!["run", "seal", "--until", "soon"],
    ] {
        assert_eq!(shell.run(&arguments).status, 2, "{arguments:?}");
    }
    assert_eq!(shell.run(&["--help"]).status, 0);
    assert!(shell.succeed(&["--version"]).starts_with("stickslip "));
}

#[test]
fn set_changes_the_scene() {
    let shell = Shell::new();
    let friction = r#"contact.friction={"law": "frictionless"}"#;
    shell.succeed(&["run", "kazmi2014", "--set", friction, "--csv", "a.csv"]);
    let stress = &shell.table("a.csv").columns["tangential_stress"];
    // the stress is what is left of forces of the order of 0.1 N
    assert!(stress.iter().all(|s| s.abs() < 1e-12), "{stress:?}");
}

/// A reader that leaves does not stop the work, nor its success.
#[test]
fn a_closed_pipe_is_no_panic() {
    let shell = Shell::new();
    for arguments in [vec!["schema"], vec!["run", "seal", "--csv", "a.csv"]] {
        let mut child = shell
            .command(&arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let mut stderr = String::new();
        let pipe = child.stderr.as_mut().unwrap();
        pipe.read_to_string(&mut stderr).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(0), "{stderr}");
        assert_eq!(stderr, "");
    }
    assert!(shell.has("a.csv"));
}

const FIGURES: [&str; 4] = ["figure3", "figures5and6", "figure7", "overview"];

/// Numbers the paper reports (2210 and 132354 dofs, 7.2 iterations, 49 s) and those an independent solver found for its
/// iteration (14.4 and 5.3).
const NUMBERS: [&str; 6] = ["2210", "132354", "7.2", "14.4", "5.3", "49 s"];

#[test]
fn the_main_job_compares_with_the_paper() {
    let shell = Shell::new();
    let printed = shell.succeed(&[]);
    for number in NUMBERS {
        assert!(printed.contains(number), "{number} is not in\n{printed}");
    }
    for figure in FIGURES.iter().chain(&["contact", "stick_slip", "energies"]) {
        assert!(shell.has(&format!("out/{figure}.png")), "{figure}");
        assert!(shell.has(&format!("out/{figure}.svg")), "{figure}");
    }
    assert_eq!(shell.table("out/kazmi2014.csv").rows, 33 * 32);
    // an FMU, or why there is none: a build of tests has a library that must not be packed
    assert!(shell.has("out/kazmi2014.fmu") != printed.contains("no FMU: kazmi2014: "));
    // the last iterates of Figure 7 lie on the law, g(r) = 0.002 exp(-100 r) + 0.001
    let iterates = shell.table("out/figure7.csv");
    let column = |name: &str| &iterates.columns[name];
    for i in 0..iterates.rows {
        let is_last = i + 1 == iterates.rows || column("iterate")[i + 1] == 1.0;
        if is_last {
            let bound = 0.002 * (-100.0 * column("slip_rate")[i]).exp() + 0.001;
            let found = column("friction_stress")[i];
            assert!((found - bound).abs() < 1e-7, "{found}, not {bound}");
        }
    }
    assert_eq!(column("step").last(), Some(&10.0));
    // the foundation holds the body up: forces along y of 0.3 N but for the share of the clamped side
    let forces = shell.table("out/figure3.csv");
    let upward: f64 = forces.columns["force_y"].iter().sum();
    assert!((0.2..0.3).contains(&upward), "{upward}");
}

#[test]
fn the_quick_paper_has_every_figure() {
    let shell = Shell::new();
    let printed = shell.succeed(&["paper", "--quick", "--out", "p"]);
    for number in NUMBERS {
        assert!(printed.contains(number), "{number} is not in\n{printed}");
    }
    for figure in FIGURES.iter().chain(&["figure4"]) {
        assert!(shell.has(&format!("p/{figure}.png")), "{figure}");
    }
    let errors = shell.table("p/figure4.csv");
    assert_eq!(errors.columns["h"], [0.5, 0.25, 0.125, 0.0625, 0.03125]);
    for start in ["largest_zero_start", "largest_consistent_start"] {
        let column = &errors.columns[start];
        assert!(column.windows(2).all(|w| w[1] < w[0]), "{start}");
    }
}

/// Figure 4 against the errors of an independent solver, digit by digit.
#[test]
fn errors_are_those_of_the_independent_solver() {
    let shell = Shell::new();
    shell.succeed(&["paper", "--out", "p"]);
    let errors = shell.table("p/figure4.csv");
    let expected = [
        8.369e-2, 7.494e-2, 5.707e-2, 3.558e-2, 1.899e-2, 8.719e-3, 3.186e-3,
    ];
    let found = &errors.columns["largest_zero_start"];
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 2e-4, "{found}");
    }
}

#[test]
fn qvi_prints_errors_orders_and_conditions() {
    let printed = Shell::new().succeed(&["qvi"]);
    let row = |name: &str| -> Vec<String> {
        let line = printed.lines().find(|line| line.starts_with(name));
        let line = line.unwrap_or_else(|| panic!("{name} is not in\n{printed}"));
        line.split_whitespace().map(str::to_owned).collect()
    };
    for (i, (trapezoid, rectangle)) in [(2.0, 1.0); 6].into_iter().enumerate() {
        for (rule, order) in [("trapezoid", trapezoid), ("rectangle", rectangle)] {
            let cells = row(&format!("P{} {rule}", i + 1));
            let found: f64 = cells.last().unwrap().parse().unwrap();
            assert!((found / order - 1.0).abs() < 0.03, "{cells:?}");
        }
    }
    // the errors of an independent script
    assert_eq!(row("P1 trapezoid")[2..4], ["1.444e-3", "3.614e-4"]);
    assert_eq!(
        row("trapezoid, 32")[2..6],
        ["1.256e-1", "6.292e-2", "3.147e-2", "1.574e-2"]
    );
    for condition in ["(2.6)", "(3.6)", "0.0750", "holds"] {
        assert!(
            printed.contains(condition),
            "{condition} is not in\n{printed}"
        );
    }
}
