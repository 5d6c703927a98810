mod along;
pub(crate) mod head;
mod samples;

use crate::array::{self, Encoding, Shape};
use crate::finding::Place;
use crate::format::{PROFILE, STREAMS, Stream, time_ns, topic};
use crate::manifest::Manifest;
use crate::preview::{PREVIEWS, Preview};
use crate::wire::edits::Edits;
use crate::wire::proto;
use crate::{Eff, EffError, check, decode, reader};
pub use head::Head;
use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use prost::Message as _;
use serde::Serialize;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use tousle_core::{Pose, Progress, WindSample};
use tousle_field::{Field, GridSpec};

/// How a field file is written.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct WriteOptions {
    /// How the field's vectors are packed.
    pub encoding: Encoding,
    /// Whether viewers of robots' logs get channels of their own, with wind they can draw.
    pub has_preview: bool,
}

impl WriteOptions {
    /// Options with this encoding.
    pub fn with_encoding(encoding: Encoding) -> Self {
        Self { encoding, ..Self::default() }
    }

    /// These options, with channels for viewers.
    pub fn with_preview(self) -> Self {
        Self { has_preview: true, ..self }
    }
}

/// What was written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct WriteReport {
    /// The file's length, bytes.
    pub n_bytes: u64,
    /// Steps of the field.
    pub n_steps: u64,
    /// The largest error that packing made in any component, in the quantity's unit.
    pub max_error: f64,
}

/// Writes a field file to a stream: the same bytes for the same field, whatever the machine does besides.
///
/// # Errors
/// [`EffError`] if the stream fails or the field holds what a file cannot: a number that is not finite, a time
/// before 0, a value beyond the encoding's range.
pub fn write<W: Write>(
    eff: &Eff,
    out: W,
    options: &WriteOptions,
    progress: &dyn Progress,
) -> Result<WriteReport, EffError> {
    eff.field.check()?;
    let n_steps = eff.field.steps.len() as u64;
    let head = Head {
        name: &eff.name,
        method: &eff.method,
        generator: &eff.generator,
        grid: eff.field.grid,
        quantity: eff.field.quantity,
        start_secs: eff.field.start_secs,
        rate_hz: eff.field.rate_hz,
        n_steps: Some(n_steps),
        layers: &eff.field.layers,
        scene: &eff.scene,
        samples: eff.samples.as_ref().map(|s| (s.quantity, s.rate_hz, s.steps.len() as u64)),
    };
    let mut writer = Writer::new(out, &head, options)?;
    for attachment in &eff.attachments {
        writer.attachment(attachment)?;
    }
    let samples = eff.samples.as_ref().map_or(&[][..], |s| &s.steps);
    for (k, step) in (0..).zip(&eff.field.steps) {
        progress.at(k, n_steps);
        writer.samples_before(k, |j| Ok::<_, EffError>(Cow::Borrowed(&samples[j as usize])))?;
        writer.step(step)?;
    }
    progress.at(n_steps, n_steps);
    writer.finish().map(|(report, _)| report)
}

/// Writes a field file step by step, holding one of them at a time.
///
/// What is dropped before [`Writer::finish`] leaves a cut file, which every reader takes for one.
pub struct Writer<W: Write> {
    /// `None` once finished.
    mcap: Option<mcap::Writer<NoSeek<Counted<W>>>>,
    manifest: Manifest,
    encoding: Encoding,
    preview: Option<Preview>,
    /// Messages written so far, by channel.
    counts: BTreeMap<u16, u64>,
    attachment_names: BTreeSet<String>,
    /// Bytes of messages in the chunk that is open.
    n_open: usize,
    report: WriteReport,
}

impl<W: Write> std::fmt::Debug for Writer<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Writer").field("manifest", &self.manifest).field("report", &self.report).finish()
    }
}

/// So many steps come after the samples of their times, which share a chunk. The fewer, the less a cut file lacks;
/// the more, the better samples pack and the fewer chunks have to be found to read them all.
const STEPS_A_BATCH: u64 = 16;

/// Small messages share a chunk up to this many bytes: few enough to find one quickly, many enough that
/// compression sees what repeats.
const SHARED_CHUNK: usize = 1 << 20;

/// Zstandard's level 1: at byte planes of noisy floats higher levels gain a percent and take twice the time.
const LEVEL: u32 = 1;

