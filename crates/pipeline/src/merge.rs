use crate::{GENERATOR, Watch};
use sha2::{Digest, Sha256};
use std::borrow::Cow;
use std::fmt::Write as _;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;
use tousle_core::{WindSample, WindSamples};
use tousle_eff::{Attachment, EffError, Encoding, Head, Reader, WriteOptions, WriteReport, Writer};
use tousle_field::{Field, Scene};
use tousle_merge::{Input, InputReport, MergeError, MergeOptions, MergeReport, Plan, Tally};

/// A field file that is to be merged.
#[derive(Debug)]
pub struct MergeSource<'a, R> {
    /// Its name, for messages and for the merged file.
    pub name: &'a str,
    /// Its bytes.
    pub input: R,
    /// What is added to its times to have them on the common clock, s.
    pub offset_secs: f64,
}

/// Why field files cannot become one.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MergeFilesError {
    /// A file cannot be read.
    #[error("cannot use the field {name} (`tousle validate` lists all that is wrong)")]
    Read {
        /// The file.
        name: String,
        /// Why.
        source: EffError,
    },
    /// Two files are the same, and what is measured once would count twice.
    #[error("found the same file twice, {first} and {second}, expected different captures")]
    SameFile {
        /// One.
        first: String,
        /// The other.
        second: String,
    },
    /// The fields cannot become one.
    #[error("cannot merge the fields")]
    Merge(#[from] MergeError),
    /// The merged field cannot be written.
    #[error("cannot write the merged field")]
    Write(#[source] EffError),
}

/// Merges field files into one, a step at a time: memory does not grow with their length.
///
/// The merged file keeps the inputs' measured vectors, edits and attachments (as `inputs/1/session.json`), and
/// `merge.json`, which says what was merged, how, and how well it agreed. Without an `encoding` it is packed as the inputs
/// are, if they are packed alike.
///
/// # Errors
/// [`MergeFilesError`] with the file.
pub fn merge<R: Read + Seek, W: Write>(
    sources: Vec<MergeSource<'_, R>>,
    out: W,
    options: &MergeOptions,
    encoding: Option<Encoding>,
    has_preview: bool,
    watch: &dyn Watch,
) -> Result<(MergeReport, WriteReport), MergeFilesError> {
    let stage = watch.stage("open");
    let n_sources = sources.len() as u64;
    let mut opened = Vec::new();
    for (k, source) in (0..).zip(sources) {
        stage.at(k, n_sources);
        opened.push(Opened::open(source)?);
    }
    drop(stage);
    all_differ(&opened)?;
    let plan = Plan::new(&opened.iter().map(Opened::input).collect::<Vec<_>>(), options)?;
    let mut warnings = plan.warnings.clone();
    let samples = samples(&opened, &mut warnings);
    warn_of_silent(&opened, &mut warnings);
    let write = WriteOptions::with_encoding(encoding.unwrap_or_else(|| common_encoding(&opened)));
    let write = if has_preview { write.with_preview() } else { write };

    // The report stands before the steps in the file: they are merged twice, first to be counted.
    let stage = watch.stage("compare");
    let mut tally = Tally::new(opened.len());
    for k in 0..plan.n_steps {
        stage.at(k, plan.n_steps);
        merged_step(&plan, &mut opened, k, &mut tally)?;
    }
    drop(stage);
    let report = tally.report(opened.iter().map(|o| o.report(&plan)).collect(), warnings);

    let stage = watch.stage("merge");
    let name = opened.iter().map(|o| o.reader.manifest().name.as_str()).collect::<Vec<_>>().join(" + ");
    let method =
        common(opened.iter().map(|o| o.reader.manifest().method.as_str())).unwrap_or("mixed").to_owned();
    let head = Head {
        name: &name,
        method: &method,
        generator: GENERATOR,
        grid: plan.grid,
        quantity: plan.quantity,
        start_secs: plan.start_secs,
        rate_hz: plan.rate_hz,
        n_steps: Some(plan.n_steps),
        layers: &plan.layers,
        scene: &plan.scene,
        samples: samples.as_ref().map(|s| (s.quantity, s.rate_hz, s.steps.len() as u64)),
    };
    let mut writer = Writer::new(out, &head, &write).map_err(MergeFilesError::Write)?;
    for attachment in attachments(&mut opened, &report)? {
        writer.attachment(&attachment).map_err(MergeFilesError::Write)?;
    }
    let vectors = samples.as_ref().map_or(&[][..], |s| &s.steps);
    for k in 0..plan.n_steps {
        stage.at(k, plan.n_steps);
        let step = merged_step(&plan, &mut opened, k, &mut Tally::new(n_sources as usize))?;
        writer
            .samples_before(k, |j| Ok(Cow::Borrowed(&vectors[j as usize][..])))
            .and_then(|()| writer.step(&step))
            .map_err(MergeFilesError::Write)?;
    }
    let (written, _) = writer.finish().map_err(MergeFilesError::Write)?;
    Ok((report, written))
}

/// An input whose manifest, scene and samples were read.
struct Opened<'a, R> {
    name: &'a str,
    offset_secs: f64,
    sha256: String,
    reader: Reader<R>,
    scene: Scene,
    samples: Option<WindSamples>,
    /// The last steps that were read, with their numbers.
    recent: Vec<(u64, Field)>,
}

