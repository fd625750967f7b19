//! C and C++ programs against the installed library: examples, compilers, valgrind, sanitizers, threads, packages.
#![cfg(feature = "capi")]

mod common;

use common::{paper, start};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

const STRICT: [&str; 4] = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"];
const EXAMPLES: [&str; 8] = [
    "hello.c",
    "two_instances.c",
    "rollback.c",
    "rigid_mass.c",
    "hold_brake.c",
    "cosim_loop.c",
    "real_time.c",
    "cosim.cpp",
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn scratch(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("clients")
        .join(name);
    std::fs::create_dir_all(&path).unwrap();
    path
}

/// Runs a command that must succeed; its standard output.
fn run(command: &mut Command) -> String {
    let output = command
        .output()
        .unwrap_or_else(|e| panic!("{command:?}: {e}"));
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(
        output.status.success(),
        "{command:?}\n{}{}",
        text(&output.stdout),
        text(&output.stderr)
    );
    text(&output.stdout)
}

/// Where the library is installed for these tests.
fn prefix() -> &'static Path {
    static PREFIX: OnceLock<PathBuf> = OnceLock::new();
    PREFIX.get_or_init(|| {
        let prefix = scratch("prefix");
        let mut make = Command::new("make");
        make.current_dir(root()).arg("install");
        run(make.arg(format!("PREFIX={}", prefix.display())));
        prefix
    })
}

fn compilers(source: &str) -> [(&'static str, &'static str); 2] {
    if source.ends_with(".cpp") {
        [("g++", "-std=c++17"), ("clang++", "-std=c++17")]
    } else {
        [("gcc", "-std=c99"), ("clang", "-std=c99")]
    }
}

/// Builds a program; where it lies.
fn build(source: &Path, compiler: (&str, &str), options: &[&str], name: &str) -> PathBuf {
    let program = scratch("bin").join(name);
    let lib = prefix().join("lib");
    let mut command = Command::new(compiler.0);
    command
        .args([compiler.1, "-g"])
        .args(STRICT)
        .args(options)
        .arg(source)
        .arg("-o")
        .arg(&program);
    command
        .arg("-I")
        .arg(prefix().join("include"))
        .arg("-I")
        .arg(root().join("examples_c"));
    command
        .arg("-L")
        .arg(&lib)
        .args(["-lstickslip", "-lm", "-lpthread"]);
    run(command.arg(format!("-Wl,-rpath,{}", lib.display())));
    program
}

fn example(source: &str) -> PathBuf {
    root().join("examples_c").join(source)
}

/// Arguments that keep an instrumented run short, and where it may write.
fn prepared(program: &Path, source: &str) -> Command {
    let mut command = Command::new(program);
    arguments(&mut command, source);
    command
}

fn arguments(command: &mut Command, source: &str) {
    match source {
        "cosim_loop.c" => command.arg(scratch("out").join("brake.csv")),
        "real_time.c" => command.arg("100").env("STEP_LIMIT_SECONDS", "1"),
        _ => command,
    };
}

#[test]
fn examples_build_without_a_warning_and_check_their_answers() {
    for source in EXAMPLES {
        for compiler in compilers(source) {
            let program = build(
                &example(source),
                compiler,
                &[],
                &format!("{source}.{}", compiler.0),
            );
            print!(
                "{source} ({}): {}",
                compiler.0,
                run(&mut prepared(&program, source))
            );
        }
    }
}

#[test]
fn the_header_stands_alone_in_c99_and_cpp17() {
    let header = prefix().join("include/stickslip.h");
    for (compiler, language, standard) in [
        ("gcc", "c", "-std=c99"),
        ("clang", "c", "-std=c99"),
        ("g++", "c++", "-std=c++17"),
        ("clang++", "c++", "-std=c++17"),
    ] {
        let mut command = Command::new(compiler);
        command
            .args([standard, "-fsyntax-only", "-x", language])
            .args(STRICT);
        run(command.arg("-include").arg(&header).arg("/dev/null"));
    }
}

#[test]
fn valgrind_finds_nothing() {
    for source in EXAMPLES {
        let program = build(
            &example(source),
            compilers(source)[0],
            &[],
            &format!("{source}.valgrind"),
        );
        let mut command = Command::new("valgrind");
        command
            .args(["--quiet", "--leak-check=full", "--error-exitcode=9"])
            .arg(program);
        arguments(&mut command, source);
        run(&mut command);
    }
}

#[test]
fn sanitizers_find_nothing() {
    let options = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
    for source in EXAMPLES {
        let program = build(
            &example(source),
            compilers(source)[0],
            &options,
            &format!("{source}.asan"),
        );
        run(&mut prepared(&program, source));
    }
}

#[test]
fn simulators_in_threads_give_the_same_bits() {
    let source = root().join("tests/c/threads.c");
    let program = build(&source, ("gcc", "-std=c99"), &[], "threads");
    print!("{}", run(Command::new(&program).arg("64")));
    let mut helgrind = Command::new("valgrind");
    helgrind.args(["--quiet", "--tool=helgrind", "--error-exitcode=9"]);
    run(helgrind.arg(&program).arg("8"));
}

