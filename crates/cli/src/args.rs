//! What can be said on the command line.

mod bench;
mod simulate;
mod values;

pub use bench::{
    BenchAllArgs, BenchArgs, BenchCommand, BenchDirectArgs, BenchPaperArgs, BenchPart, BenchSimArgs,
    BenchWindArgs,
};
pub use simulate::{BodyArgs, ShapeArg, SimulateArgs};

use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};
use std::ffi::OsString;
use std::path::PathBuf;
use values::{parse_above_zero, parse_axis, parse_edit_method, parse_finite, parse_unit};

/// Hair in the wind, measured once, worn by any hairstyle.
#[derive(Debug, Parser)]
#[command(name = "tousle", version, max_term_width = 110)]
#[command(after_help = "Exit codes: 0 fine, 1 failed or invalid, 2 wrong arguments, 3 finished with loss.")]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Threads for the heavy stages [default: all cores]. The result does not depend on it.
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// No progress bars, also on a terminal.
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

impl Cli {
    /// What was said. Ends the program if that cannot be understood.
    pub fn read() -> Self {
        let matches = with_negative_numbers(Self::command()).get_matches();
        Self::from_arg_matches(&matches).unwrap_or_else(|error| error.exit())
    }
}

/// A number below zero is a wrong value and not an unknown option: so whoever checks it can say what was expected.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    let takes_number = |arg: &clap::Arg| arg.get_action().takes_values() && !arg.is_positional();
    command
        .mut_args(|arg| if takes_number(&arg) { arg.allow_negative_numbers(true) } else { arg })
        .mut_subcommands(with_negative_numbers)
}

/// The commands, in the order in which one meets them.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Turn a capture into a wind field.
    Convert(ConvertArgs),
    /// Tell whether fields, sessions, grooms and edits are sound, and everything that is wrong with them.
    Validate(ValidateArgs),
    /// Tell what is in a file: a field, a capture or a groom.
    Inspect(InspectArgs),
    /// Blow a hairstyle with a field.
    Simulate(SimulateArgs),
    /// Pull strands where they should be: adds layers to a field.
    Edit(EditArgs),
    /// Pull hair to where the shot needs it, in a window: `tousle studio FIELD --groom GROOM`.
    #[command(disable_help_flag = true)]
    Studio(StudioArgs),
    /// Write a field for other tools.
    Export(ExportArgs),
    /// Make a field of wind from elsewhere (CFD, a scan, a known truth).
    Import(ImportArgs),
    /// Put several captures of one wig together into one richer field.
    Merge(MergeArgs),
    /// Save the whole steps of a field file that was cut or damaged, with what other programs put into it; all that is lost
    /// is named. What follows inserted or deleted bytes is lost.
    Recover(RecoverArgs),
    /// Write a field file of any version again in the newest one, with what other programs put into it; the little that
    /// cannot be copied is named.
    Migrate(MigrateArgs),
    /// Do all of it on an embedded capture and show it on one page.
    Demo(DemoArgs),
    /// Measure: error against run time, all of it or a part.
    Bench(BenchArgs),
}

