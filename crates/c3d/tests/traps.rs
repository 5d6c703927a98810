//! Each mistake and custom of real files, made by hand: what is read, and what is said about it.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod support;

use support::{File, are_frames, float, frames, group, int, ints, points, read, repointed, text};
use tousle_c3d::{Point, PointKind, Quantity, ReadError, Reader, Storage, Warning};

#[test]
fn a_careful_file_gives_no_warning() {
    let read = File::default().read();
    assert_eq!(read.warnings, []);
    assert_eq!(read.points, [[Some(Point::at([1.0, 2.0, 3.0]))]]);
    assert_eq!((read.info.unit.as_deref(), read.info.rate_hz), (Some("mm"), Some(100.0)));
}

mod missing {
    use super::*;

    #[test]
    fn by_the_fourth_word() {
        let words = [-1.0, 65535.0, 32768.0, 0.0, 684.0, 1.708e38, f32::NAN];
        let data: Vec<_> = words.iter().flat_map(|&word| points(&[[1.0, 2.0, 3.0, word]])).collect();
        let read = File { last_frame: 7, data, ..File::default() }.read();
        let seen: Vec<_> = read.points[0].iter().map(Option::is_some).collect();
        assert_eq!(seen, [false, false, false, true, true, true, true]);
        assert_eq!(read.points[0][4].unwrap().residual, 0xac, "a residual above 127 is no sign");
        assert_eq!(read.points[0][4].unwrap().cameras, 2);
    }

    #[test]
    fn by_a_nan_whatever_the_word_says() {
        let data = points(&[[f32::NAN, 2.0, 3.0, 0.0]]);
        assert_eq!(File { data, ..File::default() }.read().points, [[None]]);
    }

    #[test]
    fn by_the_sign_of_an_integer_word() {
        let words: [i16; 8] = [10, -20, 30, 0x0205, 1, 1, 1, -32768];
        let data = words.iter().flat_map(|w| w.to_le_bytes()).collect();
        let read = File { scale: 0.5, last_frame: 2, data, ..File::default() }.read();
        assert_eq!(read.info.storage, Storage::Int16);
        let seen = Point { position: [5.0, -10.0, 15.0], residual: 5, cameras: 2 };
        assert_eq!(read.points, [[Some(seen), None]]);
    }
}

/// The length of a frame, where header and parameters disagree on what is in it.
mod stride {
    use super::*;

    fn contradiction(
        quantity: Quantity,
        header: f64,
        parameter: &'static str,
        stated: f64,
        used: f64,
    ) -> Warning {
        Warning::Contradiction { quantity, header, parameter, stated, used }
    }

    #[test]
    fn the_header_counts_channels_and_not_samples() {
        let file = File {
            n_points: 2,
            analog_words: 16,
            analog_samples: 7,
            last_frame: 40,
            data: frames(40, 2, 112),
            ..File::default()
        };
        let read = file.with(&[group(2, "ANALOG"), int(2, "USED", 16)]).read();
        assert!(are_frames(&read.points));
        assert_eq!((read.info.analog.n_channels, read.info.analog.n_samples_per_frame), (16, 7));
        let expected = contradiction(Quantity::AnalogWords, 16.0, "ANALOG:USED", 112.0, 112.0);
        assert!(read.warnings.contains(&expected), "{:?}", read.warnings);
    }

    #[test]
    fn only_the_rates_tell_how_many_samples() {
        let analog = [group(2, "ANALOG"), int(2, "USED", 3), float(2, "RATE", 1000.0)];
        let file = File {
            analog_words: 3,
            analog_samples: 1,
            last_frame: 40,
            data: frames(40, 1, 30),
            ..File::default()
        };
        let read = file.with(&analog).with(&[float(1, "RATE", 100.0)]).read();
        assert!(are_frames(&read.points));
        assert_eq!((read.info.analog.n_channels, read.info.analog.n_samples_per_frame), (3, 10));
    }

    #[test]
    fn the_header_is_right_where_its_claim_fits() {
        let analog = [group(2, "ANALOG"), int(2, "USED", 8), float(2, "RATE", 1000.0)];
        let file = File {
            analog_words: 6,
            analog_samples: 1,
            last_frame: 40,
            data: frames(40, 1, 6),
            ..File::default()
        };
        let read = file.with(&analog).read();
        assert!(are_frames(&read.points));
        let expected = contradiction(Quantity::AnalogWords, 6.0, "ANALOG:USED", 8.0, 6.0);
        assert!(read.warnings.contains(&expected), "{:?}", read.warnings);
    }

