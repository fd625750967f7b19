//! `stickslip tradeoff`: the table, the CSV, the Pareto front, the budget; and `fidelity.target_error` in the other commands.
//! Nothing here depends on how fast the machine is: what is measured is counted in work, and costs are only compared within one
//! CSV.

mod common;

use common::Shell;
use std::collections::BTreeMap;

/// The paper's example, small: 8 x 4 cells, 4 steps.
const SMALL: [&str; 8] = [
    "tradeoff",
    "kazmi2014",
    "--set",
    "mesh.cells=[8,4]",
    "--set",
    "time.step=0.125",
    "--set",
    "run.until=0.5",
];

struct Row(BTreeMap<String, String>);

impl Row {
    fn text(&self, column: &str) -> &str {
        &self.0[column]
    }

    /// `None` for an empty cell.
    fn number(&self, column: &str) -> Option<f64> {
        let text = self.text(column);
        (!text.is_empty()).then(|| text.parse().unwrap())
    }
}

fn rows(shell: &Shell, name: &str) -> Vec<Row> {
    let mut reader = csv::Reader::from_path(shell.folder.path().join(name)).unwrap();
    let header: Vec<String> = reader.headers().unwrap().iter().map(Into::into).collect();
    let records = reader.records().map(|record| {
        let record = record.unwrap();
        assert_eq!(record.len(), header.len());
        let cells = header.iter().cloned().zip(record.iter().map(str::to_owned));
        Row(cells.collect())
    });
    records.collect()
}

#[test]
fn the_table_the_csv_and_the_picture_tell_what_was_measured() {
    let shell = Shell::new();
    let options = [
        "--work",
        "1e9",
        "--csv",
        "made/here.csv",
        "--plots",
        "p",
        "--markdown",
        "read.md",
    ];
    let (begin, end) = (
        "<!-- tradeoff kazmi2014: begin -->\n",
        "<!-- tradeoff kazmi2014: end -->\n",
    );
    shell.write("read.md", &format!("# Before\n{begin}old\n{end}after\n"));
    let printed = shell.succeed(&[&SMALL[..], &options].concat());
    let rows = rows(&shell, "made/here.csv");
    assert_eq!(rows[0].text("group"), "as given");
    assert_eq!(rows[0].text("set"), "the scene as it is");
    for promised in [
        "reference, and what is left in it",
        "slip rate",
        "as given",
        "for 10 % in slip rate use ",
        " settings measured in ",
    ] {
        assert!(
            printed.contains(promised),
            "{promised} is not in\n{printed}"
        );
    }
    assert!(shell.has("p/tradeoff.png") && shell.has("p/tradeoff.svg"));

    let text = std::fs::read_to_string(shell.folder.path().join("read.md")).unwrap();
    let (before, rest) = text.split_once(begin).unwrap();
    let (table, after) = rest.split_once(end).unwrap();
    assert_eq!((before, after), ("# Before\n", "after\n"));
    assert!(table.starts_with("`stickslip tradeoff kazmi2014 --set 'mesh.cells=[8,4]'"));
    for promised in [
        "| as given | ",
        "| full | ",
        "* for 10 % in slip rate use `--set",
    ] {
        assert!(table.contains(promised), "{promised} is not in\n{table}");
    }
    assert!(!table.contains("old"));

    // steps that a tolerance chooses are among the settings
    for group in ["steps", "joint"] {
        let is_chosen = |r: &&Row| r.text("set").contains("time.tolerance=1e-1");
        let of_group = rows.iter().filter(|r| r.text("group") == group);
        assert!(of_group.filter(is_chosen).count() > 0, "{group}");
    }

    // numbers are numbers: shortest text that reads back equal, and not negative
    for row in &rows {
        for (column, text) in &row.0 {
            if column != "group" && column != "set" && !text.is_empty() {
                let value: f64 = text.parse().unwrap();
                let is_integer = text.parse::<u64>().is_ok();
                assert!(
                    is_integer || format!("{value:?}") == *text,
                    "{column}: {text}"
                );
                assert!(value >= 0.0, "{column}: {text}");
            }
        }
    }

    // errors fall with the cells
    let cells: Vec<(f64, f64)> = rows
        .iter()
        .filter(|r| ["as given", "cells"].contains(&r.text("group")))
        .filter_map(|r| Some((r.number("nodes")?, r.number("error_slip_rate")?)))
        .collect();
    let mut by_nodes = cells.clone();
    by_nodes.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(by_nodes.len() >= 3, "{by_nodes:?}");
    assert!(by_nodes.windows(2).all(|w| w[1].1 < w[0].1), "{by_nodes:?}");

    // an error is a figure or empty, never more than its bound
    for row in &rows {
        for quantity in ["slip_rate", "tangential_stress", "displacement"] {
            let bound = row.number(&format!("bound_{quantity}")).unwrap();
            let error = row.number(&format!("error_{quantity}"));
            assert!(error.is_none_or(|e| e < bound), "{quantity}");
        }
    }
    front_is_one(&rows);
}

