use super::*;
use crate::Point;

const NEXUS: &str = "Trajectories\r\n\
    120\r\n\
    ,,Wig:LFHD,,,Wig:NOSE,,\r\n\
    Frame,Sub Frame,X,Y,Z,X,Y,Z\r\n\
    ,,mm,mm,mm,mm,mm,mm\r\n\
    695,0,165.151,331.839,1508.13,,,\r\n\
    696,0,165.1,331.8,1508.1,1.5,2.5,3.5\r\n";

fn trajectories(file: &ViconFile) -> &Section {
    file.sections.iter().find(|s| s.kind == SectionKind::Trajectories).unwrap()
}

/// What the rows of trajectories hold, wherever in the file they stand.
fn rows(file: &ViconFile) -> (&[i64], &[Point]) {
    let table = &trajectories(file).table;
    (&table.frames, &table.points)
}

fn error(text: &str) -> String {
    read(text.as_bytes()).unwrap_err().to_string()
}

#[test]
fn a_nexus_file() {
    let file = read(NEXUS.as_bytes()).unwrap();
    let section = trajectories(&file);
    assert_eq!(file.layout, Layout::Nexus);
    assert_eq!(section.rate_hz, Some(120.0));
    assert_eq!(section.table.frames, [695, 696]);
    assert_eq!(section.table.lines, [6, 7]);
    assert_eq!(section.names, ["Wig:LFHD", "Wig:NOSE"]);
    let [head, nose] = &section.table.points[..] else { panic!("two points") };
    assert_eq!(head.positions[0], Some([165.151, 331.839, 1508.13]));
    assert_eq!(head.unit.as_deref(), Some("mm"));
    assert_eq!(nose.positions, [None, Some([1.5, 2.5, 3.5])]);
    assert!(file.warnings.is_empty(), "{:?}", file.warnings);
}

#[test]
fn the_same_file_in_other_clothes() {
    let expected = read(NEXUS.as_bytes()).unwrap();
    let same = |text: Vec<u8>| {
        let file = read(&text).unwrap();
        assert_eq!(file.sections[0].table, expected.sections[0].table);
        assert_eq!(file.sections[0].rate_hz, expected.sections[0].rate_hz);
        assert!(file.warnings.is_empty(), "{:?}", file.warnings);
    };
    same([b"\xEF\xBB\xBF", NEXUS.as_bytes()].concat());
    same(NEXUS.replace("\r\n", "\n").into_bytes());
    same(NEXUS.replace("\r\n", "\r\r\n").into_bytes());
    same(NEXUS.replace("\r\n", "\r").into_bytes());
    same(NEXUS.replace("\r\n", ",\r\n").into_bytes());
    same(NEXUS.replace("\r\n", ",,,\r\n").into_bytes());
    same(NEXUS.replace(',', "\t").into_bytes());
    same(NEXUS.replace(',', ";").into_bytes());
    same(NEXUS.replace(',', ";").replace('.', ",").into_bytes());
    same(NEXUS.trim_end().as_bytes().to_vec());
    same(NEXUS.encode_utf16().flat_map(u16::to_le_bytes).fold(vec![0xFF, 0xFE], |mut all, byte| {
        all.push(byte);
        all
    }));
}

/// Cut within its last number, which has six digits in all rows above.
#[test]
fn a_number_that_was_cut_counts_as_missing() {
    let row = |k: usize| format!("{k},0,165.1,331.8,1508.1,1.5,2.5,1345.1{}\r\n", k % 10);
    let text = NEXUS.split("695,").next().unwrap().to_owned() + &(1..41).map(row).collect::<String>();
    let last = |cell: &str, end: &str| {
        let file = read(format!("{text}41,0,165.1,331.8,1508.1,1.5,2.5,{cell}{end}").as_bytes()).unwrap();
        let [head, nose] = &trajectories(&file).table.points[..] else { panic!("two points") };
        assert_eq!(head.positions[40], Some([165.1, 331.8, 1508.1]));
        (nose.positions[40], file.warnings)
    };
    let (position, warnings) = last("134", "");
    assert_eq!(position, None);
    assert!(
        warnings[0].ends_with(
            "line 46 has no end, and its last number fewer decimals than all above it: it counts as missing"
        ),
        "{warnings:?}"
    );
    for (cell, end) in [("1345.12", ""), ("134", "\r\n"), ("1345.123", "")] {
        let (position, warnings) = last(cell, end);
        assert!(position.is_some() && warnings.is_empty(), "{cell}: {warnings:?}");
    }
}

