//! `stickslip run`: steps a scene on its own signals and reports.

use crate::arguments::RunOptions;
use crate::body_picture;
use crate::closing::{self, Closing};
use crate::console;
use crate::contact_table::ContactTable;
use crate::course;
use crate::failure::Failure;
use crate::port_record::{PortArrays, PortTable};
use crate::run_pictures;
use crate::saved_state;
use crate::source;
use crate::standard;
use crate::vtk::Series;
use std::io::Write;
use std::sync::Arc;
use std::time::Instant;
use stickslip::Simulator;
use stickslip::message::escaped;
use stickslip::simulator::course::Points;

pub fn run(options: &RunOptions) -> Result<(), Failure> {
    let outputs = [&options.csv, &options.ports, &options.json, &options.npz];
    if outputs
        .into_iter()
        .flatten()
        .filter(|path| standard::is_meant(path))
        .count()
        > 1
    {
        return Err(Failure::Option(
            "only one file of results can be standard output",
        ));
    }
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
    let model = &compilation.model;
    let mut ports = match &options.ports {
        Some(path) => Some(PortTable::create(path, model)?),
        None => None,
    };
    let mut arrays = options
        .npz
        .as_ref()
        .map(|path| PortArrays::new(path, model));
    let mut frames = Vec::new();
    let mut closing = Closing::new(setup);
    let mut simulator = Simulator::new(Arc::clone(model));
    if let Some(path) = &options.load_state {
        saved_state::load(path, &mut simulator)?;
    }
    let mut passed = 0;
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
        if let Some(ports) = &mut ports {
            ports.add(simulator)?;
        }
        if let Some(arrays) = &mut arrays {
            arrays.add(simulator)?;
        }
        if let (Some(path), Some(every)) = (&options.save_state, options.checkpoint)
            && passed > 0
            && passed % every == 0
        {
            saved_state::save(path, simulator)?;
        }
        passed += 1;
        closing.watch(frame);
        bar.inc(1);
        Ok(())
    })?;
    bar.finish_and_clear();
    if let Some(table) = table {
        table.finish()?;
    }
    if let Some(ports) = ports {
        ports.finish()?;
    }
    if let Some(arrays) = arrays {
        arrays.finish(model)?;
    }
    if let Some(path) = &options.save_state {
        saved_state::save(path, &simulator)?;
    }
    if let Some(path) = &options.json {
        let failed = Failure::writing(path);
        let mut file = standard::create(path)?;
        let written = writeln!(file, "{:#}", closing.json(model, &effort));
        written
            .and_then(|()| file.flush())
            .map_err(|e| failed(&e))?;
    }
    if let Some(series) = series {
        series.finish()?;
    }
    if let Some(folder) = &options.plots {
        run_pictures::draw(folder, scene, contact, &frames)?;
        body_picture::draw(folder, scene, &compilation, &simulator)?;
    }
    let table = closing.table(model, &effort);
    // beside the first file of results that is standard output
    let on_standard = outputs
        .into_iter()
        .flatten()
        .find(|path| standard::is_meant(path));
    console::say_beside(on_standard.map(|path| path.as_path()), &table)
}
