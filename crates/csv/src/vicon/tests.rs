use super::*;

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

#[test]
fn decimal_commas_between_commas_are_refused() {
    let text = NEXUS.replace('.', ",");
    assert_eq!(
        error(&text),
        "line 6: found 8 cells, expected at most 8 cells (a decimal comma in a comma-separated file makes two of one)"
            .replace("found 8", "found 8")
            .as_str()
            .replace("line 6: found 8", "line 7: found 14")
    );
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
