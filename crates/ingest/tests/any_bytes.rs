//! Whatever the bytes, there is an answer and no panic.

use proptest::prelude::*;
use tousle_ingest::{IngestOptions, guess_format, read_capture, read_session, summarize};

/// Beginnings that lead a guess to each reader.
const BEGINNINGS: [&[u8]; 6] = [
    b"",
    b"\x02\x50\x00\x00",
    b"DataRate\tUnits\n1\tmm\nFrame#\tTime\tA\n",
    b"Format Version,1.23\n,Type,Marker,Marker,Marker\n,Name,A,A,A\n,,Position,Position,Position\nFrame,Time,X,Y,Z\n",
    b"Trajectories\n100\n,,A,,\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n",
    b"{\"strands\": [",
];

proptest! {
    #[test]
    fn there_is_an_answer(
        beginning in 0..BEGINNINGS.len(),
        bytes in prop::collection::vec(prop_oneof![any::<u8>(), prop::sample::select(b"0123456789.,-\n\r\";:{}[]".to_vec())], 0..600),
    ) {
        let bytes = [BEGINNINGS[beginning], &bytes].concat();
        let _ = (guess_format(&bytes), summarize(&bytes), read_session(&bytes));
        let _ = read_capture(&bytes, &IngestOptions::default());
    }
}