    #[test]
    fn points_by_what_fits() {
        for (header, used) in [(11, 12), (12, 11)] {
            let file = File { n_points: header, last_frame: 50, data: frames(50, 11, 0), ..File::default() };
            let read = file.with(&[int(1, "USED", used)]).read();
            assert_eq!(read.info.n_points, 11);
            assert!(are_frames(&read.points));
            let expected =
                contradiction(Quantity::Points, f64::from(header), "POINT:USED", f64::from(used), 11.0);
            assert!(read.warnings.contains(&expected), "{:?}", read.warnings);
        }
    }

    #[test]
    fn data_start_by_what_fits() {
        let data = frames(200, 1, 0);
        for stated in [0, 9] {
            let file = File { last_frame: 200, data: data.clone(), ..File::default() };
            assert!(are_frames(&file.with(&[int(1, "DATA_START", stated)]).read().points));
        }
        // The header's is nowhere, or behind half of the data.
        for header in [0, 1, 6, 60000] {
            let file =
                File { last_frame: 200, data: data.clone(), data_block: Some(header), ..File::default() };
            let read = file.with(&[int(1, "DATA_START", 3)]).read();
            assert_eq!(read.points[0].len(), 200);
            assert!(are_frames(&read.points), "header says {header}");
            assert!(!read.warnings.is_empty());
        }
    }

    #[test]
    fn data_start_follows_the_parameters_if_nothing_says_it() {
        let file = File { last_frame: 200, data: frames(200, 1, 0), data_block: Some(0), ..File::default() };
        let read = file.read();
        assert!(are_frames(&read.points));
        let expected = Warning::Fitted { quantity: Quantity::DataStart, header: 0.0, used: 3.0 };
        assert!(read.warnings.contains(&expected), "{:?}", read.warnings);
    }
}

mod scale {
    use super::*;

    #[test]
    fn its_sign_by_what_fits() {
        let file = File { scale: 0.1, last_frame: 100, data: frames(100, 1, 0), ..File::default() };
        let read = file.with(&[float(1, "SCALE", -0.1)]).read();
        assert_eq!(read.info.storage, Storage::Float32);
        assert!(are_frames(&read.points));
    }

    #[test]
    fn its_size_by_the_header() {
        let data = [10_i16, 20, 30, 0].iter().flat_map(|w| w.to_le_bytes()).collect();
        let read = File { scale: 0.5, data, ..File::default() }.with(&[float(1, "SCALE", 0.25)]).read();
        assert_eq!(read.points, [[Some(Point::at([5.0, 10.0, 15.0]))]]);
        assert!(matches!(read.warnings[..], [Warning::Contradiction { quantity: Quantity::Scale, .. }]));
    }

    #[test]
    fn the_parameter_if_the_header_has_none() {
        let data = [10_i16, 20, 30, 0].iter().flat_map(|w| w.to_le_bytes()).collect();
        let read = File { scale: 0.0, data, ..File::default() }.with(&[float(1, "SCALE", 0.25)]).read();
        assert_eq!(read.points, [[Some(Point::at([2.5, 5.0, 7.5]))]]);
    }

    #[test]
    fn assumed_aloud_if_there_is_none() {
        let file = File { scale: 0.0, last_frame: 100, data: frames(100, 1, 0), ..File::default() };
        let read = file.read();
        assert!(are_frames(&read.points));
        assert_eq!(read.warnings, [Warning::NoScale { assumed: -1.0 }]);
    }
}

mod frame_count {
    use super::*;

    const LONG: usize = 70_001;

    /// 70,001 frames, which the header's words cannot count.
    fn long(first_frame: u16) -> File {
        File { first_frame, last_frame: 65535, data: frames(LONG, 1, 0), ..File::default() }
    }

    fn trial(first: u32, last: u32) -> [Vec<u8>; 3] {
        let words = |n: u32| [n as u16, (n >> 16) as u16];
        let [start, end] = ["ACTUAL_START_FIELD", "ACTUAL_END_FIELD"];
        [group(5, "TRIAL"), ints(5, start, &[2], &words(first)), ints(5, end, &[2], &words(last))]
    }