impl<W: Write> Writer<W> {
    /// Begins a file: manifest, edits and poses are written at once.
    ///
    /// # Errors
    /// [`EffError`] if the stream fails or the head holds what a file cannot.
    pub fn new(out: W, head: &Head<'_>, options: &WriteOptions) -> Result<Self, EffError> {
        let edits = Edits { layers: head.layers.iter().map(Into::into).collect() };
        let manifest = head::manifest(head, options.encoding)?;
        head::check(&manifest, &edits)?;
        Self::begin(out, manifest, &edits, &head.scene.poses.poses, options.has_preview)
    }

    /// Begins a file with a manifest that was checked.
    pub(crate) fn begin(
        out: W,
        mut manifest: Manifest,
        edits: &Edits,
        poses: &[Pose],
        has_preview: bool,
    ) -> Result<Self, EffError> {
        manifest.requires = edits.requires();
        let layers = || edits.layers.iter().cloned().map(Into::into).collect();
        let preview = has_preview.then(|| Preview::new(&manifest, poses, layers()));
        let mcap_options = mcap::WriteOptions::new()
            .profile(PROFILE)
            .library(concat!("tousle-eff ", env!("CARGO_PKG_VERSION")))
            .compression(Some(mcap::Compression::Zstd))
            .compression_level(LEVEL)
            // Any other number than none changes the bytes.
            .compression_threads(0)
            .chunk_size(None)
            .disable_seeking(true);
        let out = NoSeek::new(Counted { inner: out, n_bytes: 0 });
        let mut writer = Self {
            mcap: Some(mcap_options.create(out)?),
            encoding: manifest.field.encoding.encoding(),
            preview,
            manifest,
            counts: BTreeMap::new(),
            attachment_names: BTreeSet::new(),
            n_open: 0,
            report: WriteReport::default(),
        };
        writer.channels(!edits.layers.is_empty())?;
        let payload = serde_json::to_vec(&writer.manifest).map_err(std::io::Error::from)?;
        writer.message(topic::MANIFEST, 0, &payload)?;
        if !edits.layers.is_empty() {
            let payload = serde_json::to_vec(edits).map_err(std::io::Error::from)?;
            writer.message(topic::EDITS, 0, &payload)?;
        }
        writer.close_chunk()?;
        writer.poses(poses)?;
        Ok(writer)
    }

    /// Declares the channels that this file will use.
    fn channels(&mut self, has_edits: bool) -> Result<(), EffError> {
        let has_samples = self.manifest.samples.is_some();
        let has_preview = self.preview.is_some();
        for (id, stream) in (1..).zip(STREAMS.iter().chain(&PREVIEWS)) {
            let is_used = match stream.topic {
                topic::EDITS => has_edits,
                topic::SAMPLES => has_samples,
                topic::PREVIEW_HEAD | topic::PREVIEW_WIND => has_preview,
                _ => true,
            };
            if is_used {
                let mcap = self.mcap();
                mcap.add_schema_with_id(id, stream.schema_name, stream.schema_encoding, stream.schema)?;
                mcap.add_channel_with_id(id, id, stream.topic, stream.message_encoding, &BTreeMap::new())?;
            }
        }
        Ok(())
    }

    fn poses(&mut self, poses: &[Pose]) -> Result<(), EffError> {
        for (k, pose) in poses.iter().enumerate() {
            let time_ns = step_time("pose", self.manifest.pose.pose_secs(k as u64))?;
            let (translation, rotation) = (pose.translation.vector.into(), pose.rotation.coords.into());
            check::pose(translation, rotation, "", Place::default())
                .map_err(|f| EffError::bad(format!("pose {k}, {}", f.what), f.found, f.expected))?;
            let ([x, y, z], [qx, qy, qz, qw]) = (translation, rotation);
            let message = proto::PoseStep {
                index: k as u64,
                time_ns,
                translation_m: Some(proto::Vector3 { x, y, z }),
                rotation: Some(proto::Quaternion { x: qx, y: qy, z: qz, w: qw }),
            };
            self.message(topic::POSE, time_ns, &message.encode_to_vec())?;
        }
        self.close_chunk()
    }