/// What Nexus writes when everything is ticked; sections with rates of their own.
const ALL_SECTIONS: &str = "Events,,,,\r\n100,,,,\r\n\
    Subject,Context,Name,Time (s),Description\r\nWig,Right,Foot Strike,1.23,\r\nWig,Left,Foot Off,1.5,\r\n\r\n\
    Devices,,,,\r\n2000,,,,\r\n,,Plate - Force,,\r\nFrame,Sub Frame,Fx,Fy,Fz\r\n,,N,N,N\r\n\
    695,0,0.1,0.2,0.3\r\n695,1,0.1,0.2,0.3\r\n696,0,,,\r\n696,1,0.1,0.2,0.3\r\n\r\n\
    Model Outputs,,,,\r\n120,,,,\r\n,,Wig:Angles,,\r\nFrame,Sub Frame,X,Y,Z\r\n,,deg,deg,deg\r\n\
    695,0,1,2,3\r\n,,,,\r\n";

#[test]
fn all_sections_in_one_file() {
    let text = format!("{ALL_SECTIONS}{NEXUS}");
    let file = read(text.as_bytes()).unwrap();
    let sections: Vec<(SectionKind, Option<f64>, usize, Option<i64>)> =
        file.sections.iter().map(|s| (s.kind, s.rate_hz, s.n_rows, s.first_frame)).collect();
    assert_eq!(
        sections,
        [
            (SectionKind::Events, Some(100.0), 2, None),
            (SectionKind::Devices, Some(2000.0), 4, Some(695)),
            (SectionKind::ModelOutputs, Some(120.0), 1, Some(695)),
            (SectionKind::Trajectories, Some(120.0), 2, Some(695)),
        ]
    );
    assert_eq!(file.sections[1].names, ["Plate - Force"]);
    assert_eq!(rows(&file), rows(&read(NEXUS.as_bytes()).unwrap()));
    // The order of sections is the exporter's affair.
    let turned = read(format!("{NEXUS}\r\n{ALL_SECTIONS}").as_bytes()).unwrap();
    assert_eq!(rows(&turned), rows(&file));
    assert_eq!(turned.sections.len(), 4);
}

#[test]
fn title_and_rate_may_be_cut_off() {
    let untitled = NEXUS.strip_prefix("Trajectories\r\n120\r\n").unwrap();
    let file = read(untitled.as_bytes()).unwrap();
    assert_eq!(trajectories(&file).rate_hz, None);
    assert_eq!(rows(&file), rows(&read(NEXUS.as_bytes()).unwrap()));
    let angles = untitled.replace("mm", "deg");
    assert_eq!(read(angles.as_bytes()).unwrap().sections[0].kind, SectionKind::Other);
}

#[test]
fn workstation_files() {
    let text = "Title\nDate:\nDescription:,\"\"\n\nTRAJECTORIES\n100,Hz\n,LFHD,,,NOSE,,\n\
        Field #,X,Y,Z,X,Y,Z\n1,174.5,324.5,1728.9,,,\n2,174.5,324.5,1728.9,1,2,3\n\n\
        ANALOG\n1000,Hz\nSample #,Fx1,Fy1\nUnits:,N,N\n1,0.5,0.5\n2,0.5,0.5\n";
    let file = read(text.as_bytes()).unwrap();
    assert_eq!(file.layout, Layout::Workstation);
    assert_eq!(trajectories(&file).rate_hz, Some(100.0));
    assert_eq!(trajectories(&file).table.frames, [1, 2]);
    assert_eq!(trajectories(&file).table.points[0].unit, None);
    assert_eq!(trajectories(&file).table.points[1].positions, [None, Some([1.0, 2.0, 3.0])]);
    assert_eq!((file.sections[1].kind, file.sections[1].n_rows), (SectionKind::Devices, 2));
}

#[test]
fn derivatives_beside_positions_are_passed_over() {
    let text = "Trajectories\n100\n,,A,,,,,,,,,B,,\n\
        Frame,Sub Frame,X,Y,Z,X',Y',Z',X'',Y'',Z'',X,Y,Z\n\
        ,,mm,mm,mm,mm/s,mm/s,mm/s,mm/s^2,mm/s^2,mm/s^2,mm,mm,mm\n\
        1,0,1.5,2,3,9,9,9,8,8,8,4,5,6\n";
    let file = read(text.as_bytes()).unwrap();
    let [a, b] = &trajectories(&file).table.points[..] else { panic!("two points") };
    assert_eq!(a.positions, [Some([1.5, 2.0, 3.0])]);
    assert_eq!(b.positions, [Some([4.0, 5.0, 6.0])]);
}