#[test]
fn reference_trajectories_from_c_equal_those_from_rust() {
    let source = root().join("tests/c/trajectory.c");
    let program = build(&source, ("gcc", "-std=c99"), &[], "trajectory");
    let mut count = 0;
    for entry in std::fs::read_dir(root().join("tests/reference")).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            continue;
        }
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&path).unwrap();
        let file: serde_json::Value = serde_json::from_str(&text).unwrap();
        let Some(parameters) = file.get("parameters").filter(|p| p.get("alpha").is_some()) else {
            continue;
        };
        let Some(scheme) = file.get("scheme").and_then(|s| s.as_str()) else {
            continue;
        };
        let scheme = match scheme {
            "trap" => "trapezoid",
            "be" => "backward_euler",
            _ => "rectangle",
        };
        let k = file["step_size"].as_f64().unwrap();
        for model in ["reduced", "condensed", "full"] {
            let scene = paper(
                file["cells"][0].as_u64().unwrap() as u32,
                &[
                    ("time.scheme", scheme),
                    ("time.start", file["start"].as_str().unwrap()),
                    ("time.step", &k.to_string()),
                    ("contact.friction.a", &parameters["a"].to_string()),
                    ("contact.friction.b", &parameters["b"].to_string()),
                    ("contact.friction.alpha", &parameters["alpha"].to_string()),
                    ("fidelity.model", model),
                ],
            );
            let scene_file = scratch("out").join(format!("{name}.{model}.json"));
            std::fs::write(&scene_file, scene.to_json()).unwrap();
            let mut command = Command::new(&program);
            let printed = run(command.arg(&scene_file).args(["32", &k.to_string()]));
            let mut from_c = printed.lines().map(|l| u64::from_str_radix(l, 16).unwrap());
            let mut simulator = start(&scene);
            let mut values = vec![0.0; simulator.output_len()];
            for _ in 0..32 {
                simulator.do_step(simulator.time(), k).unwrap();
                simulator.get_outputs(&mut values).unwrap();
                for value in &values {
                    assert_eq!(Some(value.to_bits()), from_c.next(), "{name} {model}");
                }
            }
            assert_eq!(from_c.next(), None);
            count += 1;
        }
    }
    assert!(count >= 27, "only {count} trajectories");
}

#[test]
fn the_shared_library_exports_its_interface_and_nothing_else() {
    let library = prefix().join("lib/libstickslip.so");
    let symbols = run(Command::new("nm")
        .args(["-D", "--defined-only"])
        .arg(library));
    let header = std::fs::read_to_string(root().join("include/stickslip.h")).unwrap();
    let mut count = 0;
    for line in symbols.lines() {
        let name = line.split_whitespace().last().unwrap();
        assert!(name.starts_with("stickslip_"), "{name} is exported");
        assert!(
            header.contains(&format!("{name}(")),
            "{name} is not in the header"
        );
        count += 1;
    }
    assert!(count >= 25, "only {count} functions");
}

#[test]
fn the_static_library_exports_its_interface_and_nothing_else() {
    let library = prefix().join("lib/libstickslip.a");
    let symbols = run(Command::new("nm")
        .args(["-g", "--defined-only"])
        .arg(library));
    let header = std::fs::read_to_string(root().join("include/stickslip.h")).unwrap();
    let names: Vec<_> = symbols
        .lines()
        .filter_map(|line| line.split_whitespace().nth(2))
        .collect();
    for name in &names {
        assert!(name.starts_with("stickslip_"), "{name} is exported");
        assert!(header.contains(&format!("{name}(")), "{name}");
    }
    let shared = run(Command::new("nm")
        .args(["-D", "--defined-only"])
        .arg(prefix().join("lib/libstickslip.so")));
    assert_eq!(names.len(), shared.lines().count());
}

/// What pkg-config says is enough to link the static library, statically and not, beside a program that defines what a Rust
/// library has too.
#[test]
fn a_static_program_links_with_what_pkg_config_says() {
    let path = prefix().join("lib/pkgconfig");
    let flags = run(Command::new("pkg-config")
        .args(["--static", "--cflags", "--libs", "stickslip"])
        .env("PKG_CONFIG_PATH", path));
    let flags: Vec<_> = flags.split_whitespace().collect();
    assert!(
        flags.contains(&"-lstickslip") && !flags.contains(&"-lgcc_s"),
        "{flags:?}"
    );
    let other = scratch("static").join("other.c");
    let text = "int rust_eh_personality, rust_begin_unwind, __rust_alloc, __rust_dealloc;\n";
    std::fs::write(&other, text).unwrap();
    let lib = prefix().join("lib");
    for options in [vec!["-static"], vec!["-static-pie"], vec![]] {
        let program = scratch("static").join(format!("hello{}", options.concat()));
        let mut command = Command::new("cc");
        command.args(&options).arg(example("hello.c")).arg(&other);
        command
            .arg("-I")
            .arg(root().join("examples_c"))
            .args(&flags);
        if options.is_empty() {
            command.arg(format!("-Wl,-rpath,{}", lib.display()));
        }
        run(command.arg("-o").arg(&program));
        run(&mut Command::new(program));
    }
}

