//! The shared library as an importer sees it: its symbols, and what it asks of the system.

use std::process::Command;
use stickslip_fmu::find_library;

/// Functions of FMI 2.0 Co-Simulation and of FMI 3.0, counted in the standard's headers.
const FMI2: usize = 34;
const FMI3: usize = 75;

/// Nothing but the functions of the two standards is exported: a host that loads several FMUs must not find other names.
#[test]
fn exactly_the_functions_of_the_standards_are_exported() {
    let library = find_library().expect("the library was built");
    let output = Command::new("nm")
        .args(["-D", "--defined-only"])
        .arg(&library)
        .output();
    let output = output.expect("nm of binutils");
    let text = String::from_utf8(output.stdout).expect("names are ASCII");
    let names: Vec<&str> = text
        .lines()
        .filter_map(|l| l.split_whitespace().nth(2))
        .collect();
    let count = |prefix: &str| names.iter().filter(|n| n.starts_with(prefix)).count();
    assert_eq!((count("fmi2"), count("fmi3")), (FMI2, FMI3));
    assert_eq!(names.len(), FMI2 + FMI3, "{names:?}");
}
