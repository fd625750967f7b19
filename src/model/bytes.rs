//! A compiled model as bytes: the scene and the compiled numbers, in a frame (see `crate::bytes`).
//!
//! Reading needs neither the mesh nor the assembly. The fingerprint is a hash of the whole payload: it tells apart
//! models of equal scenes whose numbers differ (another mesh file, another machine's rounding), because the coordinates
//! of a saved state mean something only together with the very numbers of the model.

use super::certificate::{Certificate, CoulombConstants};
use super::free::{FreeMaterial, blend_of};
use super::motions::Motions;
use super::parts::Parts;
use super::selection::Selection;
use super::start::InitialState;
use super::{BodyModel, Model, ReductionRecord, ensure_available};
use crate::body::condensed::Condensed;
use crate::body::field::Field;
use crate::body::free::Free;
use crate::body::full::Full;
use crate::body::reduced::Reduced;
use crate::bytes::{Frame, LARGEST, Reader, Writer};
use crate::error::{Error, Result};
use crate::fem::{ContactPart, ContactPatch, Pin};
use crate::files::MemoryFiles;
use crate::scene::{ModelKind, Scene};
use std::sync::Arc;
use xxhash_rust::xxh3::xxh3_64;

const FRAME: Frame = Frame {
    magic: *b"SLIPMODL",
    // also to be raised when states or steps of models with equal bytes are no longer interchangeable
    format: 7,
    what: "compiled model",
};

impl Model {
    /// The compiled model as versioned, checksummed, little-endian bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Writer::framed();
        self.write(&mut out);
        // the selection is stored for information and excluded from the fingerprint
        Selection::write(self.summary.selection.as_ref(), &mut out);
        let fallback = self.summary.fallback.as_deref();
        out.word(u64::from(fallback.is_some()));
        fallback.iter().for_each(|why| out.text(why));
        out.float(self.summary.lost_digits);
        // so are files: what of them matters is in the compiled numbers, whatever version they have
        if self.scene.mesh.file().is_some() {
            self.files.write(&mut out);
        }
        out.seal(&FRAME, self.fingerprint)
    }

    /// The model of [`Model::to_bytes`], bit for bit.
    ///
    /// # Errors
    /// [`Error::Bytes`] for bytes that are no model of this format, truncated or damaged.
    pub fn from_bytes(bytes: &[u8]) -> Result<Model> {
        let (fingerprint, payload) = FRAME.open(bytes)?;
        let mut from = Reader::new(payload);
        let scene = from.text()?;
        let scene: Scene = serde_json::from_str(scene)
            .map_err(|e| Reader::refusal(format!("compiled model: its scene is refused: {e}")))?;
        scene
            .validate("compiled model")
            .map_err(|error| Reader::refusal(error.to_string()))?;
        let parts = read_parts(&mut from, &scene)?;
        from.finish()?;
        scene
            .validate_in(parts.dimension)
            .map_err(|error| Reader::refusal(error.to_string()))?;
        let model = Model::new(&scene, parts)?;
        let (needed, limit) = (model.simulator_bytes(), scene.fidelity.memory_limit());
        if needed as f64 > limit {
            return Err(Reader::refusal(format!(
                "compiled model: a simulator takes {needed} bytes, more than the {limit} of fidelity.memory_limit"
            )));
        }
        ensure_available("a simulator of the model", needed)
            .map_err(|error| Reader::refusal(error.to_string()))?;
        if model.fingerprint != fingerprint {
            return Err(Error::Fingerprint {
                expected: fingerprint,
                found: model.fingerprint,
            });
        }
        Ok(model)
    }

    pub(super) fn compute_fingerprint(&self) -> u64 {
        let mut out = Writer::framed();
        match self.free {
            None => self.write(&mut out),
            // that of the model with any values of the numbers that stay free
            Some(_) => {
                out.text(&self.scene_of_fingerprint());
                self.write_sizes(&mut out);
                self.write_body(&mut out);
            }
        }
        xxh3_64(out.payload())
    }

    fn write(&self, out: &mut Writer) {
        out.text(&self.scene.to_json());
        self.write_sizes(out);
        self.write_constants(out);
        self.write_body(out);
    }

    fn write_sizes(&self, out: &mut Writer) {
        let summary = &self.summary;
        out.word(kind_number(summary.kind));
        for size in [
            summary.dimension,
            summary.mesh_nodes,
            summary.mesh_cells,
            summary.free_dofs,
        ] {
            out.word(size as u64);
        }
    }

    fn write_constants(&self, out: &mut Writer) {
        let summary = &self.summary;
        // without a dashpot the fastest is infinite
        out.floats(&summary.rates.map(|rate| rate.min(LARGEST)));
        let record = summary.reduction.as_ref();
        out.floats(record.map_or(&[], |r| &r.shifts));
        out.float(record.map_or(0.0, |r| r.achieved));
        match self.strain_weights {
            Some((x, y)) => out.floats(&[x, y]),
            None => out.floats(&[]),
        }
        let c = &self.certificate;
        out.floats(&[
            c.c0_squared,
            c.l_g,
            c.m_a,
            c.l_a,
            c.l_b,
            c.sharp_instant,
            c.sharp_step,
        ]);
        if let Some(coulomb) = c.coulomb {
            // a coefficient may rise without limit
            out.float(coulomb.coefficient.min(f64::MAX));
            out.float(coulomb.weakening);
            out.float(coulomb.coupling);
        }
    }

    fn write_body(&self, out: &mut Writer) {
        out.floats(&self.measures);
        write_contact(&self.contact, out);
        InitialState::write(self.initial.as_ref(), out);
        self.motions.write(out);
        self.body.write(out);
    }
}

