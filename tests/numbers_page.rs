//! `docs/numbers.md` tells the constants that the sources have: names, files and values.

use std::path::Path;

#[test]
fn constants_of_the_page_are_those_of_the_sources() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = std::fs::read_to_string(root.join("docs/numbers.md")).expect("the page");
    let rows: Vec<&str> = page.lines().filter(|l| l.starts_with("| `")).collect();
    assert!(rows.len() > 60, "only {} rows", rows.len());
    for row in rows {
        // `NAME`, `value` or words, `file`
        let cells: Vec<&str> = row
            .split(" | ")
            .map(|c| c.trim_matches(['|', ' ']))
            .collect();
        let [name, value, file] = [cells[0], cells[1], cells[2]];
        let text = |cell: &str| cell.trim_matches('`').to_owned();
        let source = std::fs::read_to_string(root.join(text(file))).expect(file);
        let declaration = format!("const {}: ", text(name));
        let declared = source.split_once(&declaration).expect(row).1;
        let declared = declared.split_once(" = ").expect(row).1;
        if value.starts_with('`') {
            let expected = format!("{};", text(value));
            assert!(declared.starts_with(&expected), "{row}");
        }
    }
}