    #[test]
    fn of_the_trial() {
        let read = long(1).with(&trial(1, 70_001)).with(&[int(1, "FRAMES", 65535)]).read();
        assert_eq!(read.info.n_frames, LONG);
        assert!(are_frames(&read.points));
        assert_eq!(read.warnings, [], "no contradiction: the header has no room for more");
    }

    #[test]
    fn of_long_frames_or_float_frames() {
        for name in ["LONG_FRAMES", "FRAMES"] {
            let read = long(0).with(&[float(1, name, 70_001.0)]).read();
            assert_eq!((read.info.n_frames, read.info.first_frame), (LONG, 0));
            assert_eq!(read.warnings, []);
        }
    }

    #[test]
    fn of_the_file_if_nothing_says_it() {
        let read = long(1).read();
        assert_eq!(read.info.n_frames, 70_016, "the padding cannot be told from frames");
        let expected = Warning::Fitted { quantity: Quantity::Frames, header: 65535.0, used: 70_016.0 };
        assert_eq!(read.warnings, [expected]);
    }

    #[test]
    fn capped_by_the_file() {
        let read = long(1).with(&trial(1, 80_000)).read();
        assert_eq!(read.info.n_frames, 70_016);
        assert_eq!(read.warnings, [Warning::CutShort { claimed: 80_000, found: 70_016 }]);
    }

    #[test]
    fn of_a_header_that_wrapped() {
        let file = File { last_frame: (LONG - 65536) as u16, ..long(1) };
        assert_eq!(file.clone().with(&trial(1, 70_001)).read().info.n_frames, LONG);
        let untold = file.with(&[int(1, "FRAMES", 65535)]).read();
        assert_eq!(untold.info.n_frames, LONG, "as what fits says");
        assert!(are_frames(&untold.points));
        let fitted = Warning::Fitted { quantity: Quantity::Frames, header: 4465.0, used: 70_001.0 };
        assert_eq!(untold.warnings[0], fitted);
        let longer = File { last_frame: 7, data: frames(131_079, 1, 0), ..File::default() };
        assert_eq!(longer.read().info.n_frames, 131_079);
        let late =
            File { first_frame: 60_000, last_frame: 500, data: frames(6_037, 1, 0), ..File::default() };
        assert_eq!(late.read().info.n_frames, 6_037);
    }

    #[test]
    fn up_to_the_rotations() {
        let rotations = |block| [group(6, "ROTATION"), int(6, "USED", 1), int(6, "DATA_START", block)];
        let mut file = long(1).with(&rotations(3 + 2188)).with(&trial(1, 70_001));
        file.data.resize(2188 * 512, 0);
        file.data.extend(vec![0x3f; 70_001 * 17 * 4]);
        let read = file.read();
        assert_eq!((read.info.n_frames, read.info.rotations.n_rotations), (LONG, 1));
        assert!(are_frames(&read.points));
        assert_eq!(read.warnings, []);
    }

    #[test]
    fn the_header_against_the_parameter() {
        // 33 frames of 2 points are 1056 bytes: one more would not fit, one less would leave a block.
        for (last, stated) in [(33, 34), (34, 33)] {
            let file = File { n_points: 2, last_frame: last, data: frames(64, 2, 0), ..File::default() };
            let mut bytes = file.with(&[int(1, "FRAMES", stated)]).bytes();
            bytes.truncate(1024 + 33 * 32);
            let read = read(&bytes);
            assert_eq!(read.info.n_frames, 33);
            assert!(matches!(read.warnings[0], Warning::Contradiction { quantity: Quantity::Frames, .. }));
        }
    }

    #[test]
    fn of_a_cut_file() {
        let mut bytes = File { last_frame: 1149, data: frames(1149, 1, 0), ..File::default() }.bytes();
        bytes.truncate(1024 + 29 * 16 + 7);
        let read = read(&bytes);
        assert_eq!(read.info.n_frames, 29);
        assert_eq!(read.warnings, [Warning::CutShort { claimed: 1149, found: 29 }]);
    }

