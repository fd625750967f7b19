//! What files of users hold: read right, or refused in a line that names section and entity.

use crate::writer::{Block, FORMATS, File, Format};
use crate::{read, rectangle, refusal, solid};
use stickslip::element::ElementKind;
use stickslip::mesh::Mesh;

pub fn plane() -> (Mesh, File) {
    let mesh = rectangle(ElementKind::P1);
    let file = File::of(&mesh);
    (read(&file.write(Format::Text4)).unwrap(), file)
}

fn block<'a>(file: &'a mut File, name: &str) -> &'a mut Block {
    let (d, group, _) = file.names.iter().find(|n| n.2 == name).unwrap().clone();
    let is_its = |b: &&mut Block| crate::writer::dimension(b.of) == d && b.groups == [group];
    file.blocks.iter_mut().find(is_its).unwrap()
}

/// All formats say the same.
fn refused(file: &File, parts: &[&str]) {
    for format in FORMATS {
        let text = refusal(&file.write(format));
        for part in parts {
            assert!(text.contains(part), "{format:?}: {text}");
        }
    }
}

fn same_in_all(file: &File) -> Mesh {
    let first = read(&file.write(Format::Text4)).unwrap();
    for format in FORMATS {
        assert_eq!(read(&file.write(format)).unwrap(), first, "{format:?}");
    }
    first
}

#[test]
fn nodes_of_no_cell_are_dropped() {
    let (mesh, mut file) = plane();
    // the centre of an arc, far away and out of the plane
    file.nodes.insert(3, [100.0, -7.0, 5.0]);
    file.tags.push(9000);
    for block in &mut file.blocks {
        block
            .cells
            .iter_mut()
            .flatten()
            .for_each(|n| *n += usize::from(*n >= 3));
    }
    assert_eq!(same_in_all(&file), mesh);
}

#[test]
fn points_and_entities_without_group_are_no_parts() {
    let (mesh, mut file) = plane();
    for (of, cells) in [(15, vec![vec![0]]), (26, vec![vec![0, 1, 2, 3]])] {
        let (entity, groups) = (77, Vec::new());
        file.blocks.push(Block {
            of,
            entity,
            groups,
            cells,
        });
    }
    assert_eq!(same_in_all(&file), mesh);
}

#[test]
fn a_side_may_be_in_two_groups() {
    let (mesh, mut file) = plane();
    file.names.push((1, 50, "loaded".into()));
    block(&mut file, "top").groups.push(50);
    block(&mut file, "right").groups.insert(0, 50);
    let found = same_in_all(&file);
    assert_eq!(found.parts["top"], mesh.parts["top"]);
    let count = mesh.parts["top"].len() + mesh.parts["right"].len();
    assert_eq!(found.parts["loaded"].len(), count);
}

#[test]
fn groups_without_names_are_called_by_their_numbers() {
    let (mesh, mut file) = plane();
    file.names.clear();
    let found = same_in_all(&file);
    let names: Vec<_> = found.parts.keys().map(String::as_str).collect();
    assert_eq!(names, ["1", "2", "3", "4"]);
    assert_eq!(found.regions, ["101", "102"]);
    assert_eq!(found.cell_nodes, mesh.cell_nodes);
    // Gmsh gives the number a sign where a curve is meant backwards
    for block in &mut file.blocks {
        block.groups.iter_mut().for_each(|g| *g = -*g);
    }
    assert_eq!(same_in_all(&file), found);
    // and an empty name is none
    file.names.push((1, 1, String::new()));
    assert_eq!(same_in_all(&file), found);
}

#[test]
fn cells_without_any_group_are_the_body() {
    let (_, mut file) = plane();
    for block in file.blocks.iter_mut().filter(|b| b.of == 2) {
        block.groups.clear();
    }
    file.names.retain(|(d, ..)| *d == 1);
    assert_eq!(same_in_all(&file).regions, ["body"]);
}

