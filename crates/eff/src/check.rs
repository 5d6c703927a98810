//! Whether what was decoded can be: numbers in their ranges, rotations that rotate, times in step.

mod manifest;

use crate::decode::Stamp;
use crate::finding::Place;
use crate::format::time_ns;
use crate::manifest::{EncodingName, FieldInfo};
use crate::scan::Findings;
use crate::wire::edits::Edits;
use crate::wire::proto;
use crate::{Code, Finding};
pub(crate) use manifest::manifest;
use std::collections::BTreeSet;
use std::fmt::Display;
use tousle_core::WindSample;

/// How far the length of a quaternion may be from 1.
const UNIT_TOLERANCE: f64 = 1e-6;

/// Checks what edits say, and that the manifest asks for the features they need. JSON holds finite numbers only.
pub(crate) fn edits(edits: &Edits, requires: &[String], place: Place<'_>, findings: &mut Findings) {
    for feature in edits.requires().iter().filter(|feature| !requires.contains(feature)) {
        let found = format!("{requires:?} for edits that need it");
        findings.push(place.finding(Code::Requires, "requires", found, feature));
    }
    let mut ids = BTreeSet::new();
    for (k, layer) in edits.layers.iter().enumerate() {
        if !ids.insert(&layer.id) {
            let what = format!("layers[{k}].id");
            findings.push(place.finding(
                Code::DuplicateId,
                what,
                format!("{:?} again", layer.id),
                "each id once",
            ));
        }
        let mut expect = |is_so: bool, what: String, found: &dyn Display, expected: &str| {
            if !is_so {
                findings.push(place.finding(Code::Value, format!("layers[{k}].{what}"), found, expected));
            }
        };
        expect(
            layer.last_secs > layer.first_secs,
            "last_secs".into(),
            &layer.last_secs,
            &format!("later than first_secs, {}", layer.first_secs),
        );
        for (what, share) in [("rise", layer.rise), ("fall", layer.fall)] {
            expect((0.0..=1.0).contains(&share), what.into(), &share, "0 to 1");
        }
        // 0.7 + 0.3 is not 1 in doubles.
        let both = layer.rise + layer.fall;
        expect(both <= 1.0 + 1e-9, "rise + fall".into(), &both, "at most 1");
        for (h, handle) in layer.handles.iter().enumerate() {
            let what = format!("handles[{h}].reach_m");
            expect(handle.reach_m > 0.0, what, &handle.reach_m, "a number above 0");
        }
        if let Some(reshape) = &layer.reshape {
            expect(reshape.scale >= 0.0, "reshape.scale".into(), &reshape.scale, "0 or a number above");
        }
    }
}

/// Checks what a message says of its place and time against where it is and when it should be.
pub(crate) fn stamp(
    stamp: Stamp,
    k: u64,
    secs: f64,
    log_time: u64,
    place: Place<'_>,
    findings: &mut Findings,
) {
    if stamp.index != k {
        findings.push(place.finding(Code::Order, "index", stamp.index, k));
    }
    if stamp.time_ns != log_time {
        let expected = format!("the message's log time, {log_time}");
        findings.push(place.finding(Code::Time, "time_ns", stamp.time_ns, expected));
    }
    // Another program may round a half the other way.
    let expected = time_ns(secs);
    if expected.is_none_or(|t| t.abs_diff(log_time) > 1) {
        let expected = expected.map_or_else(|| "at most 1e15".into(), |t| t.to_string());
        findings.push(place.finding(Code::Time, "message.log_time", log_time, expected));
    }
}

/// Checks that a pose is finite and a rotation.
pub(crate) fn pose(
    translation: [f64; 3],
    rotation: [f64; 4],
    path: &str,
    place: Place<'_>,
) -> Result<(), Box<Finding>> {
    finite_vector(translation, &format!("{path}translation_m"), place)?;
    let length = rotation.iter().map(|c| c * c).sum::<f64>().sqrt();
    if (length - 1.0).abs() <= UNIT_TOLERANCE {
        return Ok(());
    }
    let found = format!("a quaternion of length {length}");
    Err(place.finding(Code::Rotation, format!("{path}rotation"), found, "length 1"))
}

/// Checks that all numbers are finite.
pub(crate) fn finite(values: &[f32], what: &str, place: Place<'_>) -> Result<(), Box<Finding>> {
    if tousle_field::all_finite(values) {
        return Ok(());
    }
    let Some(k) = values.iter().position(|v| !v.is_finite()) else { return Ok(()) };
    Err(place.finding(Code::NotFinite, format!("{what}[{k}]"), values[k], "a finite number"))
}

/// Checks that a vector is finite.
pub(crate) fn finite_vector(vector: [f64; 3], what: &str, place: Place<'_>) -> Result<(), Box<Finding>> {
    if vector.iter().all(|c| c.is_finite()) {
        return Ok(());
    }
    Err(place.finding(Code::NotFinite, what, format!("{vector:?}"), "finite numbers"))
}

/// Checks that standard deviations are 0 or above; infinite means unknown.
pub(crate) fn deviations(sd: &[f32], place: Place<'_>) -> Result<(), Box<Finding>> {
    let Some(k) = sd.iter().position(|sd| sd.is_nan() || *sd < 0.0) else { return Ok(()) };
    Err(place.finding(Code::Value, format!("sd[{k}]"), sd[k], "0 or above"))
}

