use super::parameters::Section;
use crate::trial::Trial;
use crate::{BLOCK, Storage, WriteError};

/// The header block of a trial whose parameter section is known.
pub(super) fn block(trial: &Trial, section: &Section) -> Result<Vec<u8>, WriteError> {
    let processor = trial.processor;
    let mut block = vec![0; BLOCK as usize];
    // The parameter section stands in block 2, as nearly everywhere; 0x50 is the format's key.
    block[..2].copy_from_slice(&[2, 0x50]);
    let mut word = |n: usize, value: u16| {
        block[2 * n - 2..2 * n].copy_from_slice(&processor.write_u16(value));
    };
    word(2, section.n_points);
    word(4, frame_number(trial, 0));
    word(5, frame_number(trial, trial.n_frames.wrapping_sub(1)));
    word(9, section.data_block);
    let mut float = |n: usize, value: f32| {
        block[2 * n - 2..2 * n + 2].copy_from_slice(&processor.write_f32(value));
    };
    float(7, signed_scale(trial));
    float(11, trial.rate_hz);
    Ok(block)
}

/// The scale as files have it: negative for floats.
pub(super) fn signed_scale(trial: &Trial) -> f32 {
    match trial.storage {
        Storage::Float32 => -trial.scale,
        Storage::Int16 => trial.scale,
    }
}

/// The number of a frame in the header: 65535 stands for itself and all that is more.
fn frame_number(trial: &Trial, frame: usize) -> u16 {
    let number = i64::from(trial.first_frame).saturating_add(frame as i64);
    number.clamp(0, 0xffff) as u16
}
