use crate::EffError;
use crate::array::Encoding;
use crate::finding::Place;
use crate::format::{FORMAT, VERSION};
use crate::manifest::{FieldInfo, Manifest, PoseInfo, SamplesInfo};
use crate::scan::Findings;
use crate::wire::edits::Edits;
use tousle_core::Quantity;
use tousle_field::{FieldLayer, GridSpec, Scene};

/// All that must be known of a field before its first step is written.
#[derive(Clone, Debug)]
pub struct Head<'a> {
    /// What the field is called.
    pub name: &'a str,
    /// The method that made it.
    pub method: &'a str,
    /// The program that made it.
    pub generator: &'a str,
    /// Where the voxels are.
    pub grid: GridSpec,
    /// What the vectors are.
    pub quantity: Quantity,
    /// Time of the first step, s.
    pub start_secs: f64,
    /// Steps a second.
    pub rate_hz: f64,
    /// How many steps there will be, if that is known.
    pub n_steps: Option<u64>,
    /// The edits.
    pub layers: &'a [FieldLayer],
    /// The scene, with all its poses.
    pub scene: &'a Scene,
    /// Quantity, rate and number of steps of the samples, if there will be any.
    pub samples: Option<(Quantity, f64, u64)>,
}

/// The manifest of a file that begins so.
///
/// # Errors
/// [`EffError::BadValue`] if the body holds what a file cannot.
pub(super) fn manifest(head: &Head<'_>, encoding: Encoding) -> Result<Manifest, EffError> {
    let poses = &head.scene.poses;
    Ok(Manifest {
        format: FORMAT.into(),
        version: VERSION,
        requires: Vec::new(),
        name: head.name.into(),
        method: head.method.into(),
        generator: head.generator.into(),
        field: FieldInfo {
            quantity: head.quantity.into(),
            grid: head.grid.into(),
            start_secs: head.start_secs,
            rate_hz: head.rate_hz,
            n_steps: head.n_steps,
            encoding: encoding.into(),
        },
        pose: PoseInfo {
            start_secs: poses.start_secs,
            rate_hz: poses.rate_hz,
            n_poses: poses.poses.len() as u64,
        },
        scene: head.scene.try_into()?,
        samples: head.samples.map(|(quantity, rate_hz, n_steps)| SamplesInfo {
            quantity: quantity.into(),
            rate_hz,
            n_steps,
        }),
        extensions: serde_json::Map::new(),
    })
}

/// Checks what JSON would turn into `null`, and everything that a reader would refuse.
pub(crate) fn check(manifest: &Manifest, edits: &Edits) -> Result<(), EffError> {
    let mut findings = Findings::first_error();
    crate::check::manifest(manifest, Place::default(), &mut findings);
    crate::check::edits(edits, &edits.requires(), Place::default(), &mut findings);
    if let Some(finding) = findings.into_first_error() {
        return Err(EffError::bad(finding.what, finding.found, finding.expected));
    }
    if let Encoding::Fixed { max_error } = manifest.field.encoding.encoding()
        && max_error <= 0.0
    {
        return Err(EffError::bad("max_error", max_error, "a number above 0"));
    }
    let mut numbers: Vec<(&str, f64)> = vec![
        ("field.grid.edge_m", manifest.field.grid.edge_m),
        ("scene.air_density", manifest.scene.air_density),
        ("scene.body.friction", manifest.scene.body.friction),
        ("field.encoding.max_absolute_error", manifest.field.encoding.max_absolute_error),
    ];
    numbers.extend(manifest.field.grid.origin_m.iter().map(|c| ("field.grid.origin_m", *c)));
    numbers.extend(manifest.scene.gravity_world.iter().map(|c| ("scene.gravity_world", *c)));
    numbers.extend(manifest.scene.body.pivot_m.iter().map(|c| ("scene.body.pivot_m", *c)));
    for collider in &manifest.scene.body.colliders {
        numbers.extend(collider.shape.numbers().map(|c| ("scene.body.colliders", c)));
    }
    for layer in &edits.layers {
        numbers.extend(layer.numbers().map(|c| ("layers", c)));
    }
    match numbers.into_iter().find(|(_, number)| !number.is_finite()) {
        Some((what, found)) => Err(EffError::bad(what, found, "a finite number")),
        None => Ok(()),
    }
}