#[test]
fn notices_and_licence_are_installed() {
    for name in ["LICENSE", "THIRD-PARTY-NOTICES.txt"] {
        let installed = prefix().join("share/doc/stickslip").join(name);
        let text = std::fs::read_to_string(installed).unwrap();
        assert_eq!(text, std::fs::read_to_string(root().join(name)).unwrap());
        assert!(text.contains("MIT"));
    }
}

/// Versions that a CMake project may ask for, and the ones that it must not get.
#[test]
fn the_cmake_package_knows_its_version() {
    let source = scratch("cmake_version");
    for (asked, is_found) in [
        ("", true),
        ("0", true),
        ("0.1", true),
        ("0.1.0", true),
        ("0.1.0 EXACT", true),
        ("0...1", true),
        ("0.1...0.1.5", true),
        ("0.0...<0.1.0", false),
        ("0.0", false),
        ("0.2", false),
        ("0.1.7", false),
        ("1", false),
        ("1.1", false),
        ("0 EXACT", false),
    ] {
        let text = format!(
            "cmake_minimum_required(VERSION 3.19)\nproject(asks LANGUAGES NONE)\n\
             find_package(stickslip {asked} CONFIG QUIET)\n\
             if(stickslip_FOUND)\nmessage(STATUS \"it is found: ${{stickslip_VERSION}}\")\nendif()\n"
        );
        std::fs::write(source.join("CMakeLists.txt"), text).unwrap();
        let build = source.join("build");
        let _ = std::fs::remove_dir_all(&build);
        let mut cmake = Command::new("cmake");
        cmake.arg("-S").arg(&source).arg("-B").arg(&build);
        let said = run(cmake.arg(format!("-DCMAKE_PREFIX_PATH={}", prefix().display())));
        assert_eq!(
            said.contains("it is found: 0.1.0"),
            is_found,
            "{asked}\n{said}"
        );
    }
}

#[test]
fn the_environment_of_the_host_is_its_own() {
    let source = root().join("tests/c/environment.c");
    let program = build(&source, ("gcc", "-std=c99"), &[], "environment");
    run(&mut Command::new(&program));
}

#[test]
fn arrays_of_all_kinds_are_spans() {
    let source = root().join("tests/c/spans.cpp");
    for standard in ["-std=c++17", "-std=c++20"] {
        let program = build(&source, ("g++", standard), &[], &format!("spans{standard}"));
        run(&mut Command::new(&program));
    }
}

#[test]
fn a_makefile_finds_the_library_by_pkg_config() {
    let out = scratch("pkg_config");
    std::fs::copy(
        root().join("tests/c/pkg_config/Makefile"),
        out.join("Makefile"),
    )
    .unwrap();
    let path = prefix().join("lib/pkgconfig");
    let mut make = Command::new("make");
    make.current_dir(&out)
        .env("PKG_CONFIG_PATH", path)
        .arg("-B");
    run(make.arg(format!("EXAMPLES={}", root().join("examples_c").display())));
    run(&mut Command::new(out.join("hello")));
}

#[test]
fn a_cmake_project_finds_the_package() {
    let out = scratch("cmake");
    let mut cmake = Command::new("cmake");
    cmake
        .arg("-S")
        .arg(root().join("tests/c/cmake"))
        .arg("-B")
        .arg(&out);
    cmake.arg(format!("-DCMAKE_PREFIX_PATH={}", prefix().display()));
    run(cmake.arg(format!(
        "-DEXAMPLES={}",
        root().join("examples_c").display()
    )));
    run(Command::new("cmake").arg("--build").arg(&out));
    for program in ["hello", "hello_static", "cosim"] {
        run(&mut Command::new(out.join(program)));
    }
}

#[test]
fn the_code_of_the_guide_and_the_readme_compiles_and_runs() {
    let pages =
        ["docs/c.md", "README.md"].map(|page| std::fs::read_to_string(root().join(page)).unwrap());
    let has_c = pages.each_ref().map(|page| page.contains("```c\n"));
    assert_eq!(has_c, [true; 2], "a page has no C program");
    let guide = pages.concat();
    let mut count = 0;
    for (fence, extension) in [("```c\n", "c"), ("```cpp\n", "cpp")] {
        for block in guide.split(fence).skip(1) {
            let code = block.split("```").next().unwrap();
            count += 1;
            let source = scratch("guide").join(format!("block{count}.{extension}"));
            std::fs::write(&source, code).unwrap();
            let name = format!("guide{count}");
            for compiler in compilers(&format!("x.{extension}")) {
                let program = build(&source, compiler, &[], &name);
                run(&mut Command::new(program));
            }
        }
    }
    assert!(count >= 4, "only {count} blocks");
}
