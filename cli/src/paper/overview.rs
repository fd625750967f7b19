//! One picture of the example: the deformed body, and stress and velocity along the contact.

use super::deformed::Deformed;
use super::laws::{self, Law};
use crate::failure::Failure;
use crate::pictures::{Panel, Sheet};
use std::path::Path;

pub fn draw(out: &Path, laws: &[Law], body: &Deformed) -> Result<(), Failure> {
    Sheet {
        title: "Kelvin-Voigt body pressed on a rigid foundation (Kazmi et al. 2014, section 7)"
            .to_owned(),
        width: 960,
        height: 800,
        rows: vec![
            (1.2, vec![Panel::Body(body.view())]),
            (
                1.0,
                vec![
                    Panel::Curves(laws::stress(laws)),
                    Panel::Curves(laws::velocity(laws)),
                ],
            ),
        ],
    }
    .save(out, "overview")
}
