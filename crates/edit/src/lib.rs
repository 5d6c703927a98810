//! Key-frame edits of a field: an animator pulls a strand, a layer of extra force comes out.