fn read_parts(from: &mut Reader, scene: &Scene) -> Result<Parts> {
    let kind = read_kind(from)?;
    let (dimension, mesh_nodes, mesh_cells, free_dofs) =
        (from.size()?, from.size()?, from.size()?, from.size()?);
    if scene.mesh.dimension().is_some_and(|d| d != dimension) || !matches!(dimension, 2 | 3) {
        return Err(Reader::refusal("compiled model: dimension of the scene"));
    }
    let most = u32::MAX as usize;
    if mesh_nodes > most || mesh_cells > most || free_dofs > most {
        return Err(Reader::refusal("compiled model: sizes of the mesh"));
    }
    let rates: [f64; 2] = array(from)?;
    let rates = rates.map(|rate| if rate < LARGEST { rate } else { f64::INFINITY });
    let (shifts, achieved) = (from.finite()?, from.float()?);
    let strain_weights = match from.finite()?[..] {
        [x, y] => Some((x, y)),
        [] => None,
        _ => {
            return Err(Reader::refusal(
                "compiled model: weights of the strain norm",
            ));
        }
    };
    let [c0_squared, l_g, m_a, l_a, l_b, sharp_instant, sharp_step] = array(from)?;
    let coulomb = match scene.each_contact().any(|c| c.friction.is_coulomb()) {
        false => None,
        true => Some(CoulombConstants {
            coefficient: match from.float()? {
                f64::MAX => f64::INFINITY,
                value => value,
            },
            weakening: from.float()?,
            coupling: from.float()?,
        }),
    };
    let measures = from.finite()?;
    if measures.len() != scene.loads.len() {
        return Err(Reader::refusal("compiled model: number of loads"));
    }
    let is_positive = |values: &[f64]| values.iter().all(|v| *v > 0.0);
    let is_possible = is_positive(&rates)
        && is_positive(&measures)
        && is_positive(&[c0_squared, l_b, sharp_step])
        && m_a >= 0.0
        && l_a >= m_a
        && sharp_instant >= 0.0
        && l_g >= 0.0
        && coulomb.is_none_or(|c| c.coefficient >= 0.0 && c.weakening >= 0.0 && c.coupling >= 0.0)
        && achieved.is_finite();
    if !is_possible {
        return Err(Reader::refusal(
            "compiled model: rates, measures or certificate",
        ));
    }
    let contact = read_contact(from, scene, dimension - 1)?;
    let contact_len = contact.force_len();
    let of_contact = (contact.node_count(), contact.components);
    let initial = InitialState::read(from, of_contact, contact.has_normal)?;
    let sizes = (contact_len, dimension);
    let motions = Motions::read(from, scene, sizes, initial.is_some())?;
    let loads = motions.force_count();
    let outputs = loads + scene.probes.len() * dimension;
    if initial
        .as_ref()
        .is_some_and(|initial| !initial.fits(outputs))
    {
        return Err(Reader::refusal("compiled model: initial displacement"));
    }
    let has_strain = strain_weights.is_none();
    let mut field = || {
        Field::read(
            from,
            scene,
            free_dofs,
            contact_len,
            loads,
            outputs,
            has_strain,
        )
    };
    let mut free = None;
    let body: Arc<dyn BodyModel> = match kind {
        ModelKind::Reduced if scene.fidelity.free_material => {
            let ports = (contact_len, loads, outputs);
            let precision = scene.fidelity.precision;
            let blend = |branches| blend_of(scene, Some(branches));
            let body = Arc::new(Free::read(from, ports, precision, blend)?);
            free = FreeMaterial::new(scene, Arc::clone(&body));
            body
        }
        _ if scene.fidelity.free_material => {
            return Err(Reader::refusal(
                "compiled model: a free material of a whole mesh",
            ));
        }
        ModelKind::Full => Arc::new(Full(field()?)),
        ModelKind::Condensed => Arc::new(Condensed(field()?)),
        _ => Arc::new(Reduced::read(
            from,
            contact_len,
            loads,
            outputs,
            scene.fidelity.precision,
            has_strain && scene.fidelity.solver.measures_strains(),
        )?),
    };
    Ok(Parts {
        kind,
        body,
        free,
        reduction: (kind == ModelKind::Reduced).then_some(ReductionRecord { shifts, achieved }),
        contact,
        measures,
        motions,
        initial,
        certificate: Certificate {
            c0_squared,
            l_g,
            m_a,
            l_a,
            l_b,
            sharp_instant,
            sharp_step,
            coulomb,
        },
        strain_weights,
        dimension,
        mesh_nodes,
        mesh_cells,
        free_dofs,
        rates,
        selection: Selection::read(from)?,
        fallback: match from.word()? {
            0 => None,
            _ => Some(from.text()?.to_owned()),
        },
        lost_digits: from.float()?,
        files: match scene.mesh.file() {
            Some(_) => MemoryFiles::from_bytes(from)?,
            None => MemoryFiles::default(),
        },
    })
}

