//! Saved states, tables of ports, sweeps.

use super::*;

/// A scene whose signal jumps at a communication point, so that a state there is one behind the jump.
const JUMPING: &str = r#"{"schema_version": 1, "name": "pad", "clamped": ["left"], "time": {"step": 0.0625},
    "mesh": {"kind": "rectangle", "size": [1.0, 0.5], "cells": [8, 4]},
    "material": {"viscosity": {"law": "isotropic", "mu1": 0.05, "mu2": 0.1},
        "elasticity": {"law": "isotropic", "young": 1.0, "poisson": 0.3, "convention": "plane_strain"}},
    "contact": {"part": "bottom", "friction": {"law": "exponential", "a": 0.003, "b": 0.001, "alpha": 100.0}},
    "loads": [{"name": "press", "kind": "traction", "part": "top", "direction": [0, 1]}],
    "run": {"until": 1.0, "signals": {"press": [[0, -0.3], [0.5, -0.3], [0.5, -0.1], [1, -0.2]]}}}"#;

/// Lines of a file from the one that begins so on.
fn from(shell: &Shell, name: &str, start: &str) -> String {
    let text = std::fs::read_to_string(shell.folder.path().join(name)).unwrap();
    let at = text
        .find(start)
        .unwrap_or_else(|| panic!("{name} has no line {start}"));
    text[at..].to_owned()
}

#[test]
fn a_run_goes_on_from_a_saved_state_bit_for_bit() {
    let shell = Shell::new();
    shell.write("pad.json", JUMPING);
    let run = |more: &[&str]| {
        let arguments = [&["run", "pad.json"][..], more].concat();
        shell.succeed(&arguments)
    };
    run(&[
        "--csv",
        "whole.csv",
        "--ports",
        "whole_ports.csv",
        "--save-state",
        "whole.state",
    ]);
    // 0.5 is where the signal jumps: the shorter run ends before the jump, and what goes on begins behind it
    for number in ["0.4375", "0.5"] {
        run(&["--until", number, "--save-state", "half.state"]);
        let rest = [
            "--csv",
            "rest.csv",
            "--ports",
            "rest_ports.csv",
            "--save-state",
            "end.state",
        ];
        run(&[&["--load-state", "half.state"][..], &rest].concat());
        let bytes = |name: &str| std::fs::read(shell.folder.path().join(name)).unwrap();
        assert_eq!(bytes("end.state"), bytes("whole.state"));
        // the row at which it goes on is there again
        let start = format!("\n{number},");
        assert_eq!(
            from(&shell, "rest.csv", &start),
            from(&shell, "whole.csv", &start)
        );
        let next = "\n0.5625,";
        assert_eq!(
            from(&shell, "rest_ports.csv", next),
            from(&shell, "whole_ports.csv", next)
        );
    }
    let slip = shell.table("whole.csv").at(1.0, "slip");
    assert!(slip.iter().any(|s| s.abs() > 1e-4), "{slip:?}");
}

#[test]
fn checkpoints_are_on_the_way_of_a_run() {
    let shell = Shell::new();
    let ending = |last: &str| JUMPING.replace("[1, -0.2]", &format!("[0.9, -0.2], [1, {last}]"));
    // the run fails on its way; what was saved before stays
    shell.write("pad.json", &ending("-1e300"));
    let said = shell.fail(&[
        "run",
        "pad.json",
        "--save-state",
        "pad.state",
        "--checkpoint",
        "3",
    ]);
    assert!(said.contains("overflow"), "{said}");
    shell.write("pad.json", &ending("-0.25"));
    shell.succeed(&[
        "run",
        "pad.json",
        "--load-state",
        "pad.state",
        "--csv",
        "rest.csv",
    ]);
    let table = shell.table("rest.csv");
    // every third point: the last before 0.9 is number 12
    assert_eq!(table.columns["time"][0], 0.75);
    shell.succeed(&["run", "pad.json", "--csv", "whole.csv"]);
    assert_eq!(
        from(&shell, "rest.csv", "\n0.75,"),
        from(&shell, "whole.csv", "\n0.75,")
    );
    for (state, why) in [
        ("none.state", "No such file"),
        ("pad.json", "unusable bytes"),
    ] {
        let said = shell.fail(&["run", "pad.json", "--load-state", state]);
        assert!(said.contains(state) && said.contains(why), "{said}");
    }
    let said = shell.fail(&["run", "kazmi2014", "--load-state", "pad.state"]);
    assert!(said.contains("another model"), "{said}");
    assert_eq!(
        shell.run(&["run", "pad.json", "--checkpoint", "3"]).status,
        2
    );
}

