//! What can be said on the command line.

use clap::{Args, Parser, Subcommand, ValueEnum};
use std::ffi::OsString;
use std::path::PathBuf;

/// Hair in the wind, measured once, worn by any hairstyle.
#[derive(Debug, Parser)]
#[command(name = "tousle", version, about, max_term_width = 110)]
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
    /// Save every whole step of a field file that was cut or damaged.
    Recover(RecoverArgs),
    /// Write a field file of any version again in the newest one; nothing is lost.
    Migrate(MigrateArgs),
    /// Do all of it on an embedded capture and show it on one page.
    Demo(DemoArgs),
    /// Measure: error against run time.
    #[command(subcommand)]
    Bench(BenchCommand),
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
    /// Mend the wind until the captured wig, simulated in it, moves as it was seen to move; takes some five times as long.
    #[arg(long)]
    pub refine: bool,
    /// How equation E3 of the paper is read.
    #[arg(long, value_enum, default_value_t = ReadingArg::RestPose)]
    pub reading: ReadingArg,
    /// The time s of E3, ms [default: a free fall along the lock, for each marker its own].
    #[arg(long, value_name = "MS")]
    pub span_ms: Option<f64>,
    /// How the capture is read.
    #[command(flatten)]
    pub read: ReadArgs,
    /// Leave gaps, exchanged labels, nameless pieces and spikes as the file has them.
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
    #[arg(long, value_name = "S,S,…", value_delimiter = ',', allow_hyphen_values = true)]
    pub offset_secs: Vec<f64>,
    /// From when to when the merged field goes.
    #[arg(long, value_enum, default_value_t = SpanArg::All)]
    pub span: SpanArg,
    /// Time steps a second [default: the highest of the fields].
    #[arg(long, value_name = "HZ")]
    pub rate_hz: Option<f64>,
    /// How far the heads' ways and the bodies' shapes may differ, mm.
    #[arg(long, default_value_t = 10.0, value_name = "MM")]
    pub tolerance_mm: f64,
    /// How far the heads may be turned from one another, degrees.
    #[arg(long, default_value_t = 2.0, value_name = "DEG")]
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
    /// The unit of the capture's positions, where the file names none.
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
    /// The up axis of a groom, where its file names none.
    #[arg(long, value_parser = parse_up_axis, value_name = "X|Y|Z")]
    pub groom_up: Option<tousle_core::UpAxis>,
}

/// What a groom file may fail to say.
#[derive(Debug, Args)]
pub struct GroomArgs {
    /// The unit of the groom's positions, where its file names none.
    #[arg(long, value_parser = parse_unit, value_name = "mm|cm|m|in")]
    pub groom_unit: Option<tousle_core::LengthUnit>,
    /// The groom's up axis, where its file names none.
    #[arg(long, value_parser = parse_up_axis, value_name = "X|Y|Z")]
    pub groom_up: Option<tousle_core::UpAxis>,
    /// The groom's axis along which the nose points [default: x where z is up, z where y is up].
    #[arg(long, value_parser = parse_axis, value_name = "AXIS", allow_hyphen_values = true)]
    pub groom_forward: Option<tousle_groom::Axis>,
    /// Scale and shift the groom so that its roots lie on the field's head.
    #[arg(long)]
    pub fit_to_head: bool,
}

/// The shot's own body.
#[derive(Clone, Debug, Args)]
pub struct BodyArgs {
    /// A closed triangle mesh of the shot's own head, in place of the field's shapes that move with the head. Its origin
    /// is the head's center.
    #[arg(long, value_name = "HEAD.obj", requires_all = ["mesh_unit", "mesh_up"])]
    pub head_mesh: Option<PathBuf>,
    /// The same for what stays with the torso, placed as it is while the head is at rest.
    #[arg(long, value_name = "TORSO.obj", requires_all = ["mesh_unit", "mesh_up"])]
    pub torso_mesh: Option<PathBuf>,
    /// The unit of the meshes' positions; no OBJ file states it.
    #[arg(long, value_parser = parse_unit, value_name = "mm|cm|m|in")]
    pub mesh_unit: Option<tousle_core::LengthUnit>,
    /// The meshes' up axis.
    #[arg(long, value_parser = parse_up_axis, value_name = "X|Y|Z")]
    pub mesh_up: Option<tousle_core::UpAxis>,
    /// The meshes' axis along which the nose points [default: x where z is up, z where y is up].
    #[arg(long, value_parser = parse_axis, value_name = "AXIS", allow_hyphen_values = true)]
    pub mesh_forward: Option<tousle_groom::Axis>,
}

