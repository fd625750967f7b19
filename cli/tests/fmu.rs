//! The command `fmu`: what is in the file, what is said about it, how it fails. Importers load it in fmu/tests.

mod common;

use common::Shell;
use std::collections::BTreeMap;
use std::io::Read;

/// What the packager reads of a library: the glibc versions that its symbols ask for. It is not loaded here.
const LIBRARY: &str = "\0GLIBC_2.2.5\0GLIBC_2.17\0GLIBC_PRIVATE\0";

fn files(shell: &Shell, name: &str) -> BTreeMap<String, Vec<u8>> {
    let file = std::fs::File::open(shell.folder.path().join(name)).unwrap();
    let mut archive = zip::ZipArchive::new(file).unwrap();
    (0..archive.len())
        .map(|i| {
            let mut entry = archive.by_index(i).unwrap();
            let mut bytes = Vec::new();
            entry.read_to_end(&mut bytes).unwrap();
            (entry.name().to_owned(), bytes)
        })
        .collect()
}

fn shell() -> Shell {
    let shell = Shell::new();
    shell.write("pad.so", LIBRARY);
    std::fs::create_dir(shell.folder.path().join("portable")).unwrap();
    shell.write("portable/pad.so", LIBRARY);
    shell
}

#[test]
fn the_library_given_is_packed_with_the_scene_as_changed() {
    let shell = shell();
    for (options, version, folder, array) in [
        (
            &["--fmi", "2"][..],
            "2.0",
            "linux64",
            "contact.slip_rate[7]",
        ),
        (&["--fmi", "3"], "3.0", "x86_64-linux", "contact.slip_rate"),
        (&[], "3.0", "x86_64-linux", "contact.slip_rate"),
        (&["--scalar"], "3.0", "x86_64-linux", "contact.slip_rate[7]"),
    ] {
        let base = [
            "fmu",
            "kazmi2014",
            "-o",
            "new/pad.fmu",
            "--library",
            "pad.so",
        ];
        let set = ["--set", "contact.friction.alpha=50"];
        let printed = shell.succeed(&[&base[..], &set[..], options].concat());
        let told = [
            "new/pad.fmu",
            &format!("FMI {version}"),
            "native library pad.so",
        ];
        for part in told.iter().chain(&["needs glibc 2.17 or newer"]) {
            assert!(printed.contains(part), "{part} is not in {printed}");
        }
        assert_eq!(printed.lines().count(), 1);
        let files = files(&shell, "new/pad.fmu");
        if cfg!(all(target_os = "linux", target_arch = "x86_64")) {
            let binary = &files[&format!("binaries/{folder}/stickslip_fmu.so")];
            assert_eq!(binary, LIBRARY.as_bytes());
        }
        let text = |name: &str| String::from_utf8(files[name].clone()).unwrap();
        let description = text("modelDescription.xml");
        assert!(description.contains(&format!("fmiVersion=\"{version}\"")));
        assert!(description.contains(&format!("name=\"{array}\"")));
        let scenes: Vec<_> = files.keys().filter(|n| n.ends_with(".json")).collect();
        assert_eq!(scenes.len(), 1, "{scenes:?}");
        let scene: serde_json::Value = serde_json::from_str(&text(scenes[0])).unwrap();
        assert_eq!(scene["contact"]["friction"]["alpha"], 50.0);
    }
}

/// The page draws every triangle of a quadratic mesh by its three corners, and a dot at every contact node.
#[test]
fn the_documentation_draws_a_quadratic_mesh() {
    let shell = shell();
    let base = ["fmu", "kazmi2014", "-o", "a.fmu", "--library", "pad.so"];
    let set = ["--set", "element=p2", "--set", "mesh.cells=[8,4]"];
    shell.succeed(&[&base[..], &set[..]].concat());
    let page =
        String::from_utf8(files(&shell, "a.fmu")["documentation/index.html"].clone()).unwrap();
    let path = page
        .split(" d=\"")
        .nth(1)
        .unwrap()
        .split('"')
        .next()
        .unwrap();
    let triangles: Vec<_> = path.split_terminator('Z').collect();
    assert_eq!(triangles.len(), 128);
    assert!(triangles.iter().all(|t| t.matches('L').count() == 2));
    assert_eq!(page.matches("<circle").count(), 16);
    assert!(
        page.contains("128 cells, 281 nodes, 528 free displacement components; 16 contact nodes")
    );
}

#[test]
fn a_library_of_the_portable_build_is_called_so() {
    let printed = shell().succeed(&["fmu", "seal", "-o", "a.fmu", "--library", "portable/pad.so"]);
    assert!(
        printed.contains("portable library portable/pad.so"),
        "{printed}"
    );
}

#[test]
fn errors_are_one_line_and_leave_no_file() {
    let shell = shell();
    shell.write("empty.json", "{}");
    for (arguments, expected) in [
        (vec!["nowhere.json"], vec!["nowhere.json", "kazmi2014"]),
        (vec!["empty.json"], vec!["empty.json: at "]),
        (
            vec!["seal", "--set", "contact.friction.bound=-1"],
            vec!["seal: at contact.friction.bound", "-1"],
        ),
        (
            vec!["seal", "--fmi", "2", "--scalar"],
            vec!["--scalar is for --fmi 3"],
        ),
        (
            vec!["seal", "--library", "missing.so"],
            vec!["seal: missing.so"],
        ),
    ] {
        let line = shell.fail(&[&["fmu", "-o", "a.fmu"], &arguments[..]].concat());
        for part in expected {
            assert!(line.contains(part), "{part} is not in {line}");
        }
        assert!(!shell.has("a.fmu"));
    }
    let line = shell.fail(&[
        "fmu",
        "seal",
        "--library",
        "pad.so",
        "-o",
        "empty.json/a.fmu",
    ]);
    assert!(line.contains("empty.json/a.fmu: cannot write"), "{line}");
}

#[test]
fn mistakes_in_the_use_are_status_2() {
    let shell = Shell::new();
    for arguments in [
        vec!["fmu", "seal"],
        vec!["fmu", "-o", "a.fmu"],
        vec!["fmu", "seal", "-o", "a.fmu", "--fmi", "1"],
    ] {
        assert_eq!(shell.run(&arguments).status, 2, "{arguments:?}");
    }
}
