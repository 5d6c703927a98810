//! What is written is read again, exactly; the same trial gives the same bytes.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod arbitrary;

use proptest::prelude::*;
use tousle_c3d::{
    Group, Parameter, Parameters, Point, Processor, Reader, Storage, Trial, Value, WriteError, Writer,
};

type Frames = Vec<Vec<Option<Point>>>;

fn write(trial: &Trial, frames: &Frames) -> Result<Vec<u8>, WriteError> {
    let mut writer = Writer::new(Vec::new(), trial)?;
    for frame in frames {
        writer.write_frame(frame)?;
    }
    writer.finish()
}

fn read(bytes: &[u8]) -> (Trial, Frames) {
    let mut reader = Reader::from_bytes(bytes).unwrap();
    let all: Vec<_> = (0..reader.info().n_points).collect();
    let mut frames = Vec::new();
    let n_frames = reader.info().n_frames;
    reader.read_frames(&all, 0..n_frames, |_, points| frames.push(points.to_vec())).unwrap();
    (reader.trial(), frames)
}

proptest! {
    #[test]
    fn reading_undoes_writing((trial, frames) in arbitrary::recording()) {
        let bytes = write(&trial, &frames).unwrap();
        prop_assert_eq!(bytes.len() % 512, 0);
        prop_assert_eq!(&bytes, &write(&trial, &frames).unwrap(), "the same bytes again");
        let (trial_read, frames_read) = read(&bytes);
        prop_assert_eq!(&trial_read, &trial);
        prop_assert_eq!(&frames_read, &frames);
    }

    #[test]
    fn what_we_write_contradicts_itself_nowhere((trial, frames) in arbitrary::recording()) {
        let bytes = write(&trial, &frames).unwrap();
        let reader = Reader::from_bytes(&bytes).unwrap();
        let about_layout = |w: &&tousle_c3d::Warning| {
            use tousle_c3d::Warning::{
                BadOffset, BrokenParameters, Contradiction, CutShort, Fitted, NoScale, TrailingBytes,
            };
            matches!(
                w,
                BadOffset { .. } | BrokenParameters { .. } | Contradiction { .. } | CutShort { .. } | Fitted { .. }
                    | NoScale { .. } | TrailingBytes { .. }
            )
        };
        prop_assert_eq!(reader.warnings().iter().find(about_layout), None);
    }
}

#[test]
fn all_encodings_say_the_same() {
    let labels: Vec<String> = (0..7).map(|i| format!("M{i}")).collect();
    let step = |k: usize| (k as f32 - 20.0) * 0.25;
    let point = |f: usize, p: usize| (f * p % 5 != 4).then(|| Point::at([step(f), step(p), step(f + p)]));
    let frames: Frames = (0..60).map(|f| (0..7).map(|p| point(f, p)).collect()).collect();
    for processor in [Processor::Intel, Processor::Dec, Processor::Mips] {
        for storage in [Storage::Float32, Storage::Int16] {
            let labels = labels.clone();
            let trial = Trial {
                processor,
                storage,
                scale: 0.25,
                rate_hz: 120.0,
                n_frames: 60,
                labels,
                ..Trial::default()
            };
            assert_eq!(read(&write(&trial, &frames).unwrap()), (trial, frames.clone()));
        }
    }
}

