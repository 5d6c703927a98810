//! The field file, .eff.mcap: written, read, validated.