/// `tousle convert`
#[derive(Debug, Args)]
pub struct ConvertArgs {
    /// The capture: C3D, Vicon CSV, and what else `inspect` reads. The format is told from the bytes.
    pub capture: PathBuf,
    /// What the people in the room knew (JSON or TOML).
    #[arg(long)]
    pub session: PathBuf,
    /// The field file to write.
    #[arg(short, long, value_name = "FIELD.eff.mcap")]
    pub output: PathBuf,
    /// How motion becomes wind.
    #[arg(long, value_enum, default_value_t = MethodArg::Physical)]
    pub method: MethodArg,
    /// Edge of the grid about the head, mm.
    #[arg(long, default_value_t = 600.0, value_name = "MM")]
    pub extent_mm: f64,
    /// Edge of a voxel, mm.
    #[arg(long, default_value_t = 20.0, value_name = "MM")]
    pub voxel_mm: f64,
    /// Time steps of the field a second.
    #[arg(long, default_value_t = 30.0, value_name = "HZ")]
    pub rate_hz: f64,
    /// Mend the wind, by simulating the captured wig in it, a second time if locks that are held out come nearer by it; without
    /// it this is done once. Takes twice as long.
    #[arg(long)]
    pub refine: bool,
    /// With --method paper, how its equation E3 is read [default: rest-pose].
    #[arg(long, value_enum)]
    pub reading: Option<ReadingArg>,
    /// With --method paper, the time s of E3, ms [default: a free fall along the lock, for each marker its own].
    #[arg(long, value_name = "MS")]
    pub span_ms: Option<f64>,
    /// How the capture is read.
    #[command(flatten)]
    pub read: ReadArgs,
    /// Leave gaps, exchanged labels, nameless pieces, spikes and what is far from its lock as the file has them.
    #[arg(long)]
    pub no_clean: bool,
    /// Write the capture's quality report: a page (.html) or JSON (.json); may be given more than once.
    #[arg(long, value_name = "REPORT.html|REPORT.json")]
    pub report: Vec<PathBuf>,
    /// How the field is packed.
    #[command(flatten)]
    pub pack: PackArgs,
    /// Print the conversion report as JSON.
    #[arg(long)]
    pub json: bool,
}

/// How a field's vectors are packed in its file.
#[derive(Debug, Args)]
pub struct PackArgs {
    /// f32 loses nothing; f16 keeps three digits at a third of the size; fixed keeps --max-error at less than that.
    #[arg(long, value_enum, default_value_t = EncodingArg::F32)]
    pub encoding: EncodingArg,
    /// The most that a component may be off, in the field's unit (m/s or m/s²); for --encoding fixed.
    #[arg(long, value_name = "E", required_if_eq("encoding", "fixed"))]
    pub max_error: Option<f64>,
    /// Add channels that Foxglove, Lichtblick and Rerun can draw: the wind as colored points, the head's frame.
    #[arg(long)]
    pub preview: bool,
}

/// `--encoding`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum EncodingArg {
    /// As computed.
    F32,
    /// Half precision.
    F16,
    /// Whole multiples of a step.
    Fixed,
}

/// How a field's vectors are packed in its file, if not as they were.
#[derive(Debug, Args)]
pub struct RepackArgs {
    /// As for `convert` [default: as the fields are packed, f32 if they differ].
    #[arg(long, value_enum)]
    pub encoding: Option<EncodingArg>,
    /// The most that a component may be off, in the field's unit (m/s or m/s²); for --encoding fixed.
    #[arg(long, value_name = "E", required_if_eq("encoding", "fixed"), requires = "encoding")]
    pub max_error: Option<f64>,
    /// As for `convert`.
    #[arg(long)]
    pub preview: bool,
}

impl RepackArgs {
    /// What was asked for, if anything was.
    pub fn given(&self) -> Option<PackArgs> {
        let encoding = self.encoding?;
        Some(PackArgs { encoding, max_error: self.max_error, preview: self.preview })
    }
}

/// `tousle merge`
#[derive(Debug, Args)]
pub struct MergeArgs {
    /// The fields, of one wig in one wind; the first one's scene is kept.
    #[arg(required = true, num_args = 2.., value_name = "FIELD")]
    pub fields: Vec<PathBuf>,
    /// The field file to write.
    #[arg(short, long, value_name = "FIELD.eff.mcap")]
    pub output: PathBuf,
    /// What is added to each field's times to have them on one clock, s, a number a field [default: nothing].
    #[arg(long, value_parser = parse_finite, value_name = "S,S,…", value_delimiter = ',', allow_hyphen_values = true)]
    pub offset_secs: Vec<f64>,
    /// From when to when the merged field goes.
    #[arg(long, value_enum, default_value_t = SpanArg::All)]
    pub span: SpanArg,
    /// Time steps a second [default: the highest of the fields].
    #[arg(long, value_parser = parse_above_zero, value_name = "HZ")]
    pub rate_hz: Option<f64>,
    /// How far the heads' ways and the bodies' shapes may differ, mm.
    #[arg(long, default_value_t = 10.0, value_parser = parse_above_zero, value_name = "MM")]
    pub tolerance_mm: f64,
    /// How far the heads may be turned from one another, degrees.
    #[arg(long, default_value_t = 2.0, value_parser = parse_above_zero, value_name = "DEG")]
    pub tolerance_deg: f64,
    /// How the field is packed.
    #[command(flatten)]
    pub pack: RepackArgs,
    /// Print what was merged, and how well it agrees, as JSON.
    #[arg(long)]
    pub json: bool,
}