/// Checks that covariances can be: no NaN, variances not below 0, no correlation above 1.
pub(crate) fn covariances(samples: &[WindSample], place: Place<'_>) -> Result<(), Box<Finding>> {
    for (k, sample) in samples.iter().enumerate() {
        if !is_covariance(sample.covariance) {
            let found = format!("{:?}", sample.covariance);
            return Err(place.finding(
                Code::Covariance,
                format!("covariance[{k}]"),
                found,
                "a positive semidefinite matrix",
            ));
        }
    }
    Ok(())
}

/// Whether six numbers (xx, yy, zz, xy, xz, yz) are a covariance to within what a float rounds. Infinite
/// variances stand for what is unknown; what goes with them is not looked at.
fn is_covariance([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> bool {
    if [xx, yy, zz, xy, xz, yz].iter().any(|c| c.is_nan()) || [xx, yy, zz].iter().any(|v| *v < 0.0) {
        return false;
    }
    let pair = |a: f64, b: f64, ab: f64| {
        !(a.is_finite() && b.is_finite()) || ab * ab <= a * b * (1.0 + 1e-5) + 1e-12 * (a + b) * (a + b)
    };
    if !(pair(xx, yy, xy) && pair(xx, zz, xz) && pair(yy, zz, yz)) {
        return false;
    }
    if ![xx, yy, zz].iter().all(|v| v.is_finite()) {
        return true;
    }
    let determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
    let trace = xx + yy + zz;
    determinant >= -1e-6 * trace * trace * trace
}

/// Checks that a step's arrays are packed as the manifest says, or without loss. Where it speaks of another kind, all
/// of them are packed otherwise: the first says it.
pub(crate) fn encodings(
    u: &proto::Array,
    sd: Option<&proto::Array>,
    info: &FieldInfo,
    place: Place<'_>,
) -> Result<(), Box<Finding>> {
    use proto::Encoding as E;
    let (vectors, deviations): (&[E], &[E]) = match info.encoding.kind {
        EncodingName::F32 => (&[E::F32], &[E::F32]),
        EncodingName::F16 => (&[E::F32, E::F16], &[E::F32, E::F16]),
        EncodingName::Fixed => (&[E::F32, E::Fixed16, E::Fixed32], &[E::F32, E::F16]),
    };
    encoding(u, vectors, place, "u")?;
    let most = 2.0 * info.encoding.max_absolute_error;
    if u.quantum > most {
        let expected = format!("at most {most}, twice the manifest's error bound");
        return Err(place.finding(Code::Encoding, "u.quantum", u.quantum, expected));
    }
    sd.map_or(Ok(()), |sd| encoding(sd, deviations, place, "sd"))
}

/// Checks that an array is packed in a way that it may be, and has no quantum where it needs none. Of an encoding that
/// nobody knows and of a quantum that is none unpacking speaks.
pub(crate) fn encoding(
    array: &proto::Array,
    allowed: &[proto::Encoding],
    place: Place<'_>,
    what: &str,
) -> Result<(), Box<Finding>> {
    use proto::Encoding as E;
    let found = match E::try_from(array.encoding) {
        Ok(E::Unspecified) | Err(_) => return Ok(()),
        Ok(found) => found,
    };
    if !allowed.contains(&found) {
        let found = format!("{found:?}");
        let expected = allowed.iter().map(|e| format!("{e:?}")).collect::<Vec<_>>().join(" or ");
        return Err(place.finding(Code::Encoding, format!("{what}.encoding"), found, expected));
    }
    if matches!(found, E::F32 | E::F16) && array.quantum != 0.0 {
        return Err(place.finding(Code::Encoding, format!("{what}.quantum"), array.quantum, "0"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn covariances_by_hand() {
        assert!(is_covariance([1.0, 2.0, 3.0, 0.0, 0.0, 0.0]));
        // Fully correlated: (1, 2, 3) times its transpose.
        assert!(is_covariance([1.0, 4.0, 9.0, 2.0, 3.0, 6.0]));
        assert!(is_covariance([f64::INFINITY, f64::INFINITY, f64::INFINITY, 0.0, 0.0, 0.0]));
        assert!(!is_covariance([1.0, 1.0, 1.0, 1.5, 0.0, 0.0]));
        assert!(!is_covariance([-1.0, 1.0, 1.0, 0.0, 0.0, 0.0]));
        assert!(!is_covariance([f64::NAN, 1.0, 1.0, 0.0, 0.0, 0.0]));
        // Every pair is possible, all three together are not.
        assert!(!is_covariance([1.0, 1.0, 1.0, 0.9, 0.9, -0.9]));
    }

    #[test]
    fn finite_finds_the_first_that_is_not() {
        assert!(finite(&[1.0, f32::MAX, f32::MAX], "u", Place::default()).is_ok());
        let finding = finite(&[1.0, 2.0, f32::INFINITY, f32::NAN], "u", Place::default()).unwrap_err();
        assert_eq!(finding.what, "u[2]");
    }
}
