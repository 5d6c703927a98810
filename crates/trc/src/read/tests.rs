use super::*;

const TRC: &str = "PathFileType\t4\t(X/Y/Z)\ttrial.trc\n\
    DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n\
    100.00\t100.00\t2\t2\tmm\t100.00\t1\t2\n\
    Frame#\tTime\tLFHD\t\t\tNOSE\t\t\n\
    \t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\
    \n\
    7\t0.00\t165.1\t331.8\t1508.1\t\t\t\n\
    8\t0.01\t165.2\t331.9\t1508.2\t1.5\t2.5\t3.5\n";

fn error(text: &str) -> String {
    read(text.as_bytes()).unwrap_err().to_string()
}

fn check_same(text: &str) -> Vec<String> {
    let (plain, other) = (read(TRC.as_bytes()).unwrap(), read(text.as_bytes()).unwrap());
    assert_eq!(other.markers, plain.markers, "{text}");
    assert_eq!(other.frames, plain.frames, "{text}");
    assert_eq!(other.header.data_rate_hz, Some(100.0));
    assert_eq!(other.header.unit.as_deref(), Some("mm"));
    other.warnings
}

#[test]
fn a_tidy_file() {
    let trc = read(TRC.as_bytes()).unwrap();
    assert_eq!(trc.frames, [7, 8]);
    assert_eq!(trc.lines, [7, 8]);
    assert_eq!(trc.times_secs, [Some(0.0), Some(0.01)]);
    assert_eq!(trc.markers[0].label, "LFHD");
    assert_eq!(trc.markers[0].positions, [Some([165.1, 331.8, 1508.1]), Some([165.2, 331.9, 1508.2])]);
    assert_eq!(trc.markers[1].positions, [None, Some([1.5, 2.5, 3.5])]);
    assert_eq!(trc.warnings, [""; 0]);
}