    #[test]
    fn with_more_behind_the_last() {
        let read = File { data: frames(100, 1, 0), ..File::default() }.read();
        assert_eq!(read.info.n_frames, 1);
        assert_eq!(read.warnings, [Warning::TrailingBytes { n_bytes: 2048 - 16 }]);
    }

    #[test]
    fn the_first_is_what_the_header_says() {
        assert_eq!(File { first_frame: 0, last_frame: 0, ..File::default() }.read().info.first_frame, 0);
        let cut_out = File { first_frame: 695, last_frame: 695, ..File::default() };
        let read = cut_out.clone().with(&trial(695, 695)).read();
        assert_eq!((read.info.first_frame, read.warnings.len()), (695, 0));
        let read = cut_out.with(&trial(1, 1)).read();
        assert_eq!((read.info.first_frame, read.warnings.len()), (695, 1));
        let late = File { first_frame: 65535, last_frame: 65535, ..File::default() };
        assert_eq!(late.with(&trial(100_000, 100_000)).read().info.first_frame, 100_000);
    }

    #[test]
    fn without_a_frame_there_is_no_trial() {
        let mut bytes = File::default().bytes();
        bytes.truncate(1024);
        assert!(matches!(
            Reader::from_bytes(&bytes),
            Err(ReadError::NoData { n_points: 1, n_frames: 1, .. })
        ));
    }
}

mod labels {
    use super::*;

    #[test]
    fn more_than_an_array_holds() {
        let names = |range: std::ops::Range<usize>| -> String { range.map(|i| format!("{i:<4}")).collect() };
        let records = [
            group(1, "POINT"),
            text(1, "LABELS", &[4, 255], &names(0..255)),
            text(1, "UNITS", &[1], "m"),
            text(1, "LABELS2", &[4, 255], &names(255..510)),
            text(1, "LABELS3", &[4, 9], &names(510..519)),
        ];
        let file =
            File { n_points: 519, records: records.concat(), data: frames(1, 519, 0), ..File::default() };
        let read = file.read();
        assert_eq!(read.info.labels, (0..519).map(|i| i.to_string()).collect::<Vec<_>>());
        assert_eq!(read.warnings, []);
    }

    fn labeled(n_points: u16, dimensions: &[u8], letters: &str) -> support::Read {
        let records =
            [group(1, "POINT"), text(1, "UNITS", &[2], "mm"), text(1, "LABELS", dimensions, letters)];
        let data = frames(1, usize::from(n_points), 0);
        File { n_points, records: records.concat(), data, ..File::default() }.read()
    }

    #[test]
    fn blanks_and_nuls_around_them_are_no_part() {
        assert_eq!(labeled(3, &[4, 3], " A  B\0\0\0\0C D").info.labels, ["A", "B", "C D"]);
    }

    #[test]
    fn more_slots_than_points() {
        let read = labeled(2, &[1, 4], "AB  ");
        assert_eq!(read.info.labels, ["A", "B"]);
        assert_eq!(read.warnings, []);
    }

    #[test]
    fn fewer_than_points() {
        let read = labeled(3, &[1, 2], "AB");
        assert_eq!(read.info.labels, ["A", "B"]);
        assert_eq!((read.info.label(1), read.info.label(2)), (Some("B"), None));
        assert_eq!(read.warnings, [Warning::MissingLabels { n_labels: 2, n_points: 3 }]);
    }

    #[test]
    fn one_label_without_a_second_dimension() {
        assert_eq!(labeled(1, &[4], "LFHD").info.labels, ["LFHD"]);
    }

    #[test]
    fn the_same_twice_and_none() {
        let read = labeled(4, &[2, 4], "T8*1T8  ");
        assert_eq!(read.info.labels, ["T8", "*1", "T8", ""]);
        assert_eq!(read.warnings, [Warning::DuplicateLabel { label: "T8".into(), n_points: 2 }]);
    }

    #[test]
    fn some_are_no_markers() {
        let file = File { n_points: 4, data: frames(1, 4, 0), ..File::default() };
        let records = [
            group(1, "POINT"),
            text(1, "LABELS", &[6, 4], "W:LFHDW:LHipW:CoM W:GRF "),
            text(1, "ANGLES", &[6, 1], "W:LHip"),
            text(1, "TYPE_GROUPS", &[6, 2, 2], "ANGLESAnglesGROUNDGround"),
            text(1, "GROUND", &[5, 1], "W:GRF"),
            text(1, "MODELED_MARKERS", &[5, 1], "W:CoM"),
        ];
        let info = File { records: records.concat(), ..file }.read().info;
        let expected = [PointKind::Marker, PointKind::Angle, PointKind::ModeledMarker, PointKind::Other];
        assert_eq!(info.kinds, expected);
        assert_eq!(expected.map(PointKind::is_marker), [true, false, true, false]);
    }

