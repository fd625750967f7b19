//! `include/stickslip.h` is what cbindgen makes of the sources. To update it: `UPDATE_HEADER=1 cargo test --test capi_header`.

use std::path::Path;

#[test]
fn the_committed_header_is_up_to_date() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).unwrap();
    let mut builder = cbindgen::Builder::new().with_config(config);
    for source in [
        "error/code",
        "capi/mod",
        "capi/guard",
        "capi/model",
        "capi/simulator",
        "capi/inputs",
        "capi/state",
        "capi/derivative",
    ] {
        builder = builder.with_src(root.join(format!("src/{source}.rs")));
    }
    let mut fresh = Vec::new();
    builder.generate().unwrap().write(&mut fresh);
    let fresh = clean(&String::from_utf8(fresh).unwrap());
    let path = root.join("include/stickslip.h");
    if std::env::var_os("UPDATE_HEADER").is_some() {
        std::fs::write(&path, &fresh).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    let difference = committed.lines().zip(fresh.lines()).find(|(a, b)| a != b);
    assert!(
        committed == fresh,
        "include/stickslip.h is out of date, first at {difference:?}"
    );
}

/// What concerns the Rust side alone is left out: `# Safety` sections, which the conventions cover. The codes get their
/// prefix.
fn clean(header: &str) -> String {
    let mut out = String::new();
    let mut in_safety = false;
    let mut in_codes = false;
    for line in header.lines() {
        in_codes = (in_codes || line.starts_with("enum stickslip_code")) && !line.starts_with('}');
        let comment = line.trim_start().strip_prefix("//");
        in_safety = match comment.map(str::trim) {
            Some("# Safety") => true,
            Some(_) => in_safety,
            None => false,
        };
        let is_gap = comment.map(str::trim) == Some("");
        if in_safety || is_gap {
            continue;
        }
        if in_codes && line.contains(" = -") {
            out.push_str(&line.replacen("  ", "  STICKSLIP_", 1));
        } else {
            out.push_str(line.trim_end());
        }
        out.push('\n');
    }
    out
}