/// `tousle simulate`
#[derive(Debug, Args)]
pub struct SimulateArgs {
    /// The field.
    pub field: PathBuf,
    /// The hairstyle.
    #[arg(long)]
    pub groom: PathBuf,
    /// Where the motion goes: .npz or .usda; may be given more than once.
    #[arg(short, long, required = true, value_name = "OUT.npz|OUT.usda")]
    pub output: Vec<PathBuf>,
    /// Which equations move the hair [default: physical, or paper for a field of the paper's forces].
    #[arg(long, value_parser = parse_sim_method, value_name = "physical|paper")]
    pub method: Option<tousle_sim::Method>,
    /// Frames of the result a second.
    #[arg(long, default_value_t = 60.0, value_name = "HZ")]
    pub rate_hz: f64,
    /// How the equations are stepped through time: implicit, implicit-euler, adaptive, semi-implicit, rk4; with
    /// --method paper: exponential, semi-implicit [default: the first].
    #[arg(long, value_parser = parse_integrator, value_name = "NAME")]
    pub integrator: Option<tousle_sim::Integrator>,
    /// The most that a step of the integrator adaptive may be off, mm.
    #[arg(long, default_value_t = 0.1, value_name = "MM")]
    pub tolerance_mm: f64,
    /// Compute in single precision: faster, for hair of usual proportions.
    #[arg(long)]
    pub single: bool,
    /// The longest step, s [default: the method's own].
    #[arg(long, value_name = "S")]
    pub dt_secs: Option<f64>,
    /// The shot's own head motion in place of the capture's: .npz in the capture's world axes with `t` (T), `R`
    /// (T,3,3), `p` (T,3), so that world = R head + p; or an animated transform in .usda: the prim behind the
    /// colon, or the only one that is animated.
    #[arg(long, value_name = "POSES.npz|FILE.usda[:/PRIM]")]
    pub head: Option<String>,
    /// The head's own axes in its USD prim: up and where the nose points [default: up as the stage; nose Z where Y
    /// is up, X where Z is up].
    #[arg(long, value_parser = parse_head_axes, value_name = "UP,NOSE", requires = "head", allow_hyphen_values = true)]
    pub head_axes: Option<tousle_core::HeadAxes>,
    /// The time code of the USD stage that meets the field's first step [default: the stage's first].
    #[arg(long, value_name = "CODE", requires = "head", allow_hyphen_values = true)]
    pub head_start: Option<f64>,
    /// What hair on the shoulders rubs on when the head moves: a surface that goes along with the head, so that it
    /// slides off a shoulder that the head turns away from; or the torso's own, which stays and holds it.
    #[arg(long, value_parser = parse_torso_grip, default_value = "head", value_name = "head|torso")]
    pub torso_grip: tousle_sim::TorsoGrip,
    /// What the wind does outside the field's span.
    #[arg(long, value_parser = parse_time, default_value = "once", value_name = "once|loop|hold")]
    pub time: tousle_sim::TimeMode,
    /// How long the motion lasts, s [default: to the field's last step].
    #[arg(long, value_name = "S")]
    pub duration_secs: Option<f64>,
    /// Simulate only N guides, chosen among the strands; the others follow them. For dense grooms.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub guides: Option<u32>,
    /// Strands that follow and are simulated too, to tell how far off those are that are not; 0 for none.
    #[arg(long, value_name = "N", default_value_t = 200, requires = "guides")]
    pub guides_check: u32,
    /// For long runs: keep what is done in a folder .OUT.resume beside the (first) output, strands after strands. If the
    /// run is stopped, the same command goes on from there and gives the same bytes. N: strands that run before they
    /// are kept [default: some seconds' work].
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true, default_missing_value = "0")]
    pub resume: Option<u32>,
    /// How strands are drawn in a .usda file.
    #[arg(long, value_enum, default_value_t = ShapeArg::Curves, value_name = "SHAPE")]
    pub shape: ShapeArg,
    /// Put what the hair touches into a .usda file too, as guides that renderers leave out.
    #[arg(long)]
    pub with_body: bool,
    /// Say which terms run, and what was left out and why.
    #[arg(long)]
    pub explain: bool,
    /// Print the report as JSON.
    #[arg(long)]
    pub json: bool,
    /// How the groom is read.
    #[command(flatten)]
    pub groom_args: GroomArgs,
    /// What the hair touches.
    #[command(flatten)]
    pub body_args: BodyArgs,
}