fn kind_number(kind: ModelKind) -> u64 {
    match kind {
        ModelKind::Full => 0,
        ModelKind::Condensed => 1,
        ModelKind::Reduced | ModelKind::Auto => 2,
    }
}

fn read_kind(from: &mut Reader) -> Result<ModelKind> {
    match from.word()? {
        0 => Ok(ModelKind::Full),
        1 => Ok(ModelKind::Condensed),
        2 => Ok(ModelKind::Reduced),
        other => Err(Reader::refusal(format!("compiled model of kind {other}"))),
    }
}

fn array<const N: usize>(from: &mut Reader) -> Result<[f64; N]> {
    let values = from.finite()?;
    let found = values.len();
    <[f64; N]>::try_from(values)
        .map_err(|_| Reader::refusal(format!("expected {N} numbers, found {found}")))
}

fn write_contact(contact: &ContactPatch, out: &mut Writer) {
    let nodes: Vec<usize> = contact.nodes.iter().map(|&n| n as usize).collect();
    out.indices(&nodes);
    out.floats(contact.points.as_flattened());
    out.floats(&contact.weights);
    out.floats(contact.tangents.as_flattened().as_flattened());
    out.floats(contact.normals.as_flattened());
    out.floats(&contact.gaps);
    out.word(contact.faces as u64);
    let places: Vec<usize> = contact.pins.iter().map(|pin| pin.component).collect();
    let resistances: Vec<f64> = contact.pins.iter().map(|pin| pin.resistance).collect();
    out.indices(&places);
    out.floats(&resistances);
    // the only contact has all nodes
    if contact.parts.len() > 1 {
        let ends: Vec<usize> = contact.parts.iter().map(|part| part.nodes.end).collect();
        out.indices(&ends);
    }
}

