//! The trajectories of `tests/reference`, computed by an independent solver (numpy/scipy, own mesh, own assembly, the
//! friction law solved to rounding), against the three models.

use serde_json::Value;
use std::sync::Arc;
use stickslip::{Scene, Simulator, compile};

fn load(name: &str) -> Value {
    let path = format!("{}/tests/reference/{name}.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|v| v.as_f64().unwrap())
        .collect()
}

#[test]
fn quick() {
    for name in [
        "paper_h8_nonmonotone_consistent",
        "paper_h32_nonmonotone_consistent",
        "paper_h32_nonmonotone_zero",
        "paper_h32_nonmonotone_backward_euler",
        "paper_h32_nonmonotone_rectangle",
        "paper_h32_a001_zero",
        "paper_h32_a003_consistent",
    ] {
        for model in ["full", "condensed", "reduced"] {
            let d = load(name);
            let p = &d["parameters"];
            let scheme = match d["scheme"].as_str().unwrap() {
                "trap" => "trapezoid",
                "be" => "backward_euler",
                _ => "rectangle",
            };
            let scene = serde_json::json!({"schema_version":1,"name":"x","mesh":{"kind":"rectangle","size":[1.0,0.5],"cells":d["cells"]},
          "material":{"viscosity":{"law":"isotropic","mu1":0.05,"mu2":0.1},"elasticity":{"law":"isotropic","young":1.0,"poisson":0.3,"convention":"kazmi2014"}},
          "clamped":["left"],"contact":{"part":"bottom","friction":{"law":"exponential","a":p["a"],"b":p["b"],"alpha":p["alpha"]}},
          "loads":[{"name":"press","kind":"traction","part":"top","direction":[0,1],"start":-0.3}],
          "time":{"scheme":scheme,"start":d["start"],"step":d["step_size"]},"fidelity":{"model":model}});
            let scene: Scene = serde_json::from_value(scene).unwrap();
            let t0 = std::time::Instant::now();
            let model_ = Arc::new(compile(&scene).unwrap());
            let setup = t0.elapsed();
            let mut sim = Simulator::new(model_.clone());
            sim.init(0.0).unwrap();
            let k = scene.time.step;
            let mut worst = [0.0f64; 3];
            let mut big = [0.0f64; 3];
            let mut its = vec![];
            let mut res = 0.0f64;
            let samples = d["samples"].as_array().unwrap();
            let t0 = std::time::Instant::now();
            for n in 0..32 {
                sim.do_step(n as f64 * k, k).unwrap();
                its.push(sim.get_by_name("solver.iterations").unwrap()[0] as i64);
                res = res.max(sim.get_by_name("solver.residual").unwrap()[0]);
                for s in samples {
                    if (s["t"].as_f64().unwrap() - sim.time()).abs() < 1e-9 {
                        for (i, (f, port)) in [
                            ("slip_rate", "contact.slip_rate"),
                            ("slip", "contact.slip"),
                            ("tangential_stress", "contact.tangential_stress"),
                        ]
                        .iter()
                        .enumerate()
                        {
                            if s.get(f).is_none() {
                                continue;
                            }
                            let r = numbers(&s[f]);
                            let g = sim.get_by_name(port).unwrap();
                            for (a, b) in r.iter().zip(&g) {
                                worst[i] = worst[i].max((a - b).abs());
                                big[i] = big[i].max(a.abs());
                            }
                        }
                    }
                }
            }
            let st = t0.elapsed();
            println!(
                "{name} {model} err {:?} res {res:.1e} its {:?} setup {setup:?} step {:?} bal {:?} states {} {:?} c {:?}",
                (0..3).map(|i| worst[i] / big[i]).collect::<Vec<_>>(),
                its,
                st / 32,
                sim.get_by_name("energy.balance_error").unwrap(),
                model_.states(),
                model_.summary().reduction,
                model_.certificate()
            );
        }
    }
}
