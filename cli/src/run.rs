//! `stickslip run`: steps a scene on its own signals and reports.

use crate::arguments::RunOptions;
use crate::body_picture;
use crate::closing::{self, Closing};
use crate::console;
use crate::contact_table::ContactTable;
use crate::course;
use crate::failure::Failure;
use crate::run_pictures;
use crate::source;
use crate::vtk::Series;
use std::sync::Arc;
use std::time::Instant;
use stickslip::Simulator;
use stickslip::message::escaped;
use stickslip::simulator::course::Points;

pub fn run(options: &RunOptions) -> Result<(), Failure> {
    let mut replaced = Vec::new();
    for (path, value) in [("run.until", options.until), ("run.step", options.step)] {
        replaced.extend(value.map(|v| (path.to_owned(), format!("{v:?}"))));
    }
    let scene = source::scene(&options.choice, &replaced)?;
    let name = options.choice.name();
    let points = Points::checked(&scene).map_err(Failure::of(name))?;
    let start = Instant::now();
    let compilation =
        console::compile(&scene, &source::files(&options.choice)).map_err(Failure::of(name))?;
    let setup = start.elapsed();
    let scene = &compilation.scene;
    if let Some(limit) = closing::exceeded_limit(&compilation.model) {
        console::warn(&format!(
            "{name}: time.step = {} is beyond the stability limit {limit:.6} s; time.force takes it all the same",
            scene.time.step
        ));
    }

    let contact = &compilation.body.contact;
    let mut table = match &options.csv {
        Some(path) => Some(ContactTable::create(
            path,
            contact,
            compilation.model.ports(),
        )?),
        None => None,
    };
    let mut series = match &options.vtk {
        Some(folder) => Some(Series::create(folder, &scene.name)?),
        None => None,
    };
    let mut frames = Vec::new();
    let mut closing = Closing::new(setup);
    let mut simulator = Simulator::new(Arc::clone(&compilation.model));
    let bar = console::bar(points.count, &escaped(&scene.name));
    let effort = course::follow(scene, name, &mut simulator, |simulator, frame| {
        if let Some(table) = &mut table {
            table.add(contact, frame)?;
        }
        if let Some(series) = &mut series {
            series.add(&compilation, simulator, frame)?;
        }
        if options.plots.is_some() {
            frames.push(frame.clone());
        }
        closing.watch(frame);
        bar.inc(1);
        Ok(())
    })?;
    bar.finish_and_clear();
    if let Some(table) = table {
        table.finish()?;
    }
    if let Some(series) = series {
        series.finish()?;
    }
    if let Some(folder) = &options.plots {
        run_pictures::draw(folder, scene, contact, &frames)?;
        body_picture::draw(folder, scene, &compilation, &simulator)?;
    }
    let table = closing.table(&compilation.model, &effort);
    console::say_beside(options.csv.as_deref(), &table)
}