/// Normal components, ascending, no more than a body has motions as a whole.
fn read_pins(
    from: &mut Reader,
    scene: &Scene,
    (nodes, components): (usize, usize),
) -> Result<Vec<Pin>> {
    let stride = components + 1;
    let (places, resistances) = (from.indices(nodes.saturating_mul(stride))?, from.finite()?);
    let is_possible = places.len() == resistances.len()
        && (places.is_empty() || scene.is_pressed())
        && places.windows(2).all(|pair| pair[0] < pair[1])
        && places.iter().all(|place| place % stride == components)
        && resistances.iter().all(|resistance| *resistance > 0.0);
    if !is_possible {
        return Err(Reader::refusal("compiled model: pins of the contact"));
    }
    let pins = places.into_iter().zip(resistances);
    Ok(pins
        .map(|(component, resistance)| Pin {
            component,
            resistance,
        })
        .collect())
}

fn read_contact(from: &mut Reader, scene: &Scene, components: usize) -> Result<ContactPatch> {
    let nodes = from.indices(u32::MAX as usize)?;
    let (points, weights, tangents) = (from.finite()?, from.finite()?, from.finite()?);
    let (normals, gaps) = (from.finite()?, from.finite()?);
    let can_open = scene.can_open();
    let faces = from.size()?;
    let count = nodes.len();
    let pins = read_pins(from, scene, (count, components))?;
    let is_consistent = points.len() == 3 * count
        && weights.len() == count
        && tangents.len() == 6 * count
        && normals.len() == 3 * count
        && gaps.len() == if can_open { count } else { 0 }
        && count > 0
        && faces <= u32::MAX as usize
        && weights.iter().all(|w| *w > 0.0);
    if !is_consistent {
        return Err(Reader::refusal("compiled model: arrays of the contact"));
    }
    let ends = match scene.each_contact().count() {
        1 => vec![count],
        _ => from.indices(count + 1)?,
    };
    let starts = [0].into_iter().chain(ends.iter().copied());
    let parts: Vec<ContactPart> = scene
        .each_contact()
        .zip(starts.zip(&ends))
        .map(|(contact, (start, end))| ContactPart {
            name: contact.name.clone(),
            nodes: start..*end,
            can_open: contact.condition.gap().is_some(),
        })
        .collect();
    let is_divided = ends.len() == scene.each_contact().count()
        && ends.last() == Some(&count)
        && parts.iter().all(|part| !part.nodes.is_empty());
    if !is_divided {
        return Err(Reader::refusal("compiled model: nodes of the contacts"));
    }
    let vector = |v: &[f64]| [v[0], v[1], v[2]];
    Ok(ContactPatch {
        parts,
        nodes: nodes.into_iter().map(|n| n as u32).collect(),
        points: points.chunks_exact(3).map(vector).collect(),
        weights,
        tangents: tangents
            .chunks_exact(6)
            .map(|v| [vector(&v[..3]), vector(&v[3..])])
            .collect(),
        components,
        has_normal: scene.is_pressed(),
        normals: normals.chunks_exact(3).map(vector).collect(),
        gaps,
        faces,
        pins,
    })
}