/// `--span`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SpanArg {
    /// From the first step of any field to the last of any.
    All,
    /// Only while all fields have steps.
    Common,
}

/// `tousle recover`
#[derive(Debug, Args)]
pub struct RecoverArgs {
    /// The damaged field file; it is not touched.
    pub field: PathBuf,
    /// The field file to write.
    #[arg(short, long, value_name = "FIELD.eff.mcap")]
    pub output: PathBuf,
    /// Print what was saved and lost as JSON.
    #[arg(long)]
    pub json: bool,
}

/// `tousle migrate`
#[derive(Debug, Args)]
pub struct MigrateArgs {
    /// The field file; it is not touched.
    pub field: PathBuf,
    /// The field file to write.
    #[arg(short, long, value_name = "FIELD.eff.mcap")]
    pub output: PathBuf,
    /// Print what was done as JSON.
    #[arg(long)]
    pub json: bool,
}

/// What a marker file may fail to say.
#[derive(Debug, Args)]
pub struct ReadArgs {
    /// The unit of the capture's positions, whatever the file names [default: the file's; where it names none, the session's].
    #[arg(long, value_parser = parse_unit, value_name = "mm|cm|m|in")]
    pub unit: Option<tousle_core::LengthUnit>,
    /// The subject (prefix of the labels) to read, where there are several.
    #[arg(long)]
    pub subject: Option<String>,
    /// Take what is there of a capture that was cut off (then the exit code is 3).
    #[arg(long)]
    pub allow_cut: bool,
}

/// `--method`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MethodArg {
    /// The air's velocity: what explains the motion of all locks together (docs/physical-fit.md).
    Physical,
    /// Forces, by Kazama, Sugisaki and Morishima 2008, as documented in docs/equations.md.
    Paper,
}

/// `--reading`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ReadingArg {
    /// Displacement since the first frame, literally.
    FirstFrame,
    /// Displacement over a sliding window.
    SlidingWindow,
    /// Displacement from the rest pose.
    RestPose,
}

/// `tousle validate`
#[derive(Debug, Args)]
pub struct ValidateArgs {
    /// The files.
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// Print the findings as JSON.
    #[arg(long)]
    pub json: bool,
}

/// `tousle inspect`
#[derive(Debug, Args)]
pub struct InspectArgs {
    /// The file: a field, a capture or a groom. Its kind is told from the bytes.
    pub file: PathBuf,
    /// Print what was found as JSON.
    #[arg(long)]
    pub json: bool,
    /// The session of a capture: then the head is found and the locks are cleaned, and what that brings up is told.
    #[arg(long)]
    pub session: Option<PathBuf>,
    /// With --session, write the quality report: a page (.html) or JSON (.json); may be given more than once.
    #[arg(long, value_name = "REPORT.html|REPORT.json", requires = "session")]
    pub report: Vec<PathBuf>,
    /// With --session, leave the locks as the file has them.
    #[arg(long, requires = "session")]
    pub no_clean: bool,
    /// How a capture is read, with --session.
    #[command(flatten)]
    pub read: ReadArgs,
    /// The unit of a groom's positions, where its file names none.
    #[arg(long, value_parser = parse_unit, value_name = "mm|cm|m|in")]
    pub groom_unit: Option<tousle_core::LengthUnit>,
    /// The up axis of a groom, where its file names none: x, y or z, with a minus sign where that axis points down.
    #[arg(long, value_parser = parse_axis, value_name = "AXIS", allow_hyphen_values = true)]
    pub groom_up: Option<tousle_core::Axis>,
}

