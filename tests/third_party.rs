//! THIRD-PARTY-NOTICES.txt lists what is linked: every crate with its version in Cargo.lock, its licence and a text of it.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

fn read(name: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).unwrap()
}

/// The files, and the members of the workspace that what they come with is made of.
const NOTICES: [(&str, &[&str]); 2] = [
    ("THIRD-PARTY-NOTICES.txt", &["stickslip", "stickslip-fmu"]),
    ("python/THIRD-PARTY-NOTICES.txt", &["stickslip-python"]),
];

/// Name and version of every crate in the list of the notices.
fn listed(file: &str) -> BTreeSet<String> {
    let text = read(file);
    let list = text.split("\nCrates\n------\n").nth(1).unwrap();
    let list = list.split("\nLicence texts\n").next().unwrap();
    let crates: BTreeSet<_> = list
        .lines()
        .filter(|line| !line.is_empty())
        .map(|line| {
            let (name, rest) = line.split_once(" (").unwrap();
            let licence = rest.split(')').next().unwrap();
            assert!(licence.len() > 2, "{line}");
            name.to_owned()
        })
        .collect();
    // every one has a text, and no text is of something else
    let with_text: BTreeSet<_> = text
        .lines()
        .filter_map(|line| line.strip_prefix("Of ")?.strip_suffix(':'))
        .flat_map(|names| names.split(", "))
        .filter(|name| *name != "the Rust standard library")
        .map(str::to_owned)
        .collect();
    assert_eq!(crates, with_text);
    crates
}

#[test]
fn versions_are_those_of_the_lock_file() {
    let lock = read("Cargo.lock");
    let crates = NOTICES.map(|(file, _)| listed(file));
    assert!(crates.iter().all(|crates| crates.len() > 50));
    for name_and_version in crates.iter().flatten() {
        let (name, version) = name_and_version.split_once(' ').unwrap();
        let entry = format!("name = \"{name}\"\nversion = \"{version}\"\n");
        assert!(
            lock.contains(&entry),
            "{name_and_version}: run scripts/third_party_notices.py"
        );
    }
}

/// What cargo links on this machine is among them.
#[test]
fn every_crate_that_is_linked_is_listed() {
    for (file, members) in NOTICES {
        check_linked(&listed(file), members);
    }
}

fn check_linked(crates: &BTreeSet<String>, members: &[&str]) {
    let output = Command::new(env!("CARGO"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["tree", "--locked", "--offline"])
        .args(members.iter().flat_map(|member| ["-p", member]))
        .args([
            "-e",
            "normal,no-proc-macro",
            "--prefix",
            "none",
            "-f",
            "{p}",
        ])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let tree = String::from_utf8(output.stdout).unwrap();
    let mut count = 0;
    for line in tree.lines().filter(|line| !line.is_empty()) {
        let mut words = line.split_whitespace();
        let (name, version) = (words.next().unwrap(), words.next().unwrap());
        if !name.starts_with("stickslip") {
            let crate_of = format!("{name} {}", version.trim_start_matches('v'));
            assert!(crates.contains(&crate_of), "{crate_of} is not listed");
            count += 1;
        }
    }
    assert!(count > 40);
}