#[test]
fn ports_are_tables_json_and_arrays() {
    let shell = Shell::new();
    shell.write("pad.json", JUMPING);
    let files = [
        "--ports", "p.csv", "--npz", "p.npz", "--json", "p.json", "--csv", "c.csv",
    ];
    shell.succeed(&[&["run", "pad.json"][..], &files].concat());
    let ports = shell.table("p.csv");
    assert_eq!(ports.rows, 17);
    assert_eq!(ports.header[..2], ["time", "press"]);
    assert!(
        !ports
            .header
            .iter()
            .any(|name| name.starts_with("contact.slip["))
    );
    assert_eq!(ports.at(0.25, "press"), [-0.3]);
    let work = ports.at(1.0, "energy.external_work")[0];
    assert!(work > 1e-4, "{work}");
    let text = std::fs::read_to_string(shell.folder.path().join("p.json")).unwrap();
    let said: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(said["internal_steps"], 16);
    assert_eq!(said["model"]["contact_nodes"], 8);
    assert!(said["friction_residual"].as_f64().unwrap() < 1e-9);
    assert!(said["energy_turned_over"].as_f64().unwrap() >= work);
    // the arrays of the NPZ are those of the table
    let file = std::fs::File::open(shell.folder.path().join("p.npz")).unwrap();
    let mut zip = zip::ZipArchive::new(file).unwrap();
    let mut array = |name: &str| {
        let mut bytes = Vec::new();
        let mut member = zip.by_name(&format!("{name}.npy")).unwrap();
        std::io::Read::read_to_end(&mut member, &mut bytes).unwrap();
        let len = usize::from(u16::from_le_bytes([bytes[8], bytes[9]])) + 10;
        assert_eq!((&bytes[..6], len % 64), (&b"\x93NUMPY"[..], 0));
        let header = String::from_utf8(bytes[10..len].to_vec()).unwrap();
        let numbers = bytes[len..]
            .chunks(8)
            .map(|b| f64::from_le_bytes(b.try_into().unwrap()));
        (header, numbers.collect::<Vec<_>>())
    };
    let (header, slip) = array("contact.slip");
    assert!(header.contains("'shape': (17, 8,)"), "{header}");
    assert_eq!(slip, shell.table("c.csv").columns["slip"]);
    assert_eq!(
        array("energy.external_work").1,
        ports.columns["energy.external_work"]
    );
    assert_eq!(array("contact.position").1.len(), 16);
    let outcome = shell.run(&["run", "pad.json", "--json", "-", "--csv", "-"]);
    assert_eq!(outcome.status, 1);
    let said = shell.run(&["run", "pad.json", "--json", "-"]);
    assert!(
        serde_json::from_str::<Value>(&said.stdout).is_ok(),
        "{}",
        said.stdout
    );
}

#[test]
fn a_sweep_is_one_table_whoever_takes_its_runs() {
    let shell = Shell::new();
    shell.write("pad.json", JUMPING);
    let sweep = [
        "sweep",
        "pad.json",
        "--vary",
        "contact.friction.b=0.0005:0.002:3",
        "--vary",
        "material.elasticity.young=1,2",
    ];
    let read = |name: &str| std::fs::read(shell.folder.path().join(name)).unwrap();
    let said = shell.succeed(&[&sweep[..], &["-o", "made/one.csv", "--workers", "1"]].concat());
    assert!(
        said.starts_with("made/one.csv: 6 runs, 6 of them taken now"),
        "{said}"
    );
    shell.succeed(&[&sweep[..], &["-o", "three.csv", "--workers", "3"]].concat());
    assert_eq!(read("made/one.csv"), read("three.csv"));
    assert!(!shell.has("three.csv.part"));
    let text = String::from_utf8(read("three.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().unwrap().clone();
    let first: Vec<&str> = header.iter().take(3).collect();
    assert_eq!(
        first,
        ["run", "contact.friction.b", "material.elasticity.young"]
    );
    let rows: Vec<_> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 6);
    // each row is that of a run of its own
    let force = header
        .iter()
        .position(|name| name == "contact.force")
        .unwrap();
    for row in &rows {
        let changes = [1, 2].map(|i| format!("{}={}", &header[i], &row[i]));
        shell.succeed(&[
            "run",
            "pad.json",
            "--set",
            &changes[0],
            "--set",
            &changes[1],
            "--ports",
            "alone.csv",
        ]);
        let alone = shell.table("alone.csv").at(1.0, "contact.force")[0];
        let found: f64 = row[force].parse().unwrap();
        assert!(
            (found - alone).abs() <= 1e-9 * alone.abs(),
            "{found}, not {alone}"
        );
    }
    // one that was ended goes on
    shell.succeed(&[&sweep[..], &["-o", "cut.csv", "--workers", "2", "--resume"]].concat());
    assert_eq!(read("cut.csv"), read("three.csv"));
    // samples, reductions and arrays
    let samples = [
        "sweep",
        "pad.json",
        "--vary",
        "contact.friction.alpha=10:200:log",
        "--sampling",
        "latin",
        "--runs",
        "8",
    ];
    let record = [
        "--record",
        "contact.slip",
        "--record",
        "contact.force:mean",
        "-o",
        "-",
    ];
    let outcome = shell.run(&[&samples[..], &record].concat());
    assert_eq!(outcome.status, 0, "{}", outcome.stderr);
    let header = "run,contact.friction.alpha,contact.slip[1],contact.slip[2],";
    assert!(outcome.stdout.starts_with(header), "{}", outcome.stdout);
    assert_eq!(outcome.stdout.lines().count(), 9);
    for (wrong, why) in [
        (
            ["contact.friction.b=-1:1:2", "x.csv"],
            "contact.friction.b: found -1",
        ),
        (["contact.friction.b", "x.csv"], "no path"),
        (["contact.friction.b=1", "x.parquet"], "Parquet"),
        (["contact.friktion.b=1", "x.csv"], "contact.friktion"),
    ] {
        let said = shell.fail(&["sweep", "pad.json", "--vary", wrong[0], "-o", wrong[1]]);
        assert!(said.contains(why), "{said}");
    }
    // runs that fail are rows, and the status tells
    let said = shell.fail(&[
        "sweep",
        "pad.json",
        "--vary",
        "run.signals.press=-0.3,-1e300",
        "--record",
        "contact.force",
        "-o",
        "bad.csv",
    ]);
    assert!(
        said.contains("1 of 2 runs failed; run 1: numbers overflow"),
        "{said}"
    );
    let text = String::from_utf8(read("bad.csv")).unwrap();
    assert!(
        text.lines()
            .nth(2)
            .unwrap()
            .starts_with("1,-1e300,NaN,\"numbers overflow"),
        "{text}"
    );
}
