use crate::finding::Place;
use crate::format::{Stream, topic};
use crate::record::Message;
use crate::scan::Findings;
use crate::wire::foxglove::{FLOAT32, FrameTransform, PointCloud, Timestamp};
use crate::{Code, Finding, check};
use std::fmt::Display;

/// Checks a message of a preview. What is wrong with it is a warning: the field is what it is.
pub(crate) fn check(stream: &Stream, message: Message<'_>, place: Place<'_>, findings: &mut Findings) {
    let checked = match stream.topic {
        topic::PREVIEW_HEAD => head(message, place),
        _ => wind(message, place),
    };
    if let Err(finding) = checked {
        findings.push(finding);
    }
}

fn wrong(place: Place<'_>, what: &str, found: impl Display, expected: impl Display) -> Box<Finding> {
    place.finding(Code::Preview, what, found, expected)
}

fn decode<M: prost::Message + Default>(message: Message<'_>, place: Place<'_>) -> Result<M, Box<Finding>> {
    M::decode(message.data).map_err(|error| wrong(place, "payload", error, "protobuf"))
}

fn time(found: Option<Timestamp>, message: Message<'_>, place: Place<'_>) -> Result<(), Box<Finding>> {
    let expected = Timestamp::from_ns(message.log_time);
    match found {
        Some(found) if found == expected => Ok(()),
        found => {
            let found =
                found.map_or_else(|| "none".to_owned(), |t| format!("{}.{:09} s", t.seconds, t.nanos));
            Err(wrong(place, "timestamp", found, format!("the message's log time, {} ns", message.log_time)))
        }
    }
}

fn head(message: Message<'_>, place: Place<'_>) -> Result<(), Box<Finding>> {
    use crate::wire::proto::{Quaternion, Vector3};
    let transform: FrameTransform = decode(message, place)?;
    time(transform.timestamp, message, place)?;
    let Vector3 { x, y, z } = transform.translation.unwrap_or_default();
    let translation = [x, y, z];
    let Quaternion { x, y, z, w } = transform.rotation.unwrap_or_default();
    check::pose(translation, [x, y, z, w], "", place).map_err(|f| wrong(place, &f.what, f.found, f.expected))
}

fn wind(message: Message<'_>, place: Place<'_>) -> Result<(), Box<Finding>> {
    let cloud: PointCloud = decode(message, place)?;
    time(cloud.timestamp, message, place)?;
    let stride = cloud.point_stride as usize;
    if stride == 0 || !cloud.data.len().is_multiple_of(stride) {
        let found = format!("{} bytes", cloud.data.len());
        return Err(wrong(place, "data", found, format!("points of {stride} bytes")));
    }
    for field in &cloud.fields {
        let what = format!("field {:?}", field.name);
        let end = field.width().and_then(|width| field.offset.checked_add(width));
        if end.is_none_or(|end| end > cloud.point_stride) {
            let found = format!("type {} at byte {}", field.kind, field.offset);
            return Err(wrong(place, &what, found, format!("a number within {stride} bytes")));
        }
        if field.kind == FLOAT32 {
            let at = field.offset as usize;
            let mut floats = cloud.data.chunks_exact(stride).filter_map(|p| p[at..].first_chunk::<4>());
            if let Some(k) = floats.position(|b| !f32::from_le_bytes(*b).is_finite()) {
                return Err(wrong(place, &what, format!("no finite number in point {k}"), "finite numbers"));
            }
        }
    }
    Ok(())
}
