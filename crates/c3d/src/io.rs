pub(crate) mod reader;
