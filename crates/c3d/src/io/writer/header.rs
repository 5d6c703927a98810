use super::parameters::Section;
use crate::trial::Trial;
use crate::{BLOCK, Storage};

/// The header block of a trial whose parameter section is known.
pub(super) fn block(trial: &Trial, section: &Section) -> Vec<u8> {
    let processor = trial.processor;
    let mut block = vec![0; BLOCK as usize];
    // The parameter section stands in block 2, as nearly everywhere; 0x50 is the format's key.
    block[..2].copy_from_slice(&[2, 0x50]);
    let mut word = |n: usize, value: u16| {
        block[2 * n - 2..2 * n].copy_from_slice(&processor.write_u16(value));
    };
    word(2, section.n_points);
    word(4, frame_number(trial, 0));
    word(5, frame_number(trial, trial.n_frames - 1));
    word(9, section.data_block);
    let mut float = |n: usize, value: f32| {
        block[2 * n - 2..2 * n + 2].copy_from_slice(&processor.write_f32(value));
    };
    float(7, signed_scale(trial));
    float(11, trial.rate_hz);
    block
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_numbers_stop_where_the_word_ends() {
        let trial = Trial { first_frame: 65_530, n_frames: 6, ..Trial::default() };
        assert_eq!(
            (frame_number(&trial, 0), frame_number(&trial, 5), frame_number(&trial, 6)),
            (65_530, 65_535, 65_535)
        );
        let late = Trial { first_frame: u32::MAX, ..trial };
        assert_eq!(frame_number(&late, 0), 65_535);
    }

    #[test]
    fn a_header_as_the_guide_has_it() {
        let labels = vec![String::new(); 39];
        let trial = Trial { rate_hz: 50.0, first_frame: 3, n_frames: 1092, labels, ..Trial::default() };
        let section = Section { bytes: Vec::new(), n_points: 39, data_block: 8 };
        let block = block(&trial, &section);
        let expected =
            [2, 0x50, 39, 0, 0, 0, 3, 0, 0x46, 0x04, 0, 0, 0, 0, 0x80, 0xbf, 8, 0, 0, 0, 0, 0, 0x48, 0x42];
        assert_eq!((&block[..24], block.len()), (&expected[..], 512));
    }
}