    /// Writes the samples of the next step.
    ///
    /// # Errors
    /// [`EffError`] if the stream fails, no samples were announced, or a number cannot be.
    pub fn samples(&mut self, samples: &[WindSample]) -> Result<(), EffError> {
        let index = self.count(topic::SAMPLES);
        let Some(info) = self.manifest.samples.filter(|info| index < info.n_steps) else {
            let expected = self.manifest.samples.map_or(0, |s| s.n_steps);
            return Err(EffError::bad("steps of samples", index + 1, format!("{expected}, as announced")));
        };
        let time_ns = step_time("samples", info.step_secs(index))?;
        let message = samples::pack(samples, index, time_ns)?;
        self.message(topic::SAMPLES, time_ns, &message.encode_to_vec())
    }

    /// Writes the samples that have their place before step `k`: those of the times up to the next batch of steps,
    /// and before the last batch (or if nobody knows how many steps will come) all that are left. `samples` gives
    /// those of a step of samples. A file that is cut anywhere then has whole steps and their samples.
    ///
    /// # Errors
    /// What `samples` gives, or [`EffError`] as [`Writer::samples`].
    pub fn samples_before<'s, E: From<EffError>>(
        &mut self,
        k: u64,
        mut samples: impl FnMut(u64) -> Result<Cow<'s, [WindSample]>, E>,
    ) -> Result<(), E> {
        let Some(info) = self.manifest.samples.filter(|_| k.is_multiple_of(STEPS_A_BATCH)) else {
            return Ok(());
        };
        let next_batch = k + STEPS_A_BATCH;
        let is_last = self.manifest.field.n_steps.is_none_or(|n| next_batch >= n);
        let until_secs = self.manifest.field.step_secs(next_batch);
        loop {
            let j = self.count(topic::SAMPLES);
            if j >= info.n_steps || !(is_last || info.step_secs(j) < until_secs) {
                return Ok(());
            }
            self.samples(&samples(j)?)?;
        }
    }

    /// Writes the next step of the field, in a chunk of its own.
    ///
    /// # Errors
    /// [`EffError`] if the stream fails, the step does not fit the grid, or a number cannot be.
    pub fn step(&mut self, step: &Field) -> Result<(), EffError> {
        self.step_as(step, self.encoding)
    }

    /// Writes the next step, packed in this way, which must be the manifest's or the one that loses nothing.
    pub(crate) fn step_as(&mut self, step: &Field, encoding: Encoding) -> Result<(), EffError> {
        let index = self.count(topic::FIELD);
        let info = &self.manifest.field;
        let grid = info.grid.spec();
        check_step(step, &grid, index)?;
        let shape = Shape { planes: 3, dims: grid.dims };
        let u = array::pack(&step.u, shape, encoding).map_err(|unpackable| {
            EffError::bad(format!("step {index}"), unpackable.found, unpackable.expected)
        })?;
        if encoding != Encoding::F32 {
            let read = array::unpack(&u, shape, Place::default(), "u")?;
            let errors = read.iter().zip(&step.u).map(|(a, b)| (f64::from(*a) - f64::from(*b)).abs());
            self.report.max_error = errors.fold(self.report.max_error, f64::max);
        }
        let [x, y, z] = step.outside.into();
        self.packed_step(proto::FieldStep {
            u: Some(u),
            flags: step.flags.iter().map(|flag| *flag as u8).collect(),
            sd: step.sd.as_deref().map(|sd| match encoding {
                Encoding::F32 => array::pack_f32(sd),
                _ => array::pack_f16_if_possible(sd),
            }),
            outside: Some(proto::Vector3 { x, y, z }),
            ..proto::FieldStep::default()
        })
    }

    /// Writes the next step as it was packed elsewhere, with the index and the time it has here.
    pub(crate) fn packed_step(&mut self, step: proto::FieldStep) -> Result<(), EffError> {
        let index = self.count(topic::FIELD);
        let time_ns = step_time("field", self.manifest.field.step_secs(index))?;
        let message = proto::FieldStep { index, time_ns, ..step };
        self.close_chunk()?;
        self.message(topic::FIELD, time_ns, &message.encode_to_vec())?;
        self.close_chunk()?;
        self.report.n_steps += 1;
        self.preview(index, time_ns, message)
    }

    /// Shows a step to viewers, if they are to see it.
    fn preview(&mut self, index: u64, time_ns: u64, step: proto::FieldStep) -> Result<(), EffError> {
        let Some(preview) = &self.preview else { return Ok(()) };
        let secs = self.manifest.field.step_secs(index);
        // As it was packed: what is shown is what is in the file.
        let step =
            decode::unpack_step(step, &self.manifest.field, Place::default()).map_err(reader::first)?;
        let (head, wind) = (preview.head(time_ns, secs), preview.wind(time_ns, secs, &step));
        self.message(topic::PREVIEW_HEAD, time_ns, &head.encode_to_vec())?;
        self.message(topic::PREVIEW_WIND, time_ns, &wind.encode_to_vec())?;
        self.close_chunk()
    }

    /// Ends the file; gives what was written, and the stream.
    ///
    /// # Errors
    /// [`EffError`] if the stream fails or there are other numbers of steps than were announced.
    pub fn finish(mut self) -> Result<(WriteReport, W), EffError> {
        let announced = [
            (topic::FIELD, self.manifest.field.n_steps.unwrap_or(self.report.n_steps.max(1))),
            (topic::SAMPLES, self.manifest.samples.map_or(0, |s| s.n_steps)),
        ];
        for (topic, expected) in announced {
            let found = self.count(topic);
            if found != expected {
                return Err(EffError::bad(
                    format!("steps on {topic}"),
                    found,
                    format!("{expected}, as announced"),
                ));
            }
        }
        self.close_chunk()?;
        self.mcap().finish()?;
        let mcap = self.mcap.take().expect("it is taken here and in drop only");
        let counted = mcap.into_inner().into_inner();
        self.report.n_bytes = counted.n_bytes;
        Ok((self.report, counted.inner))
    }

    fn message(&mut self, topic: &str, log_time: u64, payload: &[u8]) -> Result<(), EffError> {
        let channel_id = channel_id(topic);
        let count = self.counts.entry(channel_id).or_default();
        let header = MessageHeader { channel_id, sequence: *count as u32, log_time, publish_time: log_time };
        *count += 1;
        self.put(&header, payload)
    }

    /// Ends the chunk that is open, so that all written so far survives whatever comes.
    fn close_chunk(&mut self) -> Result<(), EffError> {
        self.n_open = 0;
        Ok(self.mcap().flush()?)
    }

    fn count(&self, topic: &str) -> u64 {
        self.counts.get(&channel_id(topic)).copied().unwrap_or(0)
    }

    fn mcap(&mut self) -> &mut mcap::Writer<NoSeek<Counted<W>>> {
        self.mcap.as_mut().expect("it is taken in finish and drop only")
    }
}

