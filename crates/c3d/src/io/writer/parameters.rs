mod own;
mod record;

use crate::trial::{Trial, is_reserved};
use crate::{BLOCK, Group, WriteError};

/// The parameter section, coded.
pub(super) struct Section {
    /// Whole blocks, from the section's first four bytes on.
    pub bytes: Vec<u8>,
    /// Points a frame.
    pub n_points: u16,
    /// Block in which the data starts.
    pub data_block: u16,
}

/// Block in which the section starts: behind the header.
const SECTION_BLOCK: u64 = 2;

/// Codes the parameters of a trial, its own fields among them.
pub(super) fn section(trial: &Trial) -> Result<Section, WriteError> {
    check(trial)?;
    let n_points = own::n_points(trial)?;
    // The data's place stands among the parameters and depends on their length, though not on its own value.
    let draft = records(&own::groups(trial, n_points, 0)?, trial)?;
    let n_blocks = (draft.len() as u64 + 4).div_ceil(BLOCK);
    let data_block = u16::try_from(SECTION_BLOCK + n_blocks).map_err(|_| WriteError::TooLarge {
        what: "the parameter section",
        found: n_blocks,
        limit: 0xfffd,
    })?;
    // Readers that count blocks find the end by the data's place where the count, one byte, is too small.
    let counted = n_blocks.min(0xff) as u8;
    let mut bytes = vec![1, 0x50, counted, trial.processor.number()];
    bytes.extend(records(&own::groups(trial, n_points, data_block)?, trial)?);
    bytes.resize((n_blocks * BLOCK) as usize, 0);
    Ok(Section { bytes, n_points, data_block })
}

fn check(trial: &Trial) -> Result<(), WriteError> {
    if trial.n_frames == 0 {
        return Err(WriteError::NoFrames);
    }
    if trial.labels.is_empty() && trial.n_frames > 0xffff {
        // Nothing in the file would bear out so many.
        let found = trial.n_frames as u64;
        return Err(WriteError::TooLarge { what: "the frames without points", found, limit: 0xffff });
    }
    let numbers =
        [("the scale", trial.scale, trial.scale > 0.0), ("the rate", trial.rate_hz, trial.rate_hz >= 0.0)];
    for (name, value, makes_sense) in numbers {
        if !makes_sense || !trial.processor.holds(value) {
            return Err(WriteError::Number { name: name.into(), value });
        }
    }
    for group in &trial.parameters.groups {
        if let Some(parameter) = group.parameters.iter().find(|p| is_reserved(&group.name, &p.name)) {
            let name = format!("{}:{}", group.name, parameter.name);
            return Err(WriteError::Reserved { name });
        }
    }
    Ok(())
}

/// All records and the end mark.
fn records(groups: &[Group], trial: &Trial) -> Result<Vec<u8>, WriteError> {
    let mut bytes = Vec::new();
    for (id, group) in (1..).zip(groups) {
        let group_id = i8::try_from(id).map_err(|_| WriteError::TooLarge {
            what: "the groups",
            found: groups.len() as u64,
            limit: 127,
        })?;
        // A group that was never named in the file it comes from has no record of its own.
        if !group.name.is_empty() || group.locked || !group.description.is_empty() {
            record::push_group(&mut bytes, group_id, group, trial.processor)?;
        }
        for parameter in &group.parameters {
            record::push_parameter(&mut bytes, group_id, group, parameter, trial.processor)?;
        }
    }
    bytes.push(0);
    Ok(bytes)
}
