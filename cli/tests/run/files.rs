//! Standard streams, files of editors, runs that would not end, files of earlier runs.

use super::*;

/// The scene from standard input is the scene from a file, and a table on standard output is the table in a file.
#[test]
fn standard_input_and_output_take_the_place_of_files() {
    let shell = Shell::new();
    let scene = shell.succeed(&["example", "sheared_column"]);
    shell.write("scene.json", &scene);
    let table = shell.succeed(&["run", "scene.json", "--csv", "a.csv"]);
    let expected = std::fs::read_to_string(shell.folder.path().join("a.csv")).unwrap();
    let outcome = shell.feed(&["run", "-", "--csv", "-"], scene.as_bytes());
    assert_eq!(outcome.status, 0, "{}", outcome.stderr);
    assert_eq!(outcome.stdout, expected);
    // what is said of the run is beside it
    let of = |text: &str, name: &str| {
        let line = text.lines().find(|l| l.contains(name)).map(str::to_owned);
        line.unwrap_or_else(|| panic!("no {name} in {text}"))
    };
    assert_eq!(
        of(&outcome.stderr, "contact nodes"),
        of(&table, "contact nodes")
    );
    assert!(!shell.has("-"));
    let checked = shell.feed(&["check", "-", "--set", "time.step=0.01"], scene.as_bytes());
    assert_eq!(checked.status, 0);
    assert!(checked.stdout.starts_with("standard input: valid"));
    let broken = shell.feed(&["check", "-"], b"{}");
    assert_eq!((broken.status, broken.stdout.as_str()), (1, ""));
    assert!(
        broken.stderr.contains("standard input: at schema_version"),
        "{}",
        broken.stderr
    );
    // a file of that name has another
    shell.write("-", &scene);
    assert!(shell.succeed(&["check", "./-"]).starts_with("./-: valid"));
    // a reader that has seen enough is no failure
    let mut child = shell.command(&["run", "kazmi2014", "--csv", "-"]);
    let mut child = child
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert!(child.wait().unwrap().success());
}

#[test]
fn files_of_windows_editors_are_read_or_named() {
    let shell = Shell::new();
    let scene = shell.succeed(&["example", "sheared_column"]);
    shell.write("bom.json", &format!("\u{feff}{scene}"));
    shell.succeed(&["check", "bom.json"]);
    let utf16: Vec<u8> = [0xff, 0xfe]
        .into_iter()
        .chain(scene.encode_utf16().flat_map(u16::to_le_bytes))
        .collect();
    std::fs::write(shell.folder.path().join("utf16.json"), utf16).unwrap();
    let line = shell.fail(&["check", "utf16.json"]);
    assert!(
        line.contains("utf16.json: cannot read: its byte-order mark says UTF-16"),
        "{line}"
    );
    std::fs::write(
        shell.folder.path().join("latin.json"),
        b"{\"name\": \"Gr\xf6\xdfe\"}",
    )
    .unwrap();
    assert!(shell.fail(&["check", "latin.json"]).contains("UTF-8"));
}

/// Refused at once, with the number of steps; under 1e9 of them a run is taken.
#[test]
fn runs_that_would_not_end_are_refused() {
    let shell = Shell::new();
    for (options, expected) in [
        (
            vec!["--set", "time.step=1e-300", "--until", "0.1"],
            "1.0e299 steps of time.step = 1e-300",
        ),
        (
            vec!["--until", "1e300"],
            "3.2e301 steps of time.step = 0.03125",
        ),
        (
            vec!["--step", "1e-300"],
            "1.0e300 steps of run.step = 1e-300",
        ),
        (
            vec!["--step", "1e300", "--until", "1e300"],
            "3.2e301 steps of time.step = 0.03125",
        ),
        (
            vec!["--set", "run.step=1e-12"],
            "1.0e12 steps of run.step = 1e-12",
        ),
    ] {
        let line = shell.fail(&[&["run", "kazmi2014"], &options[..]].concat());
        assert!(
            line.contains(expected) && line.contains("at most 1e9 steps"),
            "{line}"
        );
        assert!(line.contains("kazmi2014: at run.until"), "{line}");
    }
    let line = shell.fail(&["tradeoff", "kazmi2014", "--set", "run.step=1e-300"]);
    assert!(line.contains("1.0e300 steps"), "{line}");
}

/// A shorter run into the same folder leaves no files of the longer one; what is not its own stays.
#[test]
fn a_shorter_run_leaves_no_files_of_the_longer_one() {
    let shell = Shell::new();
    let files = || {
        let entries = std::fs::read_dir(shell.folder.path().join("v")).unwrap();
        let mut names: Vec<String> = entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    };
    shell.succeed(&["run", "sheared_column", "--until", "0.2", "--vtk", "v"]);
    assert_eq!(files().len(), 12);
    let others = [
        "sheared_column.vtk",
        "sheared_column_1.vtk",
        "sheared_column_00001.vtk.bak",
        "sheared_column_x0001.vtk",
        "seal_00001.vtk",
    ];
    others
        .iter()
        .for_each(|name| shell.write(&format!("v/{name}"), "x"));
    shell.succeed(&["run", "sheared_column", "--until", "0.04", "--vtk", "v"]);
    let left = files();
    assert_eq!(left.len(), 4 + others.len(), "{left:?}");
    assert!(others.iter().all(|name| left.contains(&name.to_string())));
    assert!(!left.contains(&"sheared_column_00003.vtk".to_string()));
    // a run that is refused before it begins removes nothing
    shell.fail(&["run", "sheared_column", "--until", "1e300", "--vtk", "v"]);
    assert_eq!(files(), left);
}