/// No other point costs less and is more accurate, and the points of the front are ordered.
fn front_is_one(rows: &[Row]) {
    let points: Vec<(f64, f64, bool)> = rows
        .iter()
        .filter_map(|r| {
            let is_on = r.text("front_slip_rate") == "1";
            Some((
                r.number("seconds_per_second")?,
                r.number("error_slip_rate")?,
                is_on,
            ))
        })
        .collect();
    let mut front: Vec<_> = points.iter().filter(|p| p.2).collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(front.len() >= 2);
    assert!(front.windows(2).all(|w| w[0].0 < w[1].0 && w[1].1 < w[0].1));
    for on in &front {
        let beats =
            |p: &&(f64, f64, bool)| p.0 <= on.0 && p.1 <= on.1 && (p.0, p.1) != (on.0, on.1);
        assert_eq!(points.iter().find(beats), None, "{on:?}");
    }
    // every point is beaten by one of the front, up to the five per cent that are not worth a higher cost
    for point in &points {
        assert!(
            front
                .iter()
                .any(|on| on.0 <= point.0 && 0.95 * on.1 <= point.1)
        );
    }
}

/// The sentences name settings that a user can paste.
#[test]
fn the_settings_of_the_sentences_can_be_pasted() {
    let shell = Shell::new();
    let printed = shell.succeed(&[&SMALL[..], &["--work", "1e8"]].concat());
    let sentence = printed
        .lines()
        .find(|line| line.starts_with("for 10 % in slip rate use --set"))
        .unwrap();
    let words = pasted(sentence);
    let table = shell.succeed(&[&["run"], &SMALL[1..], &words].concat());
    assert!(table.contains("contact nodes"));
}

/// The arguments that a sentence names, as a shell splits them.
fn pasted(sentence: &str) -> Vec<&str> {
    let arguments = sentence.split(" use ").nth(1).unwrap();
    let arguments = arguments.split(" (").next().unwrap().trim_matches('`');
    let words = arguments.split(' ');
    words.map(|word| word.trim_matches('\'')).collect()
}

const MEASURED: &str = include_str!("../../docs/measured.md");

/// The page of measurements names settings that a user can paste; those of the finest mesh take too long for a test.
#[test]
fn the_settings_of_the_page_are_valid() {
    let sentences = MEASURED.lines().filter(|l| l.starts_with("* for "));
    let sentences: Vec<&str> = sentences.filter(|l| !l.contains("[128,64]")).collect();
    assert!(sentences.len() >= 4, "{sentences:?}");
    for sentence in sentences {
        let words = pasted(sentence);
        let checked = Shell::new().succeed(&[&["check", "kazmi2014"], &words[..]].concat());
        assert!(checked.starts_with("kazmi2014: valid"), "{sentence}");
    }
}

/// The page has the place into which the command that it names writes, and keeps what stands around it.
#[test]
fn the_page_of_measurements_can_be_written_anew() {
    let command = "stickslip tradeoff kazmi2014 --budget 120 --markdown docs/measured.md";
    assert!(MEASURED.contains(command));
    let shell = Shell::new();
    shell.write("measured.md", MEASURED);
    shell.succeed(&[&SMALL[..], &["--work", "1e8", "--markdown", "measured.md"]].concat());
    let written = std::fs::read_to_string(shell.folder.path().join("measured.md")).unwrap();
    let around = |text: &str| -> [String; 2] {
        let before = text
            .split_once("<!-- tradeoff kazmi2014: begin -->")
            .unwrap();
        let after = text.split_once("<!-- tradeoff kazmi2014: end -->").unwrap();
        [before.0.to_owned(), after.1.to_owned()]
    };
    assert_eq!(around(&written), around(MEASURED));
    assert!(written != MEASURED && written.contains("mesh.cells=[8,4]"));
}

