use super::*;

const V1_23: &str = "Format Version,1.23,Take Name,a take,Capture Frame Rate,120.000000,\
Export Frame Rate,60.000000,Total Exported Frames,2,Length Units,Meters\r\n\
\r\n\
,Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,\
Rigid Body Marker,Rigid Body Marker,Rigid Body Marker,Rigid Body Marker,Marker,Marker,Marker\r\n\
,Name,Head,Head,Head,Head,Head,Head,Head,Head,\"Head:LFHD\",\"Head:LFHD\",\"Head:LFHD\",\"Head:LFHD\",\
Head:LFHD,Head:LFHD,Head:LFHD\r\n\
,ID,\"AA\",\"AA\",\"AA\",\"AA\",\"AA\",\"AA\",\"AA\",\"AA\",\"AB\",\"AB\",\"AB\",\"AB\",\"AC\",\"AC\",\"AC\"\r\n\
,,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Mean Marker Error,\
Position,Position,Position,Marker Quality,Position,Position,Position\r\n\
Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,,X,Y,Z,,X,Y,Z\r\n\
0,0.000000,0,0,0,1,0.1,0.2,0.3,0.0001,0.4,0.5,0.6,0.99,0.41,0.51,0.61\r\n\
1,0.016667,,,,,,,,,0.4,0.5,0.6,0.98,,,\r\n";

/// The same take as 1.25 writes it: a byte order mark and a line of parents.
fn v1_25() -> String {
    let parents = format!(",Parent{}\r\n,,Rotation", ",".repeat(15));
    format!("\u{feff}{}", V1_23.replace("1.23", "1.25").replacen(",,Rotation", &parents, 1))
}

/// The same take as 1.21 writes it: nothing says which header line is which.
fn v1_21() -> String {
    V1_23
        .replace("1.23", "1.21")
        .replace(",Type", ",")
        .replace(",Name,Head", ",,Head")
        .replace(",ID,", ",,")
        .replace("Time (Seconds)", "Time")
}

#[test]
fn three_versions_of_one_take() {
    for take in [V1_23.to_owned(), v1_25(), v1_21(), V1_23.replace("\r\n", "\n")] {
        assert!(detect(take.as_bytes()));
        let file = read(take.as_bytes()).unwrap();
        assert_eq!(file.rate_hz, Some(60.0), "the rate of what was exported");
        assert_eq!(file.unit.as_deref(), Some("Meters"));
        assert_eq!(file.table.frames, [0, 1]);
        assert_eq!(file.rotations, ["Head"]);
        let points: Vec<(&str, &str)> =
            file.table.points.iter().map(|p| (p.kind.as_str(), p.label.as_str())).collect();
        assert_eq!(
            points,
            [("Rigid Body", "Head"), ("Rigid Body Marker", "Head:LFHD"), ("Marker", "Head:LFHD")]
        );
        assert_eq!(file.table.points[0].positions, [Some([0.1, 0.2, 0.3]), None]);
        assert_eq!(file.table.points[2].positions, [Some([0.41, 0.51, 0.61]), None]);
        assert_eq!(file.times_secs, [Some(0.0), Some(0.016667)]);
        assert_eq!(file.warnings, [""; 0]);
    }
}

#[test]
fn fewer_rows_than_claimed_are_reported() {
    let cut = V1_23.rsplit_once("1,0.016667").unwrap().0;
    assert_eq!(read(cut.as_bytes()).unwrap().warnings, ["the header claims 2 frames, 1 are there"]);
}

#[test]
fn row_typed_files_are_recognized_and_refused() {
    let old = b"comment,\"OptiTrack Export Data\"\r\nrighthanded\r\ninfo,version,1.1\r\nframe,0,0.0,0,0\r\n";
    assert!(detect(old));
    assert_eq!(
        read(old).unwrap_err().to_string(),
        "line 1: found a row of type `comment`, as formats before 1.2 have them, expected `Format Version` 1.2 or \
         later: export the take again with a newer Motive"
    );
}
