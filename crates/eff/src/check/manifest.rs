use crate::finding::Place;
use crate::format::{FORMAT, MAX_RATE_HZ, MAX_SECS, MAX_VOXELS, VERSION};
use crate::manifest::{EncodingName, FieldInfo, Manifest, Scene, Shape};
use crate::scan::Findings;
use crate::{Code, check};
use std::fmt::Display;

/// Checks what a manifest says.
pub(crate) fn manifest(manifest: &Manifest, place: Place<'_>, findings: &mut Findings) {
    let mut expected = Expected { place, findings };
    expected.that(manifest.format == FORMAT, "format", &manifest.format, FORMAT);
    expected.that(manifest.version <= VERSION, "version", manifest.version, "at most 1");
    times(manifest, &mut expected);
    field(&manifest.field, &mut expected);
    scene(&manifest.scene, &mut expected);
}

/// Takes note of what is not as expected.
struct Expected<'a> {
    place: Place<'a>,
    findings: &'a mut Findings,
}

impl Expected<'_> {
    fn that(&mut self, is_so: bool, what: &str, found: impl Display, expected: &str) {
        if !is_so {
            self.findings.push(self.place.finding(Code::Value, what, found, expected));
        }
    }
}

fn times(manifest: &Manifest, expected: &mut Expected<'_>) {
    let Manifest { field, pose, samples, .. } = manifest;
    let rates = [("field.rate_hz", field.rate_hz), ("pose.rate_hz", pose.rate_hz)];
    let samples_rate = samples.iter().map(|s| ("samples.rate_hz", s.rate_hz));
    for (what, rate_hz) in rates.into_iter().chain(samples_rate) {
        expected.that(rate_hz > 0.0 && rate_hz <= MAX_RATE_HZ, what, rate_hz, "above 0, at most 1e6");
    }
    for (what, secs) in [("field.start_secs", field.start_secs), ("pose.start_secs", pose.start_secs)] {
        expected.that((0.0..=MAX_SECS).contains(&secs), what, secs, "0 to 1e6");
    }
    expected.that(field.n_steps != Some(0), "field.n_steps", 0, "at least 1");
    expected.that(pose.n_poses > 0, "pose.n_poses", 0, "at least 1");
    let last = field.step_secs(field.n_steps.unwrap_or(1).saturating_sub(1));
    expected.that(last <= MAX_SECS, "field.n_steps", format!("a last step at {last} s"), "at most 1e6 s");
}

fn field(field: &FieldInfo, expected: &mut Expected<'_>) {
    let grid = &field.grid;
    let is_possible = (1..=MAX_VOXELS).contains(&grid.n_voxels());
    expected.that(is_possible, "field.grid.dims", format!("{:?}", grid.dims), "1 to 16777216 voxels");
    expected.that(grid.edge_m > 0.0, "field.grid.edge_m", grid.edge_m, "a number above 0");
    let encoding = &field.encoding;
    let bounds = [
        ("field.encoding.max_absolute_error", encoding.max_absolute_error),
        ("field.encoding.max_relative_error", encoding.max_relative_error),
    ];
    for (what, bound) in bounds {
        let is_so = match encoding.kind {
            EncodingName::F32 => bound == 0.0,
            EncodingName::F16 | EncodingName::Fixed => bound >= 0.0,
        };
        expected.that(is_so, what, bound, "0 or above; 0 for f32");
    }
}

fn scene(scene: &Scene, expected: &mut Expected<'_>) {
    expected.that(scene.air_density >= 0.0, "scene.air_density", scene.air_density, "0 or above");
    expected.that(scene.body.friction >= 0.0, "scene.body.friction", scene.body.friction, "0 or above");
    for (k, collider) in scene.body.colliders.iter().enumerate() {
        let sizes = match collider.shape {
            Shape::Ellipsoid { half_axes_m, .. } => half_axes_m,
            Shape::Capsule { radius_m, .. } => [radius_m; 3],
        };
        if let Some(size) = sizes.into_iter().find(|s| *s <= 0.0) {
            expected.that(false, &format!("scene.body.colliders[{k}].shape"), size, "sizes above 0");
        }
    }
    let rest = &scene.rest_pose;
    let pose = check::pose(rest.translation_m, rest.rotation_xyzw, "scene.rest_pose.", expected.place);
    if let Err(finding) = pose {
        expected.findings.push(finding);
    }
}
