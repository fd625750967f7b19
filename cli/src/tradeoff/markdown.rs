//! A short table and the sentences as Markdown, kept up to date within a file such as `docs/measured.md`.

use super::advice;
use super::point::{Group, Point, milestones};
use crate::failure::Failure;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use stickslip::tradeoff::{Quantity, Reference};

/// Where the text goes: between two lines of a file that has them, or into a file that is not there yet.
pub struct Place {
    path: PathBuf,
    before: String,
    after: String,
}

impl Place {
    /// Finds the lines for a scene.
    pub fn find(path: &Path, scene: &str) -> Result<Place, Failure> {
        let [begin, end] =
            ["begin", "end"].map(|word| format!("<!-- tradeoff {scene}: {word} -->"));
        let text = match std::fs::read_to_string(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => format!("{begin}\n{end}\n"),
            outcome => outcome.map_err(|e| Failure::writing(path)(&e))?,
        };
        let parts = text
            .split_once(&begin)
            .and_then(|(before, rest)| Some((before, rest.split_once(&end)?.1)));
        let Some((before, after)) = parts else {
            let why = format!("there are no lines {begin} and {end} between which to write");
            return Err(Failure::writing(path)(&why));
        };
        Ok(Place {
            path: path.to_owned(),
            before: format!("{before}{begin}\n"),
            after: format!("{end}{after}"),
        })
    }

    /// Writes the text and keeps what stands around it.
    pub fn write(&self, text: &str) -> Result<(), Failure> {
        let whole = format!("{}{text}{}", self.before, self.after);
        std::fs::write(&self.path, whole).map_err(|e| Failure::writing(&self.path)(&e))
    }
}

/// Columns of the table.
const HEADER: [&str; 11] = [
    "",
    "slip rate",
    "tangential stress",
    "displacement",
    "friction force",
    "set-up, ms",
    "step, us",
    "1 s of the scene, ms",
    "states",
    "model, kB",
    "state, kB",
];

/// The scene as given, its other models, the front of the error in slip rate, and the sentences.
pub fn text(command: &str, points: &[Point], reference: &Reference) -> String {
    let front = milestones(points, Quantity::SlipRate);
    let is_on_front = |p: &Point| front.iter().any(|on| std::ptr::eq(*on, p));
    let is_compared = |p: &&Point| matches!(p.group, Group::AsGiven | Group::Model);
    let compared = points
        .iter()
        .filter(is_compared)
        .filter(|p| !is_on_front(p));
    let mut rows = vec![
        line(HEADER.map(str::to_owned)),
        line(HEADER.map(|_| "---".to_owned())),
    ];
    rows.extend(compared.chain(front.iter().copied()).map(row));
    let left = Quantity::ALL.map(|q| match reference.uncertainty(q) {
        Some(left) => format!("{} {left:.0e}", q.name()),
        None => format!("{} not compared", q.name()),
    });
    let subjects = [advice::SUBJECTS[0], advice::SUBJECTS[2]];
    let items = advice::sentences(&subjects, (points, reference), "`");
    let items: Vec<String> = items.iter().map(|item| format!("* {item}")).collect();
    format!(
        "`{command}` measured {} settings on one thread.\n\
         Errors are relative, over the contact and the run (stress: L1, others: L2), against a reference that is known to:\n\
         {}.\n\
         After the scene as given come its other models, and the front of error in slip rate against cost, where friction is\n\
         solved to 1e-4 and the body reduced to 1e-4 or the next tolerance that will do.\n\n{}\n\n{}\n",
        points.len(),
        left.join(", "),
        rows.join("\n"),
        items.join("\n")
    )
}

fn row(point: &Point) -> String {
    let [slip_rate, stress, displacement, force] =
        Quantity::ALL.map(|quantity| match point.verdict.of(quantity) {
            None => "-".to_owned(),
            Some(measured) => match measured.figure() {
                Some(error) => format!("{error:.1e}"),
                None => format!("<{:.1e}", measured.bound()),
            },
        });
    line([
        point.label(),
        slip_rate,
        stress,
        displacement,
        force,
        format!("{:.1}", 1e3 * point.setup.as_secs_f64()),
        format!("{:.1}", 1e6 * point.per_step()),
        format!("{:.3}", 1e3 * point.cost()),
        point.states.to_string(),
        point.model_bytes.div_ceil(1024).to_string(),
        point.state_bytes.div_ceil(1024).to_string(),
    ])
}

fn line(cells: [String; HEADER.len()]) -> String {
    format!("| {} |", cells.join(" | "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_around_is_kept() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.md");
        Place::find(&path, "one")
            .expect("a new file")
            .write("1\n")
            .expect("written");
        let new = "<!-- tradeoff one: begin -->\n1\n<!-- tradeoff one: end -->\n";
        assert_eq!(std::fs::read_to_string(&path).expect("a text"), new);
        std::fs::write(&path, format!("before\n\n{new}\nafter\n")).expect("written");
        Place::find(&path, "one")
            .expect("the place")
            .write("22\n")
            .expect("written");
        let text = std::fs::read_to_string(&path).expect("a text");
        assert_eq!(
            text,
            format!("before\n\n{}\nafter\n", new.replace("1\n", "22\n"))
        );
        assert!(Place::find(&path, "two").is_err());
    }
}
