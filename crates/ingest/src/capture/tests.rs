use super::*;

const CSV: &str = "Trajectories\n120\n,,Wig:LFHD,,,Wig:NOSE,,,Box:A,,,*1,,\n\
    Frame,Sub Frame,X,Y,Z,X,Y,Z,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm,mm,mm,mm,mm,mm,mm\n\
    695,0,165.5,331.8,1508.1,,,,1,2,3,0,0,0\n696,0,165.5,331.8,1508.1,0,0,0,1,2,3,4,5,6\n";

fn read(text: &str, options: &IngestOptions) -> Ingested {
    read_capture(text.as_bytes(), options).unwrap()
}

fn error(text: &str, options: &IngestOptions) -> String {
    read_capture(text.as_bytes(), options).unwrap_err().to_string()
}

fn names(capture: &Capture) -> Vec<&str> {
    capture.trajectories.iter().map(|t| t.label.as_str()).collect()
}

#[test]
fn positions_become_meters_and_zeros_are_missing() {
    let ingested = read(CSV, &IngestOptions::default());
    let capture = &ingested.capture;
    assert_eq!((capture.rate_hz, capture.first_frame, capture.n_frames), (120.0, 695, 2));
    assert_eq!(capture.file_unit, Some(LengthUnit::Millimeter));
    assert_eq!(names(capture), ["LFHD", "NOSE", "A", "*1"]);
    assert_eq!(capture.trajectories[0].subject.as_deref(), Some("Wig"));
    assert_eq!(capture.trajectories[3].subject, None);
    let seen = capture.trajectories[0].track.at(0).unwrap();
    assert!((seen - Vec3::new(0.1655, 0.3318, 1.5081)).norm() < 1e-15);
    assert_eq!(capture.trajectories[1].track.n_valid(), 0);
    assert_eq!(ingested.report.warnings, ["2 positions are exactly 0, 0, 0 and count as missing"]);
    let kept = read(CSV, &IngestOptions { keep_exact_zeros: true, ..IngestOptions::default() });
    assert_eq!(kept.capture.trajectories[1].track.at(1), Some(Vec3::zeros()));
}

#[test]
fn only_one_subject() {
    let of = |subject: &str| IngestOptions { subject: Some(subject.into()), ..IngestOptions::default() };
    let ingested = read(CSV, &of("Wig"));
    assert_eq!(names(&ingested.capture), ["LFHD", "NOSE", "*1"]);
    assert_eq!(ingested.report.warnings[0], "1 markers of other subjects are left out");
    assert_eq!(
        error(CSV, &of("wig")),
        "found no markers of subject \"wig\", expected some: the file has Box, Wig"
    );
    let of_no_one = CSV.replace("Box:A", "NOSE");
    assert_eq!(names(&read(&of_no_one, &of("Wig")).capture), ["LFHD", "NOSE", "*1"], "the subject's own");
    let half_bare = read(&CSV.replace("Wig:LFHD", "LFHD"), &of("Wig"));
    assert_eq!(names(&half_bare.capture), ["LFHD", "NOSE", "*1"]);
    assert_eq!(
        half_bare.report.warnings[..2],
        [
            "1 markers whose labels name no subject are taken to be those of \"Wig\"",
            "1 markers of other subjects are left out"
        ]
    );
    let bare = CSV.replace("Wig:", "").replace("Box:", "");
    assert_eq!(names(&read(&bare, &of("Wig")).capture).len(), 4);
}

/// A header and a parameter that disagree; whoever was there decides, if what he says is one of the two.
#[test]
fn a_rate_that_is_given_decides_between_two() {
    let labels = vec!["A".to_owned()];
    let (rate_hz, unit) = (100.0, Some("mm".to_owned()));
    let trial = tousle_c3d::Trial { rate_hz, unit, labels, n_frames: 1, ..tousle_c3d::Trial::default() };
    let mut writer = tousle_c3d::Writer::new(Vec::new(), &trial).unwrap();
    writer.write_frame(&[Some(tousle_c3d::Point::at([1.0, 2.0, 3.0]))]).unwrap();
    let mut bytes = writer.finish().unwrap();
    // The header's word 11.
    bytes[20..24].copy_from_slice(&120.0_f32.to_le_bytes());
    let read = |rate_hz| {
        let ingested = read_capture(&bytes, &IngestOptions { rate_hz, ..IngestOptions::default() }).unwrap();
        (ingested.capture.rate_hz, ingested.report.warnings.last().cloned().unwrap())
    };
    let contradiction = "rate: the header says 120, POINT:RATE says 100, 120 is used".to_owned();
    assert_eq!(read(None), (120.0, contradiction.clone()));
    assert_eq!(read(Some(120.0)), (120.0, contradiction));
    let (rate_hz, warning) = read(Some(100.0));
    assert_eq!(rate_hz, 100.0);
    assert_eq!(
        warning,
        "the file says 120 frames a second and 100, 100 was given; read as 100, which two say"
    );
    let (rate_hz, warning) = read(Some(50.0));
    assert_eq!(rate_hz, 120.0);
    assert_eq!(warning, "the file says 120 frames a second, 50 was given; read as the file says");
}

