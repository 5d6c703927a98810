//! C3D files put together byte by byte, so that a test can make every mistake that real files make.
#![allow(dead_code, reason = "each test uses a part")]
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use tousle_c3d::{Info, Point, Reader, Warning};

/// A file in the making. All that is not said is as a careful writer would have it.
#[derive(Clone)]
pub struct File {
    /// 84, 85 or 86; bytes are Intel's whatever this says.
    pub processor: u8,
    pub n_points: u16,
    pub analog_words: u16,
    pub first_frame: u16,
    pub last_frame: u16,
    pub scale: f32,
    /// Behind the parameters if `None`.
    pub data_block: Option<u16>,
    pub analog_samples: u16,
    pub rate_hz: f32,
    /// Records of the parameter section.
    pub records: Vec<u8>,
    /// Blocks that the parameter section counts; as many as there are if `None`.
    pub section_blocks: Option<u8>,
    /// Bytes from the data's start on.
    pub data: Vec<u8>,
}

impl Default for File {
    /// One point in one frame, floats, with the parameters that a reader needs.
    fn default() -> Self {
        Self {
            processor: 84,
            n_points: 1,
            analog_words: 0,
            first_frame: 1,
            last_frame: 1,
            scale: -1.0,
            data_block: None,
            analog_samples: 0,
            rate_hz: 100.0,
            records: [group(1, "POINT"), text(1, "UNITS", &[2], "mm"), text(1, "LABELS", &[1, 1], "A")]
                .concat(),
            section_blocks: None,
            data: points(&[[1.0, 2.0, 3.0, 0.0]]),
        }
    }
}

impl File {
    /// Adds records to the parameter section.
    pub fn with(mut self, records: &[Vec<u8>]) -> Self {
        self.records.extend(records.concat());
        self
    }

    /// The file: header, parameters, data filled up to a block.
    pub fn bytes(&self) -> Vec<u8> {
        let mut records = self.records.clone();
        records.push(0);
        let n_blocks = (records.len() + 4).div_ceil(512);
        let data_block = self.data_block.unwrap_or(2 + n_blocks as u16);
        let mut bytes = vec![2, 0x50];
        for word in [self.n_points, self.analog_words, self.first_frame, self.last_frame, 0] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend(self.scale.to_le_bytes());
        bytes.extend(data_block.to_le_bytes());
        bytes.extend(self.analog_samples.to_le_bytes());
        bytes.extend(self.rate_hz.to_le_bytes());
        bytes.resize(512, 0);
        bytes.extend([1, 0x50, self.section_blocks.unwrap_or(n_blocks as u8), self.processor]);
        bytes.extend(records);
        bytes.resize(512 * (1 + n_blocks), 0);
        bytes.extend(&self.data);
        bytes.resize(bytes.len().next_multiple_of(512), 0);
        bytes
    }

    /// What the reader makes of it.
    pub fn read(&self) -> Read {
        read(&self.bytes())
    }
}

/// What the reader makes of a file.
#[derive(Debug)]
pub struct Read {
    pub info: Info,
    pub warnings: Vec<Warning>,
    /// By point, by frame.
    pub points: Vec<Vec<Option<Point>>>,
}

pub fn read(bytes: &[u8]) -> Read {
    let mut reader = Reader::from_bytes(bytes).unwrap();
    let all: Vec<_> = (0..reader.info().n_points).collect();
    let n_frames = reader.info().n_frames;
    let points = reader.read_trajectories(&all, 0..n_frames).unwrap();
    Read { info: reader.info().clone(), warnings: reader.warnings().to_vec(), points }
}

/// The record that names a group.
pub fn group(id: i8, name: &str) -> Vec<u8> {
    record(-id, name, &[])
}

/// A parameter of text.
pub fn text(id: i8, name: &str, dimensions: &[u8], letters: &str) -> Vec<u8> {
    values(id, name, -1, dimensions, letters.as_bytes())
}

/// A parameter of 16-bit integers.
pub fn ints(id: i8, name: &str, dimensions: &[u8], values: &[u16]) -> Vec<u8> {
    let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    self::values(id, name, 2, dimensions, &bytes)
}

/// A parameter of one 16-bit integer.
pub fn int(id: i8, name: &str, value: u16) -> Vec<u8> {
    ints(id, name, &[], &[value])
}

/// A parameter of one float.
pub fn float(id: i8, name: &str, value: f32) -> Vec<u8> {
    values(id, name, 4, &[], &value.to_le_bytes())
}

fn values(id: i8, name: &str, kind: i8, dimensions: &[u8], bytes: &[u8]) -> Vec<u8> {
    let head = [kind.cast_unsigned(), dimensions.len() as u8];
    record(id, name, &[&head[..], dimensions, bytes].concat())
}

/// A record without description, its pointer right.
fn record(id: i8, name: &str, body: &[u8]) -> Vec<u8> {
    let pointer = (body.len() + 3) as u16;
    [&[name.len() as u8, id.cast_unsigned()], name.as_bytes(), &pointer.to_le_bytes(), body, &[0]].concat()
}

/// Puts another pointer into a record.
pub fn repointed(mut record: Vec<u8>, pointer: u16) -> Vec<u8> {
    let at = 2 + usize::from(record[0]);
    record[at..at + 2].copy_from_slice(&pointer.to_le_bytes());
    record
}

/// Float points: coordinates and fourth word.
pub fn points(points: &[[f32; 4]]) -> Vec<u8> {
    points.iter().flatten().flat_map(|f| f.to_le_bytes()).collect()
}

/// Frames of float points whose x counts the frames and y the points, with analog words of noise behind each.
pub fn frames(n_frames: usize, n_points: usize, n_analog: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    for frame in 0..n_frames {
        for point in 0..n_points {
            bytes.extend(points(&[[frame as f32, point as f32, 0.0, 0.0]]));
        }
        bytes.extend((0..n_analog).flat_map(|i| (-1e6 - i as f32).to_le_bytes()));
    }
    bytes
}

/// Whether these are the points of [`frames`].
pub fn are_frames(points: &[Vec<Option<Point>>]) -> bool {
    points.iter().enumerate().all(|(point, trajectory)| {
        let expected = |frame: usize| Some(Point::at([frame as f32, point as f32, 0.0]));
        trajectory.iter().enumerate().all(|(frame, point)| *point == expected(frame))
    })
}
