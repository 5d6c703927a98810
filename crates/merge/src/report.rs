use crate::combine::{Heard, Voice};
use serde::Serialize;
use tousle_field::{Field, VoxelFlag};

/// What merging did, for people and for the file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MergeReport {
    /// Each input, in order.
    pub inputs: Vec<InputReport>,
    /// Shares of voxels, over all steps: outside, interpolated, measured.
    pub coverage: [f64; 3],
    /// Voxels and steps that several inputs measured.
    pub n_measured_by_several: u64,
    /// How far such vectors are from their mean, rms of a component, in the quantity's unit.
    pub rms_disagreement: Option<f64>,
    /// The same as a share of what their standard deviations say: 1 if the inputs are as good as they claim.
    pub birge_ratio: Option<f64>,
    /// How far the inputs' winds outside are from their mean, rms of a component, in the quantity's unit.
    pub rms_outside_disagreement: Option<f64>,
    /// What a user should know.
    pub warnings: Vec<String>,
}

/// What one input gave.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct InputReport {
    /// Its file.
    pub name: String,
    /// SHA-256 of its file.
    pub sha256: String,
    /// What it is called.
    pub field: String,
    /// The method by which it was made.
    pub method: String,
    /// The program that made it.
    pub generator: String,
    /// What was added to its times, s.
    pub offset_secs: f64,
    /// Its first and last time on the common clock, s.
    pub span_secs: [f64; 2],
    /// Shares of its own voxels, over the merged steps at which it has something: outside, interpolated, measured.
    pub coverage: [f64; 3],
    /// Share of the merged field's voxels, over all steps, in which it is heard.
    pub heard: f64,
}

/// Counts along the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Tally {
    n_voxels: u64,
    n_flags: [u64; 3],
    n_heard: Vec<u64>,
    n_met: u64,
    sum_spread: f64,
    n_birge: u64,
    sum_birge: f64,
    n_outside: u64,
    sum_outside: f64,
    /// Which input each view of this step is.
    inputs: Vec<usize>,
    n_own: Vec<[u64; 3]>,
}

impl Tally {
    /// Nothing counted yet.
    pub fn new(n_inputs: usize) -> Self {
        Self {
            n_voxels: 0,
            n_flags: [0; 3],
            n_heard: vec![0; n_inputs],
            n_met: 0,
            sum_spread: 0.0,
            n_birge: 0,
            sum_birge: 0.0,
            n_outside: 0,
            sum_outside: 0.0,
            inputs: (0..n_inputs).collect(),
            n_own: vec![[0; 3]; n_inputs],
        }
    }

    /// Says which input each view of the next step is.
    pub fn step_of(&mut self, inputs: &[usize]) {
        self.inputs = inputs.to_vec();
    }

    pub(crate) fn count(&mut self, flag: VoxelFlag, voices: &[Voice]) {
        self.n_voxels += 1;
        self.n_flags[flag as usize] += 1;
        for voice in voices {
            self.n_heard[self.inputs[voice.view]] += 1;
        }
    }

    pub(crate) fn meet(&mut self, flag: VoxelFlag, heard: &Heard) {
        if flag == VoxelFlag::Measured {
            self.n_met += 1;
            self.sum_spread += heard.spread;
            if let Some(birge) = heard.birge_squared() {
                self.n_birge += 1;
                self.sum_birge += birge;
            }
        }
    }

    pub(crate) fn outside(&mut self, views: &[&Field]) {
        for (view, input) in views.iter().zip(&self.inputs) {
            for flag in &view.flags {
                self.n_own[*input][*flag as usize] += 1;
            }
        }
        if views.len() > 1 {
            let n = views.len() as f64;
            let mean = views.iter().map(|v| v.outside).sum::<tousle_core::Vec3>() / n;
            self.n_outside += 1;
            self.sum_outside +=
                views.iter().map(|v| (v.outside - mean).norm_squared()).sum::<f64>() / (3.0 * n);
        }
    }

    /// The report, once all steps are merged. `inputs` has names and times; what was counted is filled in.
    pub fn report(&self, mut inputs: Vec<InputReport>, mut warnings: Vec<String>) -> MergeReport {
        let rms = |sum: f64, n: u64| (n > 0).then(|| (sum / n as f64).sqrt());
        let shares = |counts: [u64; 3]| counts.map(|n| n as f64 / counts.iter().sum::<u64>().max(1) as f64);
        for (k, input) in inputs.iter_mut().enumerate() {
            input.coverage = shares(self.n_own[k]);
            input.heard = self.n_heard[k] as f64 / self.n_voxels.max(1) as f64;
        }
        let rms_disagreement = rms(self.sum_spread, self.n_met);
        let birge_ratio = rms(self.sum_birge, self.n_birge);
        if let Some(ratio) = birge_ratio.filter(|ratio| *ratio > 3.0) {
            warnings.push(format!(
                "where several measured, they differ {ratio:.1} times as much as their standard deviations say: \
                 perhaps it is not the same wind, or the clocks are not the same"
            ));
        }
        MergeReport {
            inputs,
            coverage: shares(self.n_flags),
            n_measured_by_several: self.n_met,
            rms_disagreement,
            birge_ratio,
            rms_outside_disagreement: rms(self.sum_outside, self.n_outside),
            warnings,
        }
    }
}