    #[test]
    fn subjects_and_screen() {
        let records = [
            group(3, "SUBJECTS"),
            int(3, "USED", 2),
            text(3, "NAMES", &[3, 3], "WigBob   "),
            text(3, "LABEL_PREFIXES", &[4, 2], "Wig:Bob:"),
            text(1, "X_SCREEN", &[2], "+X"),
            text(1, "Y_SCREEN", &[2], "+Z"),
        ];
        let info = File::default().with(&records).read().info;
        let subjects: Vec<_> =
            info.subjects.iter().map(|s| (s.name.as_str(), s.label_prefix.as_str())).collect();
        assert_eq!(subjects, [("Wig", "Wig:"), ("Bob", "Bob:")]);
        assert_eq!((info.x_screen.as_deref(), info.y_screen.as_deref()), (Some("+X"), Some("+Z")));
    }
}

mod unit {
    use super::*;

    fn unit(dimensions: &[u8], letters: &str) -> Option<String> {
        let records =
            [group(1, "POINT"), text(1, "LABELS", &[1, 1], "A"), text(1, "UNITS", dimensions, letters)];
        let read = File { records: records.concat(), ..File::default() }.read();
        assert_eq!(read.warnings.contains(&Warning::NoUnit), read.info.unit.is_none());
        read.info.unit
    }

    #[test]
    fn as_the_file_spells_it() {
        assert_eq!(unit(&[2], "mm").as_deref(), Some("mm"));
        assert_eq!(unit(&[4], "m   ").as_deref(), Some("m"));
        assert_eq!(unit(&[4, 1], "mete").as_deref(), Some("mete"));
        assert_eq!(unit(&[2, 3], "mmmmmm").as_deref(), Some("mm"));
        assert_eq!(unit(&[4], "    "), None);
        assert_eq!(unit(&[2], "\0\0"), None);
        assert_eq!(unit(&[0], ""), None);
    }

    #[test]
    fn absent() {
        let records = [group(1, "POINT"), text(1, "LABELS", &[1, 1], "A")];
        let read = File { records: records.concat(), ..File::default() }.read();
        assert_eq!((read.info.unit, read.warnings), (None, vec![Warning::NoUnit]));
    }
}

mod parameters {
    use super::*;

    /// The default file with its records replaced.
    fn with(records: &[Vec<u8>]) -> support::Read {
        File { records: records.concat(), ..File::default() }.read()
    }

    fn labels_and_unit(read: &support::Read) -> (Vec<&str>, Option<&str>) {
        (read.info.labels.iter().map(String::as_str).collect(), read.info.unit.as_deref())
    }

    const RIGHT: (&[&str], Option<&str>) = (&["A"], Some("mm"));

    fn assert_right(read: &support::Read) {
        let (labels, unit) = labels_and_unit(read);
        assert_eq!((labels.as_slice(), unit), RIGHT, "{:?}", read.warnings);
    }

    #[test]
    fn a_pointer_into_nowhere() {
        for pointer in [4, 6, 400, 40_000] {
            let unit = repointed(text(1, "UNITS", &[2], "mm"), pointer);
            let read = with(&[group(1, "POINT"), unit, text(1, "LABELS", &[1, 1], "A")]);
            assert_right(&read);
            assert!(matches!(read.warnings[..], [Warning::BadOffset { .. }]), "{:?}", read.warnings);
        }
    }

    #[test]
    fn a_pointer_of_the_other_byte_order() {
        let unit = repointed(text(1, "UNITS", &[2], "mm"), 8_u16.swap_bytes());
        assert_right(&with(&[group(1, "POINT"), unit, text(1, "LABELS", &[1, 1], "A")]));
    }

