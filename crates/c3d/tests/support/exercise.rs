// What has to hold for any bytes whatever; the fuzz target includes this file too.

use tousle_c3d::{Point, Reader, Trial, Writer};

/// Reads all of a file, if it is one, and writes it again.
///
/// # Panics
/// If reading by frame and by point differ, or if what was written is read differently.
pub fn exercise(bytes: &[u8]) {
    let mut reader = match Reader::from_bytes(bytes) {
        Ok(reader) => reader,
        Err(e) => return assert!(!e.to_string().is_empty()),
    };
    for warning in reader.warnings() {
        assert!(!warning.to_string().is_empty());
    }
    let (trial, frames) = read(&mut reader);
    assert_eq!(trial.labels.len(), reader.info().kinds.len());
    // What the reader lets pass but no writer should write (a group without a name that has a description…) is refused.
    let Ok(again) = write(&trial, &frames) else { return };
    let mut reader = Reader::from_bytes(&again).expect("what was written is a C3D file");
    let (trial_again, frames_again) = read(&mut reader);
    // Compared as text: a NaN among the parameters is equal to nothing, itself included.
    assert_eq!(format!("{trial_again:?}"), format!("{trial:?}"));
    assert!(frames_again == frames, "points differ after writing");
}

type Frames = Vec<Vec<Option<Point>>>;

fn read(reader: &mut Reader<std::io::Cursor<&[u8]>>) -> (Trial, Frames) {
    let n_frames = reader.info().n_frames;
    let all: Vec<_> = (0..reader.info().n_points).collect();
    let mut frames = Vec::new();
    reader
        .read_frames(&all, 0..n_frames, |_, points| frames.push(points.to_vec()))
        .expect("points that are there");
    let trajectories = reader.read_trajectories(&all, 0..n_frames).expect("points that are there");
    for (point_idx, trajectory) in trajectories.iter().enumerate() {
        assert!(trajectory.iter().eq(frames.iter().map(|frame| &frame[point_idx])));
    }
    (reader.trial(), frames)
}

fn write(trial: &Trial, frames: &Frames) -> Result<Vec<u8>, tousle_c3d::WriteError> {
    let mut writer = Writer::new(Vec::new(), trial)?;
    for frame in frames {
        writer.write_frame(frame)?;
    }
    writer.finish()
}