/// What a groom file may fail to say.
#[derive(Debug, Args)]
pub struct GroomArgs {
    /// The unit of the groom's positions, where its file names none.
    #[arg(long, value_parser = parse_unit, value_name = "mm|cm|m|in")]
    pub groom_unit: Option<tousle_core::LengthUnit>,
    /// The groom's up axis, where its file names none: x, y or z, with a minus sign where that axis points down.
    #[arg(long, value_parser = parse_axis, value_name = "AXIS", allow_hyphen_values = true)]
    pub groom_up: Option<tousle_core::Axis>,
    /// The groom's axis along which the nose points [default: x where z is up, z where y is up].
    #[arg(long, value_parser = parse_axis, value_name = "AXIS", allow_hyphen_values = true)]
    pub groom_forward: Option<tousle_core::Axis>,
    /// Scale and shift the groom so that its roots lie on the field's head.
    #[arg(long)]
    pub fit_to_head: bool,
}

/// `tousle edit`
#[derive(Debug, Args)]
pub struct EditArgs {
    /// The field.
    pub field: PathBuf,
    /// The hairstyle in which the strands are pulled.
    #[arg(long)]
    pub groom: PathBuf,
    /// The key frames (TOML or JSON).
    #[arg(long)]
    pub edits: PathBuf,
    /// The field file to write: the same field with layers added.
    #[arg(short, long, value_name = "FIELD.eff.mcap")]
    pub output: PathBuf,
    /// Which equations turn a drag into layers [default: physical for fields of wind, paper for fields of forces].
    #[arg(long, value_parser = parse_edit_method, value_name = "physical|paper")]
    pub method: Option<tousle_direct::EditMethod>,
    /// With method physical, a key is met if its point is no farther from it than this, mm [default: 1].
    #[arg(long, value_parser = parse_above_zero, value_name = "MM")]
    pub tolerance_mm: Option<f64>,
    /// Print the report as JSON.
    #[arg(long)]
    pub json: bool,
    /// How the groom is read.
    #[command(flatten)]
    pub groom_args: GroomArgs,
}

/// `tousle studio`
#[derive(Debug, Args)]
pub struct StudioArgs {
    /// A field, `--groom GROOM`, and what else `tousle studio --help` lists.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "FIELD --groom GROOM")]
    pub args: Vec<OsString>,
}

/// `tousle export`
#[derive(Debug, Args)]
pub struct ExportArgs {
    /// The field.
    pub field: PathBuf,
    /// Where it goes: .npz, or .vdb (one file a time step, numbered).
    #[arg(short, long, value_name = "OUT.npz|OUT.vdb")]
    pub output: PathBuf,
}

/// `tousle import`
#[derive(Debug, Args)]
pub struct ImportArgs {
    /// The wind: one .npz as `export` writes it, or with `u_q` and `scale` in place of `u`; or .vdb files, one a time
    /// step (OUT.vdb alone stands for OUT.0000.vdb and on).
    #[arg(required = true, value_name = "WIND.npz|WIND.vdb")]
    pub wind: Vec<PathBuf>,
    /// The session it belongs to: body, air, markers.
    #[arg(long)]
    pub session: PathBuf,
    /// The field file to write.
    #[arg(short, long, value_name = "FIELD.eff.mcap")]
    pub output: PathBuf,
    /// The head's poses: .npz with `t` (T), `R` (T,3,3), `p` (T,3) [default: an upright, still head].
    #[arg(long, value_name = "POSES.npz")]
    pub head: Option<PathBuf>,
    /// How the field is packed.
    #[command(flatten)]
    pub pack: PackArgs,
    /// Edge of the grid about the head, mm, where a .npz gives neither `origin` nor `edge` [default: 600].
    #[arg(long, value_parser = parse_above_zero, value_name = "MM")]
    pub extent_mm: Option<f64>,
    /// The grid of a .vdb that is the wind [default: wind, velocity, vel or v, or the only vectors].
    #[arg(long, value_name = "NAME")]
    pub grid: Option<String>,
    /// Time steps a second, where .vdb files do not say when they are.
    #[arg(long, value_parser = parse_above_zero, value_name = "HZ")]
    pub rate_hz: Option<f64>,
    /// Print the report as JSON.
    #[arg(long)]
    pub json: bool,
}

/// `tousle demo`
#[derive(Debug, Args)]
pub struct DemoArgs {
    /// The folder to write into.
    #[arg(short, long, default_value = "tousle-demo", value_name = "DIR")]
    pub output: PathBuf,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