#[test]
fn trajectories_without_a_label_are_reported() {
    let text = NEXUS.replace("Wig:NOSE", "");
    let file = read(text.as_bytes()).unwrap();
    assert_eq!(trajectories(&file).names, ["Wig:LFHD"]);
    assert_eq!(file.warnings, ["line 4: 1 trajectories without a label are left out"]);
}

#[test]
fn short_rows_and_half_positions_are_missing_and_reported() {
    let text = NEXUS.replace("1508.13,,,", "1508.13").replace("1.5,2.5,3.5", "1.5,,3.5");
    let file = read(text.as_bytes()).unwrap();
    assert_eq!(trajectories(&file).table.points[1].positions, [None, None]);
    assert_eq!(
        file.warnings,
        [
            "1 lines, the first of them line 6, are not as long as the header; missing cells count as blank",
            "1 positions have one or two of their three coordinates; they count as missing",
        ]
    );
}

#[test]
fn a_line_that_was_cut_off_gives_no_cut_numbers() {
    let text = NEXUS.strip_suffix(".5\r\n").unwrap();
    let whole = read(text.as_bytes()).unwrap();
    assert_eq!(trajectories(&whole).table.points[1].positions[1], Some([1.5, 2.5, 3.0]), "nobody can tell");
    let text = NEXUS.strip_suffix(",2.5,3.5\r\n").unwrap();
    let cut = read(format!("{text},2").as_bytes()).unwrap();
    assert_eq!(trajectories(&cut).table.points[1].positions[1], None);
    let text = NEXUS.split("31.8,").next().unwrap();
    let cut = read(text.as_bytes()).unwrap();
    assert_eq!(trajectories(&cut).table.points[0].positions, [Some([165.151, 331.839, 1508.13]), None]);
}

#[test]
fn errors_say_where() {
    assert_eq!(
        error(&NEXUS.replace("331.8,", "331.8x,")),
        "line 7, column 4: found \"331.8x\", expected a number"
    );
    assert_eq!(
        error(&NEXUS.replace("\r\n696,", "\r\n69.6,")),
        "line 7, column 1: found \"69.6\", expected a frame number (a whole number)"
    );
    assert_eq!(
        error(&NEXUS.replace("X,Y,Z,X,Y,Z", "X,Y,Z,X,Z,Y")),
        "line 4, column 6: found \"X\", expected X, Y, Z under the label Wig:NOSE"
    );
    assert_eq!(
        error(&NEXUS.replace("\r\n696,0,", "\r\n696,1,")),
        "line 7, column 2: found \"1\", expected sub-frame 0: trajectories have one row a frame"
    );
    assert_eq!(
        error("Trajectories\n100\n,,A,,\n"),
        "line 4: found the end of the file, expected a line that begins with `Frame` or `Field #`"
    );
    assert_eq!(
        error("nothing\nof the kind\n"),
        "found no section, expected a line with a rate or with `Frame,Sub Frame,…` or `Field #,…`"
    );
}

#[test]
fn decimal_commas_between_commas_are_refused() {
    assert_eq!(
        error(&NEXUS.replace('.', ",")),
        "line 7: found 14 cells, expected at most 8 cells (a decimal comma in a comma-separated file makes two of one)"
    );
    assert_eq!(
        error(&NEXUS.replace("331.8,", "\"1,508\",")),
        "line 7, column 4: found \"1,508\", expected a number with a decimal point, without thousands separators"
    );
    assert_eq!(
        error(&NEXUS.replace(',', ";").replace("331.8;", "1,508;")),
        "line 7, column 4: found \"1,508\", expected a number with the decimal mark that the rest of the file uses, \
         without thousands separators"
    );
}

#[test]
fn a_rate_with_a_decimal_comma_is_not_lost() {
    for rate in ["119,88", "\"119,88\"", "119,88,,,"] {
        assert_eq!(
            error(&NEXUS.replace("120\r\n", &format!("{rate}\r\n"))),
            "line 2: found 119,88, expected a rate with a decimal point"
        );
    }
    let text = NEXUS.replace(',', ";").replace("120\r\n", "119,88\r\n").replace('.', ",");
    assert_eq!(trajectories(&read(text.as_bytes()).unwrap()).rate_hz, Some(119.88));
}

#[test]
fn decimal_commas_hidden_by_missing_markers_are_refused() {
    // The second marker is never seen, so a line split at its commas has no more filled cells than the header.
    let text = "Trajectories\n120\n,,A,,,B,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm\n1,0,165,151,331,839,1508,13,,,\n";
    assert_eq!(
        error(text),
        "line 6: found a line that does not have 8 cells, and no decimal point, expected numbers with a decimal point"
    );
}
