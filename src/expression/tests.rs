use super::*;
use proptest::prelude::*;

fn value(text: &str, variables: [f64; 3]) -> f64 {
    Program::parse(text, &["r", "s", "p"])
        .unwrap_or_else(|fault| panic!("{text}: {fault}"))
        .value(&variables)
}

#[test]
#[rustfmt::skip] // one row, one formula
fn formulas_mean_what_they_mean_in_other_languages() {
    let [r, s, p] = [0.7_f64, 2.5, 3.0];
    for (text, right) in [
        ("1", 1.0), (".5", 0.5), ("2.", 2.0), ("1e-3", 1e-3), ("2E+2", 200.0),
        ("r", r), (" r\t+ s ", r + s), ("1 - 2 - 3", -4.0), ("8 / 4 / 2", 1.0), ("1 + 2 * 3", 7.0), ("(1 + 2) * 3", 9.0),
        ("2^3^2", 512.0), ("-2^2", -4.0), ("2^-1", 0.5), ("--1", 1.0), ("-+-1", 1.0), ("2*-3", -6.0), ("r^2*s", r * r * s),
        ("pi", std::f64::consts::PI), ("e", std::f64::consts::E), ("2*e", 2.0 * std::f64::consts::E), ("exp(1)", 1.0_f64.exp()),
        ("0.3 + 0.2*exp(-r/0.1)", 0.3 + 0.2 * (-r / 0.1).exp()), ("max(0.1, 0.5 - s)", 0.1), ("min(r, s)", r),
        ("sqrt(r)", r.sqrt()), ("ln(s) + log(s) + log10(s)", 2.0 * s.ln() + s.log10()), ("abs(-s)", s), ("hypot(r, s)", r.hypot(s)),
        ("sin(r)+cos(r)*tan(r)", r.sin() + r.cos() * r.tan()), ("asin(r)-acos(r)+atan(r)", r.asin() - r.acos() + r.atan()),
        ("sinh(r)/cosh(r) - tanh(r)", r.sinh() / r.cosh() - r.tanh()), ("asinh(r)*atanh(r)", r.asinh() * r.atanh()),
        ("pow(r, 1.5)", r.powf(1.5)), ("atan2(r, s)", r.atan2(s)), ("p^(-1/3)", p.powf(-1.0 / 3.0)),
    ] {
        assert_eq!(value(text, [r, s, p]), right, "{text}");
    }
}

#[test]
#[rustfmt::skip] // one row, one mistake
fn mistakes_are_named_with_their_place() {
    let deep = format!("{}1{}", "(".repeat(40), ")".repeat(40));
    let powers = "2^".repeat(40) + "2";
    let many = "1+".repeat(250) + "1";
    let long = " ".repeat(3000);
    for (text, position, found, allowed) in [
        ("", 1, "the end", "a number"), ("  ", 3, "the end", "a number"), ("1 +", 4, "the end", "a number"), ("(1", 3, "the end", ")"),
        ("1)", 2, "\")\"", "an operator, or the end"), ("1 2", 3, "\"2\"", "operator"), ("r s", 3, "\"s\"", "operator"),
        ("2 ** 3", 4, "\"*\"", "a number"), ("q + 1", 1, "the unknown name \"q\"", "r s p pi e"), ("1 + foo(r)", 5, "\"foo\"", "sqrt"),
        ("sin r", 5, "\"r\"", "( after"), ("sin()", 5, "\")\"", "a number"), ("min(1)", 6, "\")\"", "a comma"), ("min(1,2,3)", 8, "\",\"", ")"),
        ("sin(1,2)", 6, "\",\"", ")"), ("1..2", 1, "\"1..2\"", "a finite number"), ("1e999", 1, "\"1e999\"", "a finite number"), ("1e", 2, "\"e\"", "operator"),
        ("3 × r", 3, "\"×\"", "operator"), ("µ", 1, "\"µ\"", "a name"), ("é+1", 1, "\"é\"", "a name"), ("r = 1", 3, "\"=\"", "operator"), ("1;", 2, "\";\"", "operator"),
        (&deep, 33, "one level more", "at most 32 levels"), (&powers, 65, "one level more", "at most 32 levels"),
        (&many, 401, "one more", "at most 400"), (&long, 2001, "3000 bytes", "at most 2000"),
    ] {
        let fault = Program::parse(text, &["r", "s", "p"]).expect_err(text);
        assert_eq!(fault.position, position, "{text}: {fault}");
        assert!(fault.found.contains(found) && fault.allowed.contains(allowed), "{text}: {fault}");
    }
}