#[test]
fn what_is_no_boundary_is_no_part_and_says_why() {
    let (mesh, mut file) = plane();
    // the side between two regions, a side of no cell, a group without elements
    let inner = mesh.cells().find_map(|cell| {
        let outer: Vec<u32> = mesh.parts.values().flatten().copied().collect();
        (!outer.contains(&cell[0])).then_some(cell[0])
    });
    let inner = mesh.nodes[inner.unwrap() as usize];
    let at = |p: [f64; 3]| {
        file.nodes
            .iter()
            .position(|q| (0..3).all(|c| (p[c] - q[c]).abs() < 1e-12))
            .unwrap()
    };
    let middle = at(inner);
    let cell = file
        .blocks
        .iter()
        .flat_map(|b| &b.cells)
        .find(|c| c.len() == 3 && c.contains(&middle))
        .unwrap();
    let other = *cell.iter().find(|n| **n != middle).unwrap();
    let far = (0..file.nodes.len()).find(|n| {
        *n != middle
            && file
                .blocks
                .iter()
                .flat_map(|b| &b.cells)
                .all(|c| !(c.contains(n) && c.contains(&middle)))
    });
    for (group, name, cells) in [
        (60, "interface", vec![vec![middle, other]]),
        (61, "axis", vec![vec![middle, far.unwrap()]]),
        (62, "nothing", vec![]),
    ] {
        file.names.push((1, group, name.into()));
        let (of, entity, groups) = (1, group, vec![group]);
        file.blocks.push(Block {
            of,
            entity,
            groups,
            cells,
        });
    }
    let found = same_in_all(&file);
    assert_eq!(found.parts, mesh.parts);
    let why = |name: &str| found.unusable[name].as_str();
    assert!(why("interface").ends_with("lies inside the body, between two cells"));
    assert!(why("axis").ends_with("is the side of no cell"));
    assert_eq!(why("nothing"), "the file has no elements of it");
    let error = found
        .faces("interface", "contact.part")
        .map(drop)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("at contact.part: found \"interface\", which is no part: element"),
        "{error}"
    );
    assert!(
        error.contains("allowed: the parts of the mesh: bottom, left, right, top"),
        "{error}"
    );
}

#[test]
fn cells_that_cannot_be_are_refused_by_number() {
    let (_, file) = plane();
    let change = |name: &str, edit: &dyn Fn(&mut Block)| {
        let mut file = file.clone();
        edit(block(&mut file, name));
        file
    };
    // two regions: one line names both
    refused(
        &change("body", &|b| b.groups.push(101)),
        &["body", "brake lining", "physical group"],
    );
    refused(
        &change("body", &|b| b.groups.clear()),
        &["$Elements: surface 2 is in no physical group, while surface 1 is in \"brake lining\""],
    );
    refused(
        &change("body", &|b| b.cells[0][2] = b.cells[0][1]),
        &["$Elements: element", "has no volume"],
    );
    refused(
        &change("body", &|b| b.cells.push(b.cells[0].clone())),
        &["$Elements: elements", "have the same corners", "\"body\""],
    );
    // a third cell at a side
    let (mesh, mut third) = plane();
    let outside = third.nodes.len();
    third.nodes.push([0.1, 9.0, 0.0]);
    third.tags.push(5000);
    let inner = mesh
        .cells()
        .flatten()
        .find(|n| !mesh.parts.values().flatten().any(|m| m == *n))
        .unwrap();
    let place = mesh.nodes[*inner as usize];
    let at = third
        .nodes
        .iter()
        .position(|q| (0..3).all(|c| (place[c] - q[c]).abs() < 1e-12))
        .unwrap();
    let all: Vec<Vec<usize>> = third.blocks.iter().flat_map(|b| b.cells.clone()).collect();
    let cell = all
        .iter()
        .find(|c| c.len() == 3 && c.contains(&at))
        .unwrap();
    let other = *cell.iter().find(|n| **n != at).unwrap();
    block(&mut third, "body")
        .cells
        .push(vec![at, other, outside]);
    refused(&third, &["$Elements: three cells share one side at ("]);
    let mut twice = file.clone();
    twice.tags[4] = twice.tags[3];
    refused(&twice, &["$Nodes: node 4 a second time"]);
    // a node that is not there
    let mut missing = file.clone();
    missing.nodes.pop();
    let gone = missing.tags.len();
    let mut bytes = String::from_utf8(file.write(Format::Text2)).unwrap();
    bytes = bytes.replace(
        &format!("$Nodes\n{gone}\n"),
        &format!("$Nodes\n{}\n", gone - 1),
    );
    let line = bytes
        .lines()
        .find(|l| l.starts_with(&format!("{gone} ")) && l.contains('e'))
        .unwrap()
        .to_owned();
    let text = refusal(bytes.replace(&format!("{line}\n"), "").as_bytes());
    assert!(text.contains(&format!("has the node {gone}")), "{text}");
}