/// `--shape`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ShapeArg {
    /// Thin curves.
    Curves,
    /// The paper's reed-shaped polygons, with texture coordinates.
    Reeds,
    /// Both in one file.
    Both,
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
    /// Method physical: a key is met if its point is no farther from it than this, mm.
    #[arg(long, value_parser = parse_above_zero, default_value = "1", value_name = "MM")]
    pub tolerance_mm: f64,
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
    /// Edge of the grid about the head, mm, where the file gives neither `origin` nor `edge`.
    #[arg(long, value_name = "MM")]
    pub extent_mm: Option<f64>,
    /// The grid of a .vdb that is the wind [default: wind, velocity, vel or v, or the only vectors].
    #[arg(long, value_name = "NAME")]
    pub grid: Option<String>,
    /// Time steps a second, where .vdb files do not say when they are.
    #[arg(long, value_name = "HZ")]
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

/// `tousle bench …`
#[derive(Debug, Subcommand)]
pub enum BenchCommand {
    /// The method `paper` on captures with their truth: each reading of E3, scored on another hairstyle.
    Paper(BenchArgs),
    /// The simulator: error against run time of every integrator and step, stiff and extreme cases, cost of each term.
    Sim(BenchSimArgs),
    /// The wind that both methods measure on captures with their truth, with other voxels, rates, markers, noise, gaps.
    Wind(BenchWindArgs),
    /// Drags drawn at random on captures, by E4 and solved for: how near the keys, how smooth, who else moves.
    Direct(BenchDirectArgs),
    /// Fields in files: size and speed of each way to pack them, beside .npz and .vdb.
    File(BenchFileArgs),
}