    #[test]
    fn a_record_without_length_of_description() {
        let mut unit = text(1, "UNITS", &[2], "mm");
        unit.pop();
        let length = unit.len() - 7;
        let read =
            with(&[group(1, "POINT"), repointed(unit, length as u16), text(1, "LABELS", &[1, 1], "A")]);
        assert_right(&read);
        assert_eq!(read.warnings, []);
    }

    #[test]
    fn a_pointer_that_skips_something() {
        let mut unit = text(1, "UNITS", &[2], "mm");
        unit.extend([0xff; 5]);
        let length = unit.len() - 7;
        let read =
            with(&[group(1, "POINT"), repointed(unit, length as u16), text(1, "LABELS", &[1, 1], "A")]);
        assert_right(&read);
        assert_eq!(read.warnings, []);
    }

    #[test]
    fn the_last_pointer_is_zero() {
        let labels = repointed(text(1, "LABELS", &[1, 1], "A"), 0);
        let read = with(&[group(1, "POINT"), text(1, "UNITS", &[2], "mm"), labels, vec![7, 7, 7]]);
        assert_right(&read);
        assert_eq!(read.warnings, []);
    }

    #[test]
    fn a_pointer_that_looks_negative() {
        // 200 labels of 200 letters: 40,000 bytes, more than a signed pointer can skip.
        let long = text(1, "DESCRIPTIONS", &[200, 200], &"x".repeat(40_000));
        let read =
            with(&[group(1, "POINT"), text(1, "UNITS", &[2], "mm"), long, text(1, "LABELS", &[1, 1], "A")]);
        assert_right(&read);
        assert_eq!(read.warnings, []);
    }

    #[test]
    fn no_end_mark() {
        // Records that fill the section's block to the last byte.
        let fixed =
            [group(1, "POINT"), text(1, "UNITS", &[2], "mm"), text(1, "LABELS", &[1, 1], "A")].concat();
        let n_left = 508 - fixed.len() - text(1, "X", &[0], "").len();
        let filling = text(1, "X", &[n_left as u8, 1], &" ".repeat(n_left - 1))[..].to_vec();
        let mut bytes = File { records: [fixed, filling].concat(), ..File::default() }.bytes();
        // The end mark went into a block of its own: take that out.
        bytes.drain(1024..1536);
        bytes[16] = 3;
        let read = read(&bytes);
        assert_eq!(read.points.len(), 1);
        assert_right(&read);
    }

    #[test]
    fn more_blocks_than_counted() {
        let long = text(1, "DESCRIPTIONS", &[200, 20], &"x".repeat(4000));
        let records =
            [group(1, "POINT"), text(1, "UNITS", &[2], "mm"), long, text(1, "LABELS", &[1, 1], "A")];
        for counted in [0, 1, 255] {
            let file = File { records: records.concat(), section_blocks: Some(counted), ..File::default() };
            assert_right(&file.read());
        }
    }

    #[test]
    fn garbage_in_the_middle() {
        let read = with(&[group(1, "POINT"), text(1, "UNITS", &[2], "mm"), vec![9; 200]]);
        assert_eq!(labels_and_unit(&read), (vec![], Some("mm")));
        assert!(read.warnings.iter().any(|w| matches!(w, Warning::BrokenParameters { .. })));
        assert_eq!(read.points, [[Some(Point::at([1.0, 2.0, 3.0]))]], "points need the header only");
    }

    #[test]
    fn none_at_all() {
        let read = with(&[]);
        assert_eq!(read.points, [[Some(Point::at([1.0, 2.0, 3.0]))]]);
        assert_eq!(read.warnings[0], Warning::NoParameters);
    }

    #[test]
    fn before_their_group_and_in_none() {
        let read = with(&[text(1, "UNITS", &[2], "mm"), text(1, "LABELS", &[1, 1], "A"), group(1, "POINT")]);
        assert_right(&read);
        assert_eq!(read.warnings, []);
        let read = with(&[group(1, "POINT"), text(1, "LABELS", &[1, 1], "A"), text(7, "USED", &[1], "x")]);
        assert!(read.warnings.contains(&Warning::UnnamedGroup { group_id: 7, n_parameters: 1 }));
    }

    #[test]
    fn the_first_of_a_name_counts() {
        let units = ["mm", "cm"].map(|u| text(1, "UNITS", &[2], u));
        let read = with(&[group(1, "POINT"), units.concat(), text(1, "LABELS", &[1, 1], "A")]);
        assert_right(&read);
        assert_eq!(read.warnings, [Warning::DuplicateParameters { group: "POINT".into(), n_parameters: 1 }]);
    }