#[test]
fn other_types_of_cells_are_refused_by_name() {
    let (_, file) = plane();
    let mut quads = file.clone();
    let cells = &mut block(&mut quads, "body").cells;
    let quad = [cells[0].clone(), vec![cells[1][0]]].concat();
    quads.blocks.push(Block {
        of: 3,
        entity: 9,
        groups: vec![102],
        cells: vec![quad],
    });
    refused(
        &quads,
        &[
            "$Elements: element",
            "on surface 9 is a quadrangle (type 3), beside the triangle",
        ],
    );
    let mut cubic = file.clone();
    for b in &mut cubic.blocks {
        b.of = if b.of == 1 { 26 } else { 21 };
        let nodes = if b.of == 26 { 4 } else { 10 };
        b.cells.iter_mut().for_each(|c| c.resize(nodes, 0));
    }
    refused(
        &cubic,
        &[
            "on surface 1 is a third-order triangle (type 21)",
            "first or second order",
        ],
    );
    // second-order cells with first-order sides
    let mut mixed = File::of(&rectangle(ElementKind::P2));
    for b in mixed.blocks.iter_mut().filter(|b| b.of == 8) {
        b.of = 1;
        b.cells.iter_mut().for_each(|c| c.truncate(2));
    }
    refused(
        &mixed,
        &["on curve 1 is a line (type 1), beside cells of tri6"],
    );
    // a side with a midside node of its own
    let mut torn = File::of(&solid(ElementKind::P2));
    let face = &mut torn.blocks.iter_mut().find(|b| b.of == 9).unwrap().cells[0];
    face[4] = face[3];
    let found = read(&torn.write(Format::Text4));
    assert!(
        found.is_ok(),
        "a midside node of the cell, at another place: {found:?}"
    );
    let strange = (0..torn.nodes.len())
        .find(|n| !torn.blocks.iter().find(|b| b.of == 9).unwrap().cells[0].contains(n));
    torn.blocks.iter_mut().find(|b| b.of == 9).unwrap().cells[0][4] = strange.unwrap();
    refused(
        &torn,
        &["has the midside node", "the cell beside it another"],
    );
    // no cells at all
    let mut bare = file.clone();
    bare.blocks.retain(|b| b.of == 1);
    refused(
        &bare,
        &[
            "$Elements: no triangles and no tetrahedra",
            "give the surface (2D) or the volume (3D) a physical group",
        ],
    );
    bare.blocks.clear();
    refused(&bare, &["$Elements: no elements"]);
}

#[test]
fn plane_meshes_lie_in_the_plane() {
    let (_, file) = plane();
    let moved = |z: &dyn Fn([f64; 3]) -> f64| {
        let mut file = file.clone();
        file.nodes.iter_mut().for_each(|p| p[2] = z(*p));
        file
    };
    refused(
        &moved(&|p| 0.3 * p[1]),
        &[
            "$Nodes: node",
            "of a triangle is at z = ",
            "in the plane z = 0",
        ],
    );
    refused(&moved(&|_| 1.0), &["is at z = 1 m"]);
    // what rounding leaves is taken out
    let found = same_in_all(&moved(&|p| 1e-12 * p[0]));
    assert!(found.nodes.iter().all(|p| p[2] == 0.0));
    // a surface of a solid alone
    let mut shell = File::of(&solid(ElementKind::P1));
    shell.blocks.retain(|b| b.of == 2);
    refused(
        &shell,
        &[
            "of a triangle is at z = ",
            "a solid needs a physical group of its volume",
        ],
    );
}

#[test]
fn names_are_checked() {
    let (mesh, mut file) = plane();
    // dimensions have names of their own
    file.names.iter_mut().find(|n| n.2 == "top").unwrap().2 = "body".into();
    let found = same_in_all(&file);
    assert_eq!(found.parts["body"], mesh.parts["top"]);
    file.names.iter_mut().find(|n| n.2 == "left").unwrap().2 = "body".into();
    refused(
        &file,
        &[
            "$PhysicalNames: groups",
            "of dimension 1 are both called \"body\"",
        ],
    );
    let (_, mut file) = plane();
    file.names.push((1, 1, "again".into()));
    refused(
        &file,
        &["$PhysicalNames: a second name of group 1 of dimension 1"],
    );
}