/// `tousle bench sim`
#[derive(Debug, Args)]
pub struct BenchSimArgs {
    /// A folder of captures, each with its other hairstyle and its truth [default: what needs none].
    #[arg(long, value_name = "DIR")]
    pub captures: Option<PathBuf>,
    /// What hair on the torso rubs on while the head moves, as for `simulate`; for the part `truth`.
    #[arg(long, value_parser = parse_torso_grip, default_value = "head", value_name = "head|torso")]
    pub torso_grip: tousle_sim::TorsoGrip,
    /// Only this part; may be given several times [default: all].
    #[arg(long = "part", value_parser = parse_part, value_name = "truth|converged|order|extremes|terms")]
    pub parts: Vec<tousle_bench::sim::Part>,
    /// The folder for tables, plots and the page (CSV, SVG, HTML) [default: print only].
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

/// `tousle bench wind`
#[derive(Debug, Args)]
pub struct BenchWindArgs {
    /// A folder of captures, each with its session, its other hairstyle and its truth.
    #[arg(long, value_name = "DIR")]
    pub captures: PathBuf,
    /// Only this capture; may be given several times [default: all].
    #[arg(long = "capture", value_name = "NAME")]
    pub names: Vec<String>,
    /// Only both methods as they are by default, and the closed loop.
    #[arg(long)]
    pub quick: bool,
    /// Instead: what would have been chosen for each capture from the others alone.
    #[arg(long, conflicts_with = "quick")]
    pub leave_one_out: bool,
    /// The folder for the table, the plot and the page (CSV, SVG, HTML) [default: print only].
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

/// `tousle bench direct`
#[derive(Debug, Args)]
pub struct BenchDirectArgs {
    /// A folder of captures, each with its session, its other hairstyle and its truth.
    #[arg(long, value_name = "DIR")]
    pub captures: PathBuf,
    /// Only this capture; may be given several times [default: three of them].
    #[arg(long = "capture", value_name = "NAME")]
    pub names: Vec<String>,
    /// Drags a capture.
    #[arg(long, default_value_t = 20, value_name = "N")]
    pub drags: usize,
    /// Where the dice begin.
    #[arg(long, default_value_t = 7, value_name = "N")]
    pub seed: u64,
    /// The folder for the tables (CSV) [default: print only].
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

/// `tousle bench file`
#[derive(Debug, Args)]
pub struct BenchFileArgs {
    /// The fields.
    #[arg(required = true, value_name = "FIELD")]
    pub fields: Vec<PathBuf>,
    /// The folder for the table (CSV) [default: print only].
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

/// `tousle bench paper`
#[derive(Debug, Args)]
pub struct BenchArgs {
    /// A folder of captures, each with its session, its other hairstyle and its truth.
    #[arg(long, value_name = "DIR")]
    pub captures: PathBuf,
    /// The folder for tables (CSV, HTML) [default: print only].
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

fn parse_edit_method(name: &str) -> Result<tousle_direct::EditMethod, String> {
    tousle_direct::EditMethod::from_name(name).ok_or_else(|| "expected physical or paper".to_owned())
}

fn parse_above_zero(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "expected a number above 0".to_owned())
}

fn parse_unit(name: &str) -> Result<tousle_core::LengthUnit, String> {
    tousle_core::LengthUnit::from_name(name).ok_or_else(|| "expected mm, cm, m or in".to_owned())
}

fn parse_up_axis(name: &str) -> Result<tousle_core::UpAxis, String> {
    tousle_core::UpAxis::from_name(name).ok_or_else(|| "expected X, Y or Z".to_owned())
}

fn parse_head_axes(text: &str) -> Result<tousle_core::HeadAxes, String> {
    let expected = || format!("found {text:?}, expected two axes: Y,Z or Z,X or Y,-Z");
    let (up, forward) = text.split_once(',').ok_or_else(expected)?;
    let [up, forward] =
        [up, forward].map(|axis| tousle_groom::Axis::from_name(axis).map(tousle_groom::Axis::vector));
    Ok(tousle_core::HeadAxes { up: up.ok_or_else(expected)?, forward: forward.ok_or_else(expected)? })
}

fn parse_axis(name: &str) -> Result<tousle_groom::Axis, String> {
    tousle_groom::Axis::from_name(name).ok_or_else(|| "expected x, y, z, -x, -y or -z".to_owned())
}

fn parse_torso_grip(name: &str) -> Result<tousle_sim::TorsoGrip, String> {
    tousle_sim::TorsoGrip::from_name(name).ok_or_else(|| "expected head or torso".to_owned())
}

fn parse_time(name: &str) -> Result<tousle_sim::TimeMode, String> {
    tousle_sim::TimeMode::from_name(name).ok_or_else(|| "expected once, loop or hold".to_owned())
}

fn parse_sim_method(name: &str) -> Result<tousle_sim::Method, String> {
    tousle_sim::Method::from_name(name).ok_or_else(|| "expected physical or paper".to_owned())
}

fn parse_part(name: &str) -> Result<tousle_bench::sim::Part, String> {
    let names: Vec<_> = tousle_bench::sim::Part::ALL.iter().map(|part| part.name()).collect();
    tousle_bench::sim::Part::from_name(name).ok_or_else(|| format!("expected one of {}", names.join(", ")))
}

fn parse_integrator(name: &str) -> Result<tousle_sim::Integrator, String> {
    let names: Vec<_> = tousle_sim::Integrator::ALL.iter().map(|i| i.name()).collect();
    tousle_sim::Integrator::from_name(name).ok_or_else(|| format!("expected one of {}", names.join(", ")))
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