impl<W: Write> Drop for Writer<W> {
    /// The container's own drop would end the file as if it were whole; taking the stream from it prevents that.
    fn drop(&mut self) {
        if let Some(mcap) = self.mcap.take() {
            drop(mcap.into_inner());
        }
    }
}

/// The channel of a topic; its schema has the same number.
fn channel_id(topic: &str) -> u16 {
    let place = STREAMS.iter().chain(&PREVIEWS).position(|s: &Stream| s.topic == topic);
    place.expect("only the format's own topics are written") as u16 + 1
}

fn check_step(step: &Field, grid: &GridSpec, index: u64) -> Result<(), EffError> {
    let n = grid.n_voxels();
    let sd_len = step.sd.as_ref().map_or(n, Vec::len);
    let sizes = [("u", step.u.len(), 3 * n), ("flags", step.flags.len(), n), ("sd", sd_len, n)];
    for (what, found, expected) in sizes {
        if found != expected {
            return Err(EffError::bad(format!("step {index}, {what}"), found, expected));
        }
    }
    check::finite(&step.u, "u", Place::default())
        .and_then(|()| check::finite_vector(step.outside.into(), "outside", Place::default()))
        .and_then(|()| step.sd.as_deref().map_or(Ok(()), |sd| check::deviations(sd, Place::default())))
        .map_err(|f| EffError::bad(format!("step {index}, {}", f.what), f.found, f.expected))
}

fn step_time(what: &str, secs: f64) -> Result<u64, EffError> {
    time_ns(secs).ok_or_else(|| EffError::bad(format!("{what}, time of a step"), secs, "0 to 1e6 s"))
}

/// A stream that counts.
struct Counted<W> {
    inner: W,
    n_bytes: u64,
}

impl<W: Write> Write for Counted<W> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let n = self.inner.write(bytes)?;
        self.n_bytes += n as u64;
        Ok(n)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.inner.flush()
    }
}