    #[test]
    fn names_in_lower_case_and_locked() {
        let mut unit = text(1, "units", &[2], "mm");
        unit[0] = 5_i8.wrapping_neg().cast_unsigned();
        assert_right(&with(&[group(1, "Point"), unit, text(1, "Labels", &[1, 1], "A")]));
    }
}

/// Where the file is not even what its first bytes say.
mod start {
    use super::*;

    #[test]
    fn zeros_before_the_header() {
        let bytes = [vec![0; 37], File::default().bytes()].concat();
        let read = read(&bytes);
        assert_eq!(read.points, [[Some(Point::at([1.0, 2.0, 3.0]))]]);
        assert_eq!(read.warnings, [Warning::LeadingZeros { n_bytes: 37 }]);
    }

    #[test]
    fn a_wrong_block_of_parameters() {
        let mut bytes = File::default().bytes();
        for block in [0, 1, 3, 200] {
            bytes[0] = block;
            if block == 0 {
                // A zero here would be taken for one before the header; the next byte is no parameter block.
                assert!(Reader::from_bytes(&bytes).is_err());
                continue;
            }
            assert_eq!(read(&bytes).warnings, [Warning::ParameterBlock { found: block, used: 2 }]);
        }
    }

    #[test]
    fn an_unknown_processor() {
        let read = File { processor: 1, ..File::default() }.read();
        assert_eq!(read.warnings, [Warning::ProcessorAssumed { offset: 515, found: 1, assumed: 84 }]);
        let senseless = File { processor: 1, rate_hz: 0.0, ..File::default() }.bytes();
        assert!(matches!(Reader::from_bytes(&senseless), Err(ReadError::Processor { found: 1, .. })));
    }

    #[test]
    fn something_else() {
        assert!(matches!(Reader::from_bytes(&[]), Err(ReadError::TooShort { found: 0, .. })));
        assert!(matches!(Reader::from_bytes(&[0; 4000]), Err(ReadError::NotC3d { .. })));
        assert!(matches!(Reader::from_bytes(&[b'x'; 4000]), Err(ReadError::NotC3d { found: b'x', .. })));
    }

    #[test]
    fn no_rate() {
        let read = File { rate_hz: 0.0, ..File::default() }.read();
        assert_eq!((read.info.rate_hz, read.warnings), (None, vec![Warning::NoRate]));
        let read = File { rate_hz: 0.0, ..File::default() }.with(&[float(1, "RATE", 59.94)]).read();
        assert_eq!(read.info.rate_hz, Some(f64::from(59.94_f32)));
    }
}

/// Only what is asked for is decoded, and what is not there cannot be asked for.
mod asking {
    use super::*;

    #[test]
    fn some_points_of_some_frames() {
        let bytes = File { n_points: 5, last_frame: 50, data: frames(50, 5, 0), ..File::default() }.bytes();
        let mut reader = Reader::from_bytes(&bytes).unwrap();
        let mut seen = Vec::new();
        reader.read_frames(&[3, 1], 20..22, |frame, points| seen.push((frame, points.to_vec()))).unwrap();
        let at = |frame: f32, point: f32| Some(Point::at([frame, point, 0.0]));
        assert_eq!(
            seen,
            [(20, vec![at(20.0, 3.0), at(20.0, 1.0)]), (21, vec![at(21.0, 3.0), at(21.0, 1.0)])]
        );
        assert!(reader.read_trajectories(&[0], 7..7).unwrap()[0].is_empty());
    }

    #[test]
    fn what_is_not_there() {
        let bytes = File::default().bytes();
        let mut reader = Reader::from_bytes(&bytes).unwrap();
        let asked = reader.read_trajectories(&[1], 0..1);
        assert!(matches!(asked, Err(ReadError::NoSuchPoint { asked: 1, n_points: 1 })));
        #[allow(clippy::reversed_empty_ranges, reason = "that is the mistake")]
        for frames in [0..2, 2..2, 1..0] {
            assert!(matches!(reader.read_trajectories(&[0], frames), Err(ReadError::NoSuchFrames { .. })));
        }
    }
}