/// The writer beside a reader that is not ours.
#[test]
fn c3dio_reads_what_we_write() {
    let labels = ["Wig:LFHD", "Wig:S01_1", "*1"].map(str::to_owned).to_vec();
    for processor in [Processor::Intel, Processor::Dec, Processor::Mips] {
        for storage in [Storage::Float32, Storage::Int16] {
            let labels = labels.clone();
            let (unit, n_frames) = (Some("mm".into()), 300);
            let trial = Trial {
                processor,
                storage,
                scale: 0.25,
                rate_hz: 120.0,
                unit,
                n_frames,
                labels,
                ..Trial::default()
            };
            let point = |f: usize, p: usize| Some(Point::at([f as f32 * 0.25, p as f32, -7.5]));
            let frames: Frames = (0..n_frames).map(|f| (0..3).map(|p| point(f, p)).collect()).collect();
            let theirs = c3dio::C3d::from_bytes(&write(&trial, &frames).unwrap()).unwrap();
            assert_eq!((theirs.points.labels, theirs.points.frame_rate), (trial.labels, 120.0));
            assert_eq!((theirs.points.points.rows(), theirs.points.points.cols()), (300, 3));
            for (frame, points) in frames.iter().enumerate() {
                for (idx, point) in points.iter().enumerate() {
                    assert_eq!(theirs.points.points[(frame, idx)].point, point.unwrap().position);
                }
            }
        }
    }
}

#[test]
fn more_points_than_an_array_of_labels_holds() {
    let labels: Vec<String> = (0..1021).map(|i| format!("Wig:S{i}")).collect();
    let frames = vec![vec![Some(Point::at([1.0, 2.0, 3.0])); 1021]];
    let trial = Trial { n_frames: 1, labels, ..Trial::default() };
    let bytes = write(&trial, &frames).unwrap();
    let reader = Reader::from_bytes(&bytes).unwrap();
    assert!(reader.parameters().get("POINT", "LABELS5").is_some());
    assert_eq!(read(&bytes), (trial, frames));
}

#[test]
fn more_frames_than_the_header_counts() {
    for (first_frame, n_frames) in
        [(1, 65_534), (1, 65_535), (1, 65_536), (0, 70_001), (66_000, 3), (60_000, 6_000)]
    {
        let frames: Frames = (0..n_frames).map(|f| vec![Some(Point::at([f as f32, 0.0, 0.0]))]).collect();
        let labels = vec!["A".to_owned()];
        let trial = Trial {
            first_frame,
            n_frames,
            rate_hz: 240.0,
            unit: Some("mm".into()),
            labels,
            ..Trial::default()
        };
        let bytes = write(&trial, &frames).unwrap();
        assert_eq!(Reader::from_bytes(&bytes).unwrap().warnings(), []);
        assert_eq!(read(&bytes), (trial, frames), "{n_frames} frames from {first_frame}");
    }
}

#[test]
fn integers_are_rounded_to_the_nearest_step() {
    let labels = vec!["A".to_owned()];
    let trial = Trial { storage: Storage::Int16, scale: 0.1, n_frames: 1, labels, ..Trial::default() };
    let bytes = write(&trial, &vec![vec![Some(Point::at([1.04, -1.06, 3276.7]))]]).unwrap();
    let (_, frames) = read(&bytes);
    assert_eq!(frames[0][0].unwrap().position, [10.0_f32 * 0.1, -11.0 * 0.1, 32767.0 * 0.1]);
}

mod refused {
    use super::*;

    fn trial() -> Trial {
        Trial { n_frames: 1, labels: vec!["A".into()], ..Trial::default() }
    }

    fn error(trial: &Trial, point: Point) -> String {
        write(trial, &vec![vec![Some(point)]]).unwrap_err().to_string()
    }

    #[test]
    fn points_that_cannot_be_stored() {
        let nan = error(&trial(), Point::at([f32::NAN, 0.0, 0.0]));
        assert_eq!(nan, "point 0 of frame 0 cannot be stored: a coordinate is not finite");
        let ints = Trial { storage: Storage::Int16, scale: 0.01, ..trial() };
        assert!(error(&ints, Point::at([327.68, 0.0, 0.0])).ends_with("more than 32767 steps of the scale"));
        let vax = Trial { processor: Processor::Dec, ..trial() };
        assert!(error(&vax, Point::at([2e38, 0.0, 0.0])).ends_with("too large for a VAX float"));
        let eight = Point { cameras: 0x80, ..Point::default() };
        assert!(error(&trial(), eight).ends_with("more than seven bits"));
    }

