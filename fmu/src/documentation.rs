//! `documentation/index.html`: what the FMU is, a picture of its mesh, its variables, what it needs.

use crate::description::FmiVersion;
use crate::variables::{Role, Variables};
use std::fmt::Write;
use stickslip::mesh::Mesh;
use stickslip::{Compilation, Model};

/// What the documentation says about the shared library.
pub struct LibraryNotes {
    /// Newest glibc version that it asks for, where that was found.
    pub glibc: Option<String>,
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

/// The page.
pub fn page(
    compilation: &Compilation,
    version: FmiVersion,
    is_scalar: bool,
    library: &LibraryNotes,
) -> String {
    let model = &compilation.model;
    let (scene, summary) = (model.scene(), model.summary());
    let title = escaped(&scene.name);
    let mut html = String::new();
    let _ = write!(
        html,
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title><style>\
         body{{font:16px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#222}}\
         table{{border-collapse:collapse}}td,th{{border-bottom:1px solid #ccc;padding:.2em .6em;text-align:left;\
         vertical-align:top}}svg{{max-width:100%;height:auto}}code{{background:#f3f3f3}}</style></head><body>\n\
         <h1>{title}</h1>\n<p>Quasistatic frictional contact of a viscoelastic body (Kelvin-Voigt) with a rigid foundation, \
         as an FMI {} Co-Simulation FMU. Lengths in m, stresses in Pa, times in s.</p>\n",
        match version {
            FmiVersion::Fmi2 => "2.0",
            FmiVersion::Fmi3 => "3.0",
        }
    );
    html.push_str(&picture(&compilation.body.mesh, model));
    let _ = writeln!(
        html,
        "<p>{} cells, {} nodes, {} free displacement components; {} contact nodes (dots), in the order of all arrays over \
         the contact. Kept of the body: {:?}, {} states.</p>",
        summary.mesh_cells,
        summary.mesh_nodes,
        summary.free_dofs,
        model.contact().node_count(),
        summary.kind,
        model.states(),
    );
    html.push_str(USE);
    html.push_str(&variables_table(
        &Variables::new(model),
        version == FmiVersion::Fmi2 || is_scalar,
    ));
    let needs = match &library.glibc {
        Some(version) => format!("It needs glibc {version} or newer"),
        None => "It needs the system libraries it was built with".to_owned(),
    };
    let _ = write!(
        html,
        "<h2>Requirements</h2>\n<p>The shared library is for Linux on x86-64. {needs} and nothing else: no tool, no licence, \
         no environment variable, no file outside the FMU. It makes no threads and prints nothing.</p>\n</body></html>\n"
    );
    html
}

const USE: &str = "<h2>Use</h2>\n<ul>\
<li>Inputs are the load intensities at the end of the next step; within the step they go linearly from the last value \
(or jump at its beginning, for loads declared with <code>hold</code>). With FMI 2 input derivatives a step ends with the value that \
was set plus the derivative times the step.</li>\
<li>A step of any positive size is cut into equal internal steps no larger than <code>time.step</code>.</li>\
<li>States can be saved, restored and serialized at any time; a restored run continues bit for bit, in another process too.</li>\
<li>Directional (and in FMI 3 adjoint) derivatives are those of the outputs at the end of the last step by the inputs at its end. \
Where a contact node changes between stick and slip it is the derivative of the branch on which the step ended.</li>\
<li>Output derivatives of order 1 are known exactly for displacements and slips, and refused for other outputs.</li>\
<li>Fixed parameters may change until the initialization ends; the scene that the FMU carries is then compiled anew. \
Friction coefficients may change between steps; set them in an order that keeps a at least b.</li>\
<li>A step whose friction does not converge leaves the state as it was (FMI 3: Discard; FMI 2: Error); try a smaller one.</li>\
</ul>\n";

fn variables_table(variables: &Variables, is_scalar: bool) -> String {
    let mut html = "<h2>Variables</h2>\n<table><tr><th>Name</th><th>Unit</th><th>Kind</th><th>Size</th><th>Meaning</th></tr>\n"
        .to_owned();
    for variable in variables.all() {
        let kind = match variable.role {
            Role::Time => "time",
            Role::Input => "input",
            Role::Output => "output",
            Role::Tunable => "tunable parameter",
            Role::Fixed => "fixed parameter",
        };
        let size: Vec<String> = variable.shape.iter().map(usize::to_string).collect();
        let names = match (is_scalar, variable.element_names().as_slice()) {
            (true, [first, .., last]) => format!("{first} ... {last}"),
            _ => variable.name.clone(),
        };
        let mut meaning = escaped(&variable.description);
        if let Some(choice) = variable.choice {
            let words = Variables::words(choice).iter().enumerate();
            let list: Vec<String> = words.map(|(i, word)| format!("{} {word}", i + 1)).collect();
            let _ = write!(meaning, " Choices: {}.", list.join(", "));
        }
        let _ = writeln!(
            html,
            "<tr><td><code>{}</code></td><td>{}</td><td>{kind}</td><td>{}</td><td>{meaning}</td></tr>",
            escaped(&names),
            variable.unit,
            size.join(" &times; "),
        );
    }
    html + "</table>\n"
}

/// The mesh as SVG: in 3D its outer faces in oblique projection.
pub fn picture(mesh: &Mesh, model: &Model) -> String {
    let project = |p: &[f64; 3]| [p[0] + 0.45 * p[2], -(p[1] + 0.35 * p[2])];
    let points: Vec<[f64; 2]> = mesh.nodes.iter().map(project).collect();
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for point in &points {
        for i in 0..2 {
            low[i] = low[i].min(point[i]);
            high[i] = high[i].max(point[i]);
        }
    }
    let extent = [high[0] - low[0], high[1] - low[1]];
    let scale = 760.0 / extent[0].max(2.0 * extent[1]).max(f64::MIN_POSITIVE);
    let at = |p: &[f64; 2]| {
        (
            20.0 + (p[0] - low[0]) * scale,
            20.0 + (p[1] - low[1]) * scale,
        )
    };
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0} {:.0}\" width=\"800\">\n<path fill=\"none\" \
         stroke=\"#4a6fa5\" stroke-width=\"0.7\" d=\"",
        40.0 + extent[0] * scale,
        40.0 + extent[1] * scale
    );
    let mut draw = |nodes: &[u32]| {
        for (i, node) in nodes.iter().enumerate() {
            let (x, y) = at(&points[*node as usize]);
            let _ = write!(svg, "{}{x:.1} {y:.1}", if i == 0 { "M" } else { "L" });
        }
        svg.push('Z');
    };
    if mesh.dimension == 2 {
        // sides are straight: the corners draw quadratic triangles too
        mesh.cells().for_each(|cell| draw(&cell[..3]));
    } else {
        // the faces that look towards the reader: the upper, the right and the nearest side
        let sides = ["top", "right", "back"];
        let faces = sides.iter().filter_map(|side| mesh.parts.get(*side));
        faces.for_each(|faces| faces.chunks_exact(3).for_each(&mut draw));
    }
    svg.push_str("\"/>\n");
    for point in &model.contact().points {
        let (x, y) = at(&project(point));
        let _ = writeln!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.5\" fill=\"#c0392b\"/>"
        );
    }
    svg + "</svg>\n"
}