/// Every function's derivative is its difference, alone and inside another.
#[test]
fn derivatives_are_differences() {
    let unary = function::UNARY
        .iter()
        .map(|f| format!("{}(0.3*r + 0.05*s)", f.name));
    let binary = function::BINARY
        .iter()
        .map(|f| format!("{}(r*p, s+0.1)", f.name));
    let nested = [
        "r^s",
        "p^2.5/(r+s)",
        "-exp(-r*s)^2 + r*s*p",
        "1/(1+exp(-p))",
        "(r+1)^(s-p)",
    ]
    .map(str::to_owned);
    for text in unary.chain(binary).chain(nested) {
        let program = Program::parse(&text, &["r", "s", "p"]).unwrap();
        for at in [[0.7, 0.4, 1.9], [0.2, 1.3, 0.6]] {
            let (found, slopes) = program.derivatives::<3>(&at);
            assert_eq!(found, program.value(&at), "{text}");
            for (i, slope) in slopes.into_iter().enumerate() {
                let moved = |by: f64| {
                    let mut at = at;
                    at[i] += by;
                    program.value(&at)
                };
                let d = 1e-5;
                let difference = (moved(d) - moved(-d)) / (2.0 * d);
                assert!(
                    (slope - difference).abs() <= 1e-8 * (1.0 + slope.abs()),
                    "{text} {i}: {slope} {difference}"
                );
            }
            let (_, first) = program.derivatives::<1>(&at);
            assert_eq!(first[0], slopes[0], "{text}");
        }
    }
}

/// Of one side, and nothing where a variable does not occur.
#[test]
fn derivatives_at_kinks_and_of_constants() {
    let slope = |text: &str, at: [f64; 2]| {
        let program = Program::parse(text, &["r", "s"]).unwrap();
        program.derivatives::<2>(&at)
    };
    assert_eq!(slope("abs(r)", [0.0, 1.0]), (0.0, [1.0, 0.0]));
    assert_eq!(slope("max(0.2, r)", [0.2, 1.0]), (0.2, [1.0, 0.0]));
    assert_eq!(slope("sqrt(s - 1) + r", [0.5, 1.0]).1, [1.0, f64::INFINITY]);
    assert_eq!(slope("r^0 + s^1", [0.0, 0.0]), (1.0, [0.0, 1.0]));
    assert_eq!(slope("r^2", [0.0, 0.0]), (0.0, [0.0, 0.0]));
    let (value, _) = slope("max(r, ln(-1 - s))", [0.5, 0.0]);
    assert!(value.is_nan());
    let program = Program::parse("2*r", &["r", "s"]).unwrap();
    assert!(program.uses(0) && !program.uses(1));
}

proptest! {
    /// No text makes the reader panic, and what it accepts can be evaluated.
    #[test]
    fn no_text_is_too_much(text in "[-+*/^(),.0-9a-z rspe]{0,60}") {
        if let Ok(program) = Program::parse(&text, &["r", "s", "p"]) {
            program.derivatives::<3>(&[0.5, 0.1, 2.0]);
        }
    }

    #[test]
    fn no_character_is_too_strange(text in "\\PC{0,40}") {
        let _ = Program::parse(&text, &["r"]);
    }
}