#[test]
fn a_unit_is_never_guessed() {
    let meters = Some(LengthUnit::Meter);
    let session = IngestOptions { unit: meters, ..IngestOptions::default() };
    let caller = IngestOptions { unit_override: meters, ..IngestOptions::default() };
    let nameless = CSV.replace(",,mm,mm,mm,mm,mm,mm,mm,mm,mm,mm,mm,mm\n", "");
    let strange = CSV.replace("mm", "ell");
    let height = |ingested: Ingested| ingested.capture.trajectories[0].track.at(0).unwrap().z;

    assert!((height(read(CSV, &session)) - 1.5081).abs() < 1e-12, "the file comes first");
    assert!((height(read(&nameless, &session)) - 1508.1).abs() < 1e-9);
    assert!((height(read(CSV, &caller)) - 1508.1).abs() < 1e-9);
    assert!((height(read(&strange, &caller)) - 1508.1).abs() < 1e-9);
    assert_eq!(
        error(&nameless, &IngestOptions::default()),
        "found no unit of length in the file, expected one: pass it (mm, cm, m or in)"
    );
    assert_eq!(
        error(&strange, &IngestOptions::default()),
        "found the unit \"ell\", expected one of length: pass it (mm, cm, m or in)"
    );
    assert_eq!(
        read(&strange, &session).report.warnings[0],
        "the file's unit \"ell\" is not one of length; read as m, as given"
    );
    assert_eq!(
        read(CSV, &session).report.warnings[0],
        "the file says mm, m was given; read as the file says"
    );
}

#[test]
fn a_rate_is_never_guessed() {
    let untitled = CSV.strip_prefix("Trajectories\n120\n").unwrap();
    assert_eq!(
        error(untitled, &IngestOptions::default()),
        "found no frame rate in the file, expected one: pass it"
    );
    let ingested = read(untitled, &IngestOptions { rate_hz: Some(100.0), ..IngestOptions::default() });
    assert_eq!(ingested.capture.rate_hz, 100.0);
    assert_eq!(ingested.report.warnings[0], "the file names no frame rate; 100 a second, as given");
}

#[test]
fn the_times_of_a_trc_tell_a_rate_that_its_header_does_not() {
    let trc = |rate: &str, n_rows: usize| {
        let row = |k: usize| format!("{k}\t{:.3}\t1.5\t2.5\t3.5\n", k as f64 / 120.0);
        let rows: String = (1..=n_rows).map(row).collect();
        format!("DataRate\tUnits\n{rate}\tmm\nFrame#\tTime\tA\n{rows}")
    };
    for rate in ["0", ""] {
        let ingested = read(&trc(rate, 241), &IngestOptions::default());
        assert_eq!(ingested.capture.rate_hz, 120.0, "{rate:?}");
        assert_eq!(
            ingested.report.warnings,
            ["the header names no frame rate; the times of the rows are 0.008333 s apart"]
        );
        let short = trc(rate, 3);
        assert_eq!(
            error(&short, &IngestOptions::default()),
            "found no frame rate in the file, expected one: pass it"
        );
        let given = IngestOptions { rate_hz: Some(120.0), ..IngestOptions::default() };
        assert_eq!(read(&short, &given).capture.rate_hz, 120.0, "and not 125");
    }
}

#[test]
fn motive_markers_count_once() {
    let take = "Format Version,1.23,Export Frame Rate,100,Length Units,Centimeters\n\
        ,Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body Marker,Rigid Body Marker,Rigid Body Marker,Marker,Marker,Marker\n\
        ,Name,Head,Head,Head,Head:A,Head:A,Head:A,Head:A,Head:A,Head:A\n\
        ,,Position,Position,Position,Position,Position,Position,Position,Position,Position\n\
        Frame,Time (Seconds),X,Y,Z,X,Y,Z,X,Y,Z\n\
        0,0.00,1,1,1,2,2,2,3,3,3\n\
        4,0.04,1,1,1,2,2,2,3,3,3\n";
    let ingested = read(take, &IngestOptions::default());
    assert_eq!(names(&ingested.capture), ["A"]);
    assert_eq!(ingested.capture.n_frames, 5);
    assert_eq!(ingested.capture.trajectories[0].track.at(4), Some(Vec3::repeat(0.03)));
    assert_eq!(ingested.capture.trajectories[0].track.at(3), None);
    assert_eq!(
        ingested.report.warnings,
        [
            "1 points are computed (angles, forces, poses), not seen, and are left out",
            "1 solved positions of markers are left out: the measured ones are there too",
            "the file skips 3 of the frames 0 to 4; they count as not seen",
        ]
    );
    let unlabeled = take.replace("Head:A,Head:A,Head:A\n", "Unlabeled 7,Unlabeled 7,Unlabeled 7\n");
    assert_eq!(names(&read(&unlabeled, &IngestOptions::default()).capture), ["A", "*7"]);
    let of_hair = take.replace("Head:A,Head:A,Head:A\n", "S01_1,S01_1,S01_1\n");
    let ingested = read(&of_hair, &IngestOptions::default());
    assert_eq!(names(&ingested.capture), ["A", "S01_1"]);
    assert_eq!(
        ingested.report.warnings[1],
        "1 markers are where a solved body has them: no measured ones have their labels"
    );
}

#[test]
fn what_is_no_capture_is_named() {
    assert_eq!(error("", &IngestOptions::default()), IngestError::Empty.to_string());
    assert_eq!(
        error("hello\nworld", &IngestOptions::default()),
        "found bytes that begin with \"hello\\nworld\", expected a capture: C3D, Vicon CSV, Motive CSV or TRC"
    );
    let devices = "Devices\n1000\n,,Plate,,\nFrame,Sub Frame,Fx,Fy,Fz\n,,N,N,N\n1,0,1,2,3\n";
    assert_eq!(
        error(devices, &IngestOptions::default()),
        "found no points, Devices (1), expected marker trajectories"
    );
}