/// Work is counted, not timed: the same settings are measured again.
#[test]
fn a_budget_of_work_measures_the_same_settings_on_every_machine() {
    let shell = Shell::new();
    let settings = |work: &str, file: &str| -> Vec<String> {
        shell.succeed(&[&SMALL[..], &["--work", work, "--csv", file]].concat());
        let settings = rows(&shell, file);
        settings.iter().map(|r| r.text("set").to_owned()).collect()
    };
    let (once, again) = (settings("1e7", "a.csv"), settings("1e7", "b.csv"));
    assert_eq!(once, again);
    assert!(once.len() < settings("1e8", "c.csv").len());
}

#[test]
fn without_a_budget_the_scene_alone_is_measured_and_the_rest_is_named() {
    let shell = Shell::new();
    let printed = shell.succeed(&[&SMALL[..], &["--budget", "0", "--csv", "a.csv"]].concat());
    let rows = rows(&shell, "a.csv");
    assert_eq!(rows.len(), 1);
    assert_eq!(rows[0].text("group"), "as given");
    assert!(printed.contains("1 settings measured"));
    let left_out = printed
        .lines()
        .find(|line| line.starts_with("not measured"))
        .unwrap();
    for setting in [
        "mesh.cells=[4,2]",
        "time.step=0.0625",
        "time.scheme=tr_bdf2",
    ] {
        assert!(left_out.contains(setting), "{setting} is not in {left_out}");
    }
}

/// What may not fit the memory is named, and not compiled.
#[test]
fn what_is_too_large_is_not_compiled() {
    let shell = Shell::new();
    let printed = shell.succeed(&["tradeoff", "brake_pad_3d", "--budget", "0"]);
    let line = printed
        .lines()
        .find(|line| line.starts_with("not compiled, because by estimate it takes more than"))
        .unwrap();
    assert!(line.contains("mesh.cells=[64,12,32] ("), "{line}");
    let large = ["--set", "mesh.cells=[64,12,32]"];
    let line = shell.fail(&[&["tradeoff", "brake_pad_3d"][..], &large].concat());
    assert!(line.contains("brake_pad_3d: at mesh.cells"), "{line}");
    assert!(line.contains("GB of memory"), "{line}");
}

#[test]
fn mistakes_are_told_as_by_the_other_commands() {
    let shell = Shell::new();
    assert_eq!(shell.run(&["tradeoff"]).status, 2);
    for budget in ["-1", "soon", "inf"] {
        for option in ["--budget", "--work"] {
            let arguments = [&SMALL[..], &[option, budget]].concat();
            assert_eq!(shell.run(&arguments).status, 2, "{option} {budget}");
        }
    }
    let both = [&SMALL[..], &["--budget", "1", "--work", "1e8"]].concat();
    assert_eq!(shell.run(&both).status, 2);
    let line = shell.fail(&["tradeoff", "nowhere.json"]);
    assert!(line.contains("nowhere.json"));
    let line = shell.fail(&["tradeoff", "seal", "--set", "contact.friction.bound=-1"]);
    assert!(line.contains("seal: at contact.friction.bound"));
    let still = ["--set", "loads[0].start=0", "--set", "run.signals={}"];
    let line = shell.fail(&[&SMALL[..], &still].concat());
    assert!(line.contains("kazmi2014: at run.signals"), "{line}");
    shell.write("file", "");
    let line = shell.fail(&[&SMALL[..], &["--budget", "0", "--csv", "file/x.csv"]].concat());
    assert!(line.contains("cannot write"));
    let line = shell.fail(&[&SMALL[..], &["--budget", "0", "--markdown", "file"]].concat());
    assert!(
        line.contains("no lines <!-- tradeoff kazmi2014: begin -->"),
        "{line}"
    );
}

#[test]
fn a_target_is_told_with_what_was_picked() {
    let shell = Shell::new();
    let asked = ["--set", "fidelity.target_error=0.2"];
    for command in ["run", "check"] {
        let printed = shell.succeed(&[&[command], &SMALL[1..], &asked].concat());
        let row = printed
            .lines()
            .find(|line| line.trim_start().starts_with("target error"))
            .unwrap();
        for promised in ["0.2: picked ", "settings", "slip rate", "friction force"] {
            assert!(row.contains(promised), "{promised} is not in {row}");
        }
    }
    let line = shell.fail(&[
        "check",
        "brake_pad_3d",
        "--set",
        "fidelity.target_error=0.001",
        "--set",
        "run.until=0.1",
    ]);
    assert!(
        line.contains("at fidelity.target_error: found 0.001"),
        "{line}"
    );
}
