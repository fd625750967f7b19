//! Sections of MSH files: read, skipped, or refused with the line.

use crate::traps::plane;
use crate::writer::Format;
use crate::{read, refusal};

fn text4() -> String {
    String::from_utf8(plane().1.write(Format::Text4)).unwrap()
}

#[test]
fn sections_are_read_skipped_or_refused() {
    let mesh = plane().0;
    let text = text4();
    let with = |at: &str, more: &str| text.replacen(at, &format!("{more}{at}"), 1);
    for more in [
        "$Comments\nmade by hand: $Nodes is below\n$EndComments\n",
        "$Periodic\n1\n1 2 3\nAffine 1 0 0\n$EndPeriodic\n",
        "$NodeData\n1\n\"T\"\n0\n$EndNodeData\n",
        "\n\n  \n",
    ] {
        assert_eq!(
            read(with("$Elements", more).as_bytes()).as_ref(),
            Ok(&mesh),
            "{more}"
        );
        assert_eq!(
            read(with("$MeshFormat", more).as_bytes()).as_ref(),
            Ok(&mesh),
            "{more}"
        );
    }
    assert_eq!(
        read(text.replace('\n', "\r\n").as_bytes()).as_ref(),
        Ok(&mesh)
    );
    for (bytes, parts) in [
        (
            with("$Nodes", "$ParametricNodes\n1\n$EndParametricNodes\n"),
            "$ParametricNodes: nodes with parameters",
        ),
        (
            with("$Elements", "$Nodes\n0 0 0 0\n$EndNodes\n"),
            "$Nodes: this section a second time",
        ),
        (
            with("$Elements", "loose words\n"),
            "found part.msh: \"loose words\"",
        ),
        (
            text.replace("4.1 0 8", "4 0 8"),
            "$MeshFormat: version 4 (line 2)",
        ),
        (
            text.replace("4.1 0 8", "4.0 0 8"),
            "$MeshFormat: version 4.0",
        ),
        (text.replace("4.1 0 8", "2 0 8"), "$MeshFormat: version 2 "),
        (
            text.replace("4.1 0 8", "4.1 2 8"),
            "$MeshFormat: \"4.1 2 8\"",
        ),
        (
            text.replace("4.1 0 8", "4.1 0 16"),
            "$MeshFormat: \"4.1 0 16\"",
        ),
        (text.replace("$EndNodes", "$EndNode"), "$EndNodes"),
        (
            text.replace("$EndElements", ""),
            "$Elements: the end of the file",
        ),
        (
            text.replace("$Elements", "$Cells"),
            "$Cells: the end of the file",
        ),
        (
            text[..text.find("$Elements").unwrap()].to_owned(),
            "no section $Elements",
        ),
        (String::new(), "no section $MeshFormat"),
        ("{\"schema_version\": 1}".into(), "a section of an MSH file"),
    ] {
        let found = refusal(bytes.as_bytes());
        assert!(found.contains(parts), "{found}");
    }
    let nodes = text.find("$Nodes").unwrap();
    let head = text[nodes..].lines().nth(1).unwrap();
    for (changed, parts) in [
        (head.replacen("2 ", "1 ", 1), "$Nodes: "),
        (
            "2 999999999999 1 1".to_owned(),
            "$Nodes: 999999999999 nodes",
        ),
        (
            "2 18446744073709551615 1 1".to_owned(),
            "$Nodes: 18446744073709551615 nodes",
        ),
        ("2 -3 1 1".to_owned(), "$Nodes: \"-3\""),
        ("2 30 1 x".to_owned(), "$Nodes: \"x\""),
    ] {
        let found = refusal(text.replacen(head, &changed, 1).as_bytes());
        assert!(found.contains(parts), "{found}");
    }
    let (before, after) = text.split_at(nodes);
    let place = after.lines().find(|l| l.contains("e0 ")).unwrap();
    for value in ["nan", "inf", "1e999", "1,5"] {
        let changed = place.replacen(place.split(' ').next().unwrap(), value, 1);
        let found = refusal(format!("{before}{}", after.replacen(place, &changed, 1)).as_bytes());
        assert!(
            found.contains("$Nodes: ") && found.contains("(line "),
            "{found}"
        );
    }
}

/// A file that Gmsh has partitioned: pieces of entities have the groups.
#[test]
fn partitioned_entities_have_the_groups() {
    let (mesh, file) = plane();
    let text = String::from_utf8(file.write(Format::Text4)).unwrap();
    let start = text.find("$Entities\n").unwrap();
    let end = text.find("$EndEntities").unwrap();
    let mut lines = text[start..end]
        .lines()
        .skip(1)
        .filter(|l| !l.trim().is_empty());
    let counts = lines.next().unwrap();
    let pieces: Vec<String> = lines
        .map(|line| {
            let (entity, rest) = line.split_once(' ').unwrap();
            // dimension and number of the parent, one partition
            format!("{entity} 1 1 1 1 {rest}")
        })
        .collect();
    let section = format!(
        "$Entities\n0 0 0 0\n$EndEntities\n$PartitionedEntities\n2\n1\n5 1\n{counts}\n{}\n$EndPartitionedEntities",
        pieces.join("\n")
    );
    let text = text.replace(&format!("{}$EndEntities", &text[start..end]), &section);
    assert_eq!(read(text.as_bytes()).as_ref(), Ok(&mesh));
    // an entity that is nowhere
    let lost = text.replace("\n1 1 1 1 1 0", "\n9 1 1 1 1 0");
    let found = refusal(lost.as_bytes());
    assert!(
        found.contains("$Elements: elements on entity 1 of dimension"),
        "{found}"
    );
}

/// Without `$Entities`, as other programs write, there are no groups.
#[test]
fn entities_may_be_missing() {
    let text = text4();
    let (start, end) = (
        text.find("$Entities").unwrap(),
        text.find("$Nodes").unwrap(),
    );
    let found = read(text.replace(&text[start..end], "").as_bytes()).unwrap();
    assert_eq!(
        (found.regions, found.parts.len()),
        (vec!["body".to_owned()], 0)
    );
    assert!(found.unusable.contains_key("top"));
}
