//! Scenes whose mesh is a file: found beside the scene, checked before there is one, refused by name.

mod common;

use common::Shell;

const SHOE: &[u8] = include_bytes!("../../tests/meshes/shoe.bin.msh");

fn scene(mesh: &str) -> String {
    let material = r#""viscosity": {"law": "isotropic", "mu1": 5e4, "mu2": 1e5},
        "elasticity": {"law": "isotropic", "young": 2e7, "poisson": 0.3, "convention": "plane_strain"}"#;
    format!(
        r#"{{"schema_version": 1, "name": "shoe", "mesh": {mesh},
        "materials": [{{"region": "rim", {material}}}, {{"region": "lining", {material}}}],
        "clamped": ["pivot"],
        "contact": {{"part": "drum face", "friction": {{"law": "tresca", "bound": 2e4}}}},
        "loads": [{{"name": "cam", "kind": "traction", "part": "cam", "direction": [1, -1]}}],
        "time": {{"step": 0.05}},
        "run": {{"until": 0.5, "signals": {{"cam": [[0, 0], [0.5, 6e5]]}}}}}}"#
    )
}

/// A folder with the scene and its mesh in a folder of it.
fn shell() -> Shell {
    let shell = Shell::new();
    let folder = shell.folder.path();
    std::fs::create_dir(folder.join("brake")).unwrap();
    std::fs::write(folder.join("brake/shoe.msh"), SHOE).unwrap();
    shell.write(
        "brake/shoe.json",
        &scene(r#"{"kind": "gmsh", "file": "shoe.msh"}"#),
    );
    shell
}

#[test]
fn the_mesh_is_found_beside_the_scene() {
    let shell = shell();
    let out = ["--csv", "out.csv", "--plots", "plots", "--vtk", "vtk"];
    shell.succeed(&[&["run", "brake/shoe.json"][..], &out].concat());
    let table = shell.table("out.csv");
    let slip = table.at(0.5, "slip");
    // midside nodes slip too; the last node of the part is held
    assert_eq!(slip.len(), 8);
    assert!(slip.iter().all(|s| s.abs() > 1e-6), "{slip:?}");
    assert!(shell.has("plots/body.png") && shell.has("plots/body.svg"));
    let said = shell.succeed(&["check", "brake/shoe.json"]);
    assert!(said.contains("contact.slip_rate"), "{said}");
    // from standard input, the folder is that of the command
    let text = scene(r#"{"kind": "gmsh", "file": "brake/shoe.msh"}"#);
    let outcome = shell.feed(&["check", "-"], text.as_bytes());
    assert_eq!((outcome.status, outcome.stderr.as_str()), (0, ""));
    let outcome = shell.feed(
        &["check", "-"],
        scene(r#"{"kind": "gmsh", "file": "shoe.msh"}"#).as_bytes(),
    );
    assert_eq!(outcome.status, 1);
    assert!(
        outcome
            .stderr
            .contains("at mesh.file: found \"shoe.msh\", which cannot be read"),
        "{}",
        outcome.stderr
    );
}

/// Linear cells of a mesh without pattern lock where the material is nearly incompressible; its volume relaxes too fast for the step.
#[test]
fn what_incompressibility_asks_for_is_said() {
    let shell = shell();
    let linear = include_bytes!("../../tests/reference/bodies/shoe.msh");
    std::fs::write(shell.folder.path().join("brake/shoe.msh"), linear).unwrap();
    let check = |options: &[&str]| {
        let all = [&["check", "brake/shoe.json"][..], options].concat();
        shell.succeed(&all)
    };
    let soft = "materials[1].elasticity.poisson=0.4995";
    let set = |options: &[&'static str]| -> Vec<&'static str> {
        options.iter().flat_map(|o| ["--set", *o]).collect()
    };
    let said = check(&set(&[soft]));
    assert!(said.contains("locking"), "{said}");
    assert!(
        said.contains("region \"lining\"") && said.contains("lambda/mu = 999.000"),
        "{said}"
    );
    assert!(!check(&set(&[soft, "element=p2"])).contains("locking"));
    assert!(!check(&[]).contains("locking"));
    let said = check(&set(&[soft, "time.step=0.5"]));
    assert!(
        said.contains("stiff volume") && said.contains("mu1 / mu2"),
        "{said}"
    );
    assert!(!check(&set(&["time.step=0.5"])).contains("stiff volume"));
}

#[test]
fn a_mesh_file_is_checked_without_a_scene() {
    let shell = shell();
    let said = shell.succeed(&["check", "brake/shoe.msh"]);
    for line in [
        "2D, 38 nodes, 13 cells of tri6 (element \"p2\")",
        "bent cells",
        "smallest angle",
        "worst aspect",
        "rim     6      0.002640",
        "lining  7      0.003120",
        "drum face  4      0.167999",
        "interface  -      no part: element",
    ] {
        assert!(said.contains(line), "{line}: {said}");
    }
    let said = shell.succeed(&["check", "brake/shoe.msh", "--set", "mesh.scale=10"]);
    assert!(said.contains("drum face  4      1.679986"), "{said}");
    let said = shell.fail(&["check", "brake/shoe.msh", "--set", "time.step=1"]);
    assert!(said.contains("mesh.scale"), "{said}");
    let said = shell.fail(&["check", "brake/shoe.msh", "--set", "mesh.scale=-1"]);
    assert!(said.contains("at mesh.scale: found -1"), "{said}");
    let said = shell.fail(&["check", "brake/none.msh"]);
    assert!(
        said.contains("brake/none.msh: cannot read: there is no such file"),
        "{said}"
    );
    shell.write("broken.msh", "$MeshFormat\n4 0 8\n$EndMeshFormat\n");
    let said = shell.fail(&["check", "broken.msh"]);
    assert!(
        said.contains(
            "broken.msh: at mesh.file: found broken.msh: $MeshFormat: version 4 (line 2)"
        ),
        "{said}"
    );
}

/// The tables are printed, and the file is refused.
#[test]
fn a_mesh_with_a_folded_cell_is_no_good() {
    let shell = shell();
    let text = include_str!("../../tests/meshes/shoe.v2.msh");
    let words = |line: &str| line.split(' ').map(str::to_owned).collect::<Vec<_>>();
    // a side of the drum face: number, type, two tags, group, entity, both ends, the middle
    let is_side = |w: &Vec<String>| w.len() == 8 && w[1] == "8" && w[3] == "1";
    let side = text.lines().map(words).find(is_side).unwrap();
    let place = |node: &str| {
        text.lines()
            .find(|l| words(l)[0] == node && words(l).len() == 4)
            .unwrap()
    };
    let end = words(place(&side[5]));
    let near = format!(
        "{} {} {} 0",
        side[7],
        end[1].parse::<f64>().unwrap() * 0.999,
        end[2]
    );
    shell.write("folded.msh", &text.replace(place(&side[7]), &near));
    let outcome = shell.run(&["check", "folded.msh"]);
    assert_eq!(outcome.status, 1, "{}", outcome.stdout);
    assert!(outcome.stdout.contains("drum face"), "{}", outcome.stdout);
    assert!(
        outcome
            .stderr
            .contains("folded.msh: cannot use: a cell is turned inside out"),
        "{}",
        outcome.stderr
    );
}

#[test]
fn what_varies_the_mesh_is_refused() {
    let shell = shell();
    let said = shell.fail(&["tradeoff", "brake/shoe.json"]);
    assert!(
        said.contains("at mesh.kind: found a mesh from a file"),
        "{said}"
    );
    let said = shell.fail(&["run", "brake/shoe.json", "--set", "contact.part=interface"]);
    assert!(
        said.contains("at contact.part: found \"interface\", which is no part"),
        "{said}"
    );
    let said = shell.fail(&["run", "brake/shoe.json", "--set", "mesh.cells=[1,1]"]);
    assert!(said.contains("mesh.cells"), "{said}");
}