impl<'a, R: Read + Seek> Opened<'a, R> {
    fn open(source: MergeSource<'a, R>) -> Result<Self, MergeFilesError> {
        let MergeSource { name, mut input, offset_secs } = source;
        let read = |source| MergeFilesError::Read { name: name.to_owned(), source };
        let sha256 = sha256(&mut input).map_err(|e| read(e.into()))?;
        let mut reader = Reader::open(input).map_err(read)?;
        let scene = reader.scene().map_err(read)?;
        let steps: Vec<Vec<WindSample>> = reader.samples().map_err(read)?;
        let samples = reader.manifest().samples.map(|info| WindSamples {
            quantity: info.quantity.into(),
            rate_hz: info.rate_hz,
            steps,
        });
        Ok(Self { name, offset_secs, sha256, reader, scene, samples, recent: Vec::new() })
    }

    fn input(&self) -> Input<'_> {
        let field = &self.reader.manifest().field;
        Input {
            name: self.name,
            quantity: field.quantity.into(),
            grid: field.grid.spec(),
            start_secs: field.start_secs,
            rate_hz: field.rate_hz,
            n_steps: self.reader.n_steps(),
            layers: self.reader.layers(),
            scene: &self.scene,
            offset_secs: self.offset_secs,
        }
    }

    /// Makes sure that these steps are at hand, and no others.
    fn have(&mut self, wanted: [u64; 2]) -> Result<(), MergeFilesError> {
        self.recent.retain(|(k, _)| wanted.contains(k));
        for k in wanted {
            if self.recent.iter().all(|(have, _)| *have != k) {
                let read = |source| MergeFilesError::Read { name: self.name.to_owned(), source };
                let step = self.reader.step(k).map_err(read)?;
                self.recent.extend(step.map(|step| (k, step)));
            }
        }
        Ok(())
    }

    fn at_hand(&self, wanted: u64) -> Option<&Field> {
        self.recent.iter().find(|(k, _)| *k == wanted).map(|(_, step)| step)
    }

    fn report(&self, plan: &Plan) -> InputReport {
        let manifest = self.reader.manifest();
        let field = &manifest.field;
        let start_secs = field.start_secs + self.offset_secs;
        let last = self.reader.n_steps().saturating_sub(1) as f64 / field.rate_hz;
        let span_secs = match self.reader.n_steps() {
            1 => [plan.start_secs, plan.step_secs(plan.n_steps - 1)],
            _ => [start_secs, start_secs + last],
        };
        InputReport {
            // Wherever it lies, so that the same files give the same bytes.
            name: Path::new(self.name)
                .file_name()
                .map_or_else(|| self.name.to_owned(), |n| n.to_string_lossy().into_owned()),
            sha256: self.sha256.clone(),
            field: manifest.name.clone(),
            method: manifest.method.clone(),
            generator: manifest.generator.clone(),
            offset_secs: self.offset_secs,
            span_secs,
            ..InputReport::default()
        }
    }
}