#[test]
fn the_same_file_in_other_clothes() {
    let none = [""; 0];
    assert_eq!(check_same(&TRC.replace('\n', "\r\n")), none);
    assert_eq!(check_same(&TRC.replace('\n', "\r\r\n")), none);
    assert_eq!(check_same(&format!("\u{feff}{TRC}")), none);
    assert_eq!(check_same(&TRC.replace('\n', "\t\n")), none);
    assert_eq!(check_same(&TRC.replace("\t\t\t\n", "\tNaN\tnan\t NAN \n")), none);
    assert_eq!(check_same(&TRC.replace("\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n", "")), none);
    assert_eq!(check_same(&TRC.replace('\t', ",")), none);
    assert_eq!(check_same(&TRC.replace('.', ",")), none);
    assert_eq!(
        check_same(&TRC.replace("100.00\t100.00\t2\t2\tmm", "100.00\t\t100.00\t\t2\t\t2\t\t mm")),
        none
    );
    assert_eq!(check_same(&TRC.replace("PathFileType\t4\t(X/Y/Z)\ttrial.trc\n", "")), none);
    assert_eq!(check_same(TRC.trim_end()), none);
    let turned = TRC.replace("DataRate\tCameraRate\tNumFrames", "NumFrames\tCameraRate\tDataRate");
    assert_eq!(check_same(&turned.replace("100.00\t100.00\t2\t2", "2\t100.00\t100.00\t2")), none);
    let utf_16: Vec<u8> = format!("\u{feff}{TRC}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert_eq!(read(&utf_16).unwrap(), read(TRC.as_bytes()).unwrap());
}

#[test]
fn labels_one_cell_apart_are_counted() {
    assert_eq!(check_same(&TRC.replace("LFHD\t\t\tNOSE\t\t", "\tLFHD\t\tNOSE\t\t")), [""; 0]);
}

#[test]
fn wrong_counts_and_short_rows_are_warned_of() {
    let text = TRC.replace("\t2\t2\tmm", "\t900\t28\tmm").replace("\t\t\t\n8", "\n8");
    assert_eq!(
        check_same(&text),
        [
            "1 lines, the first of them line 7, are short; missing cells count as blank",
            "NumMarkers is 28, 2 labels are there",
            "NumFrames is 900, 2 rows are there",
        ]
    );
}

#[test]
fn a_marker_without_a_label_keeps_its_columns() {
    let text = TRC.replace("LFHD", "");
    let trc = read(text.as_bytes()).unwrap();
    assert_eq!(trc.markers.len(), 1);
    assert_eq!(trc.markers[0].label, "NOSE");
    assert_eq!(trc.markers[0].positions, [None, Some([1.5, 2.5, 3.5])]);
    assert_eq!(trc.warnings[0], "1 markers without a label are left out");
}

#[test]
fn coordinates_beyond_the_labels_are_left_out_with_a_warning() {
    let text = TRC.replace("LFHD\t\t\tNOSE\t\t\n", "LFHD\n");
    let trc = read(text.as_bytes()).unwrap();
    assert_eq!(trc.markers[0].positions.len(), 2);
    assert_eq!(
        trc.warnings[0],
        "1 lines, the first of them line 8, hold coordinates without a label; they are left out"
    );
}

#[test]
fn a_line_that_was_cut_off_gives_no_cut_numbers() {
    let text = TRC.split("1508.2").next().unwrap();
    let trc = read(format!("{text}15").as_bytes()).unwrap();
    assert_eq!(trc.markers[0].positions, [Some([165.1, 331.8, 1508.1]), None]);
}

/// The header claims 600 frames, the 41st breaks off: within the row, or within its last number.
#[test]
fn a_file_that_was_cut_off_says_so() {
    let header = TRC.split("7\t0.00").next().unwrap().replace("\t2\t2\tmm", "\t600\t2\tmm");
    let row = |k: usize| format!("{k}\t0.0{k}\t1.5\t2.5\t3.5\t4.5\t5.5\t6.5{}\n", k % 10);
    let whole: String = header + &(1..41).map(row).collect::<String>();
    let cut = |last: &str| {
        let trc = read(format!("{whole}{last}").as_bytes()).unwrap();
        (trc.cut, trc.markers[1].positions.last().copied().flatten())
    };
    assert_eq!(cut(""), (None, Some([4.5, 5.5, 6.5])), "a wrong count, it may be");
    assert_eq!(cut("41\t0.41\t1.5\t2.5\t3.5\t4.5\t5"), (Some((600, 40)), None));
    assert_eq!(cut("41\t0.41\t1.5\t2.5\t3.5\t4.5\t5.5\t6.5"), (Some((600, 40)), None));
    assert_eq!(cut("41\t0.41\t1.5\t2.5\t3.5\t4.5\t5.5\t6.50"), (Some((600, 41)), Some([4.5, 5.5, 6.5])));
    let trc = read(whole.replace("\t600\t", "\t40\t").trim_end().as_bytes()).unwrap();
    assert_eq!((trc.cut, trc.warnings), (None, vec![]), "many programs write no end of the last line");
    let lost = read(format!("{whole}41\t0.41\t1.5\t2.5\t3.5\t4.5\t5.5\t6").as_bytes()).unwrap();
    assert_eq!(
        lost.warnings[0],
        "line 47 has no end, and its last number fewer decimals than all above it: it counts as missing"
    );
}

#[test]
fn decimal_commas_between_commas_are_refused() {
    let text = TRC.replace(['.', '\t'], ",");
    assert_eq!(error(&text), "line 3: found 11 cells, expected 8 cells, with decimal points");
}

#[test]
fn what_is_no_trc_is_refused_with_its_line() {
    assert_eq!(
        error("PathFileType\t4\n"),
        "line 2: found the end of the file, expected a line with `DataRate`, `NumFrames`, `Units`"
    );
    assert_eq!(
        error("PathFileType\t4\nDataRate\tNumFrames\n"),
        "line 3: found the end of the file, expected the values of these keys"
    );
    assert_eq!(
        error(&format!("# exported by hand\n{TRC}")),
        "line 1: found \"# exported by hand\", expected a line with `DataRate`, `NumFrames`, `Units`"
    );
    assert_eq!(error(&TRC.replace("331.9", "x")), "line 8, column 4: found \"x\", expected a number");
    assert_eq!(
        error(&TRC.replace("Frame#", "What")),
        "line 4: found \"What\", expected a line that begins with `Frame#`"
    );
}