    #[test]
    fn another_number_of_frames_or_points() {
        let none: Frames = vec![];
        assert!(matches!(write(&trial(), &none), Err(WriteError::FrameCount { found: 0, expected: 1 })));
        let two = vec![vec![None]; 2];
        assert!(matches!(write(&trial(), &two), Err(WriteError::FrameCount { found: 2, expected: 1 })));
        let wide = vec![vec![None; 2]];
        assert!(matches!(write(&trial(), &wide), Err(WriteError::PointCount { found: 2, expected: 1, .. })));
        assert!(matches!(
            Writer::new(Vec::new(), &Trial { n_frames: 65_536, labels: vec![], ..trial() }),
            Err(WriteError::TooLarge { found: 65_536, .. })
        ));
        let empty = Trial { n_frames: 0, ..trial() };
        assert!(matches!(write(&empty, &none), Err(WriteError::NoFrames)));
    }

    fn refusal(change: impl FnOnce(&mut Trial)) -> WriteError {
        let mut trial = trial();
        change(&mut trial);
        Writer::new(Vec::new(), &trial).unwrap_err()
    }

    #[test]
    fn what_the_header_cannot_say() {
        assert!(matches!(refusal(|t| t.scale = 0.0), WriteError::Number { .. }));
        assert!(matches!(refusal(|t| t.scale = f32::NAN), WriteError::Number { .. }));
        assert!(matches!(refusal(|t| t.rate_hz = f32::INFINITY), WriteError::Number { .. }));
        assert!(matches!(refusal(|t| t.labels = vec![String::new(); 65_536]), WriteError::TooLarge { .. }));
        assert!(matches!(refusal(|t| t.n_frames = 1 << 32), WriteError::TooLarge { .. }));
    }

    #[test]
    fn what_texts_cannot_say() {
        assert!(matches!(refusal(|t| t.labels[0] = "髪".into()), WriteError::Text { .. }));
        assert!(matches!(refusal(|t| t.labels[0] = "x".repeat(256)), WriteError::TooLarge { .. }));
        assert!(matches!(refusal(|t| t.unit = Some("…".into())), WriteError::Text { .. }));
    }

    fn with(group: &str, name: &str, dimensions: &[u8], value: Value) -> WriteError {
        let dimensions = dimensions.to_vec();
        let parameter =
            Parameter { name: name.into(), description: String::new(), locked: false, dimensions, value };
        let group = Group { name: group.into(), parameters: vec![parameter], ..Group::default() };
        refusal(|t| t.parameters = Parameters { groups: vec![group] })
    }

    #[test]
    fn parameters() {
        let one = || Value::Integers(vec![1]);
        for (group, name) in
            [("POINT", "USED"), ("point", "labels2"), ("ANALOG", "RATE"), ("TRIAL", "ACTUAL_END_FIELD")]
        {
            assert!(matches!(with(group, name, &[], one()), WriteError::Reserved { .. }), "{group}:{name}");
        }
        assert!(matches!(with("A", "B", &[2], one()), WriteError::Shape { found: 1, expected: 2, .. }));
        assert!(matches!(with("A", "", &[], one()), WriteError::Text { .. }));
        let nameless = Group { description: "of nothing".into(), ..Group::default() };
        let parameters = Parameters { groups: vec![nameless] };
        assert!(matches!(refusal(|t| t.parameters = parameters), WriteError::Text { .. }));
        assert!(matches!(with("A", "B\n", &[], one()), WriteError::Text { .. }));
        let large = Value::Floats(vec![0.0; 255 * 255]);
        assert!(matches!(with("A", "B", &[255, 255], large), WriteError::TooLarge { .. }));
        assert!(matches!(with("A", "B", &[], Value::Floats(vec![f32::INFINITY])), WriteError::Number { .. }));
    }
}