fn sha256<R: Read + Seek>(input: &mut R) -> std::io::Result<String> {
    input.seek(SeekFrom::Start(0))?;
    let mut hash = Sha256::new();
    let mut bytes = vec![0; 1 << 16];
    loop {
        match input.read(&mut bytes)? {
            0 => break,
            n => hash.update(&bytes[..n]),
        }
    }
    input.seek(SeekFrom::Start(0))?;
    Ok(hash.finalize().iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    }))
}

fn all_differ<R>(opened: &[Opened<'_, R>]) -> Result<(), MergeFilesError> {
    for (k, second) in opened.iter().enumerate() {
        if let Some(first) = opened[..k].iter().find(|first| first.sha256 == second.sha256) {
            let (first, second) = (first.name.to_owned(), second.name.to_owned());
            return Err(MergeFilesError::SameFile { first, second });
        }
    }
    Ok(())
}

/// The measured vectors of all, if they can be one.
fn samples<R>(opened: &[Opened<'_, R>], warnings: &mut Vec<String>) -> Option<WindSamples> {
    let parts: Vec<_> = opened.iter().filter_map(|o| Some((o.samples.as_ref()?, o.offset_secs))).collect();
    if parts.is_empty() {
        return None;
    }
    match tousle_merge::join_samples(&parts) {
        Ok(samples) => Some(samples),
        Err(why) => {
            warnings.push(format!("the measured vectors stay in their own files: {why}"));
            None
        }
    }
}

/// Inputs without standard deviations are not heard where others have them: that should be no surprise.
fn warn_of_silent<R: Read + Seek>(opened: &[Opened<'_, R>], warnings: &mut Vec<String>) {
    let methods: Vec<_> = opened.iter().map(|o| o.reader.manifest().method.as_str()).collect();
    if common(methods.iter().copied()).is_none() {
        warnings.push(format!(
            "the fields were made by different methods ({}); one without standard deviations is not heard in a voxel \
             where another of the same flag has one",
            methods.join(", ")
        ));
    }
}

/// How all inputs are packed, if they are packed alike; without loss otherwise.
fn common_encoding<R: Read + Seek>(opened: &[Opened<'_, R>]) -> Encoding {
    common(opened.iter().map(|o| o.reader.manifest().field.encoding.encoding())).unwrap_or_default()
}

/// What all are, if they are the same.
fn common<T: PartialEq>(mut all: impl Iterator<Item = T>) -> Option<T> {
    let first = all.next()?;
    all.all(|other| other == first).then_some(first)
}

/// Step `k` of the merged field.
fn merged_step<R: Read + Seek>(
    plan: &Plan,
    opened: &mut [Opened<'_, R>],
    k: u64,
    tally: &mut Tally,
) -> Result<Field, MergeFilesError> {
    let mut wanted = Vec::new();
    for (i, input) in opened.iter_mut().enumerate() {
        if let Some(between) = plan.wanted(i, k) {
            input.have([between.before, between.after])?;
            wanted.push((i, between));
        }
    }
    let views: Vec<(usize, Cow<'_, Field>)> = wanted
        .into_iter()
        .filter_map(|(i, between)| {
            let (before, after) = (opened[i].at_hand(between.before)?, opened[i].at_hand(between.after)?);
            Some((i, plan.view(i, between, before, after)))
        })
        .collect();
    tally.step_of(&views.iter().map(|(i, _)| *i).collect::<Vec<_>>());
    Ok(tousle_merge::combine(&views.iter().map(|(_, view)| &**view).collect::<Vec<_>>(), tally))
}

/// What was merged and how, and the inputs' own attachments.
fn attachments<R: Read + Seek>(
    opened: &mut [Opened<'_, R>],
    report: &MergeReport,
) -> Result<Vec<Attachment>, MergeFilesError> {
    let bytes = serde_json::to_vec_pretty(report).expect("a report is made of strings, numbers and lists");
    let mut all =
        vec![Attachment { name: "merge.json".to_owned(), media_type: "application/json".to_owned(), bytes }];
    for (k, input) in opened.iter_mut().enumerate() {
        let read = |source| MergeFilesError::Read { name: input.name.to_owned(), source };
        for attachment in input.reader.attachments().map_err(read)? {
            let name = format!("inputs/{}/{}", k + 1, attachment.name);
            all.push(Attachment { name, ..attachment });
        }
    }
    Ok(all)
}
