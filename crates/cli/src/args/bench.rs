//! `tousle bench`: what is measured, on what, and where the tables go.

use super::values::{parse_part, parse_torso_grip};
use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;

/// `tousle bench …`
#[derive(Debug, Args)]
pub struct BenchArgs {
    /// What is measured [default: all].
    #[command(subcommand)]
    pub part: Option<BenchCommand>,
    /// All of it.
    #[command(flatten)]
    pub all: BenchAllArgs,
}

/// A part of the bench, or all.
#[derive(Debug, Subcommand)]
pub enum BenchCommand {
    /// Every part that can be run with what is given, one after another, and one page over them [what is done by default].
    All(BenchAllArgs),
    /// The method `paper` on captures with their truth: each reading of E3, scored on another hairstyle.
    Paper(BenchPaperArgs),
    /// The simulator: error against run time of every integrator and step, stiff and extreme cases, cost of each term.
    Sim(BenchSimArgs),
    /// The wind that both methods measure on captures with their truth, with other voxels, rates, markers, noise, gaps, no rest.
    Wind(BenchWindArgs),
    /// Drags drawn at random on captures, by E4 and solved for: how near the keys, how smooth, who else moves.
    Direct(BenchDirectArgs),
    /// Fields in files: size and speed of each way to pack them, beside .npz and .vdb.
    File(BenchFileArgs),
}

/// `tousle bench`, `tousle bench all`
#[derive(Debug, Default, PartialEq, Args)]
pub struct BenchAllArgs {
    /// A folder of captures, each with its session, its other hairstyle and its truth [default: only what needs none].
    #[arg(long, value_name = "DIR")]
    pub captures: Option<PathBuf>,
    /// Only this capture; may be given several times [default: all; for `direct` three of them].
    #[arg(long = "capture", value_name = "NAME", requires = "captures")]
    pub names: Vec<String>,
    /// A field for the part `file`; may be given several times [default: the demo's].
    #[arg(long = "field", value_name = "FIELD")]
    pub fields: Vec<PathBuf>,
    /// Only this part; may be given several times [default: all].
    #[arg(long = "part", value_enum, value_name = "PART")]
    pub parts: Vec<BenchPart>,
    /// Of the part `wind` only both methods as they are by default, and the closed loop.
    #[arg(long, requires = "captures")]
    pub quick: bool,
    /// The folder for tables, plots and pages (CSV, SVG, HTML) [default: tousle-bench].
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

/// The parts of the bench, in the order in which they are run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum BenchPart {
    /// `tousle bench file`
    File,
    /// `tousle bench paper`
    Paper,
    /// `tousle bench wind`
    Wind,
    /// `tousle bench direct`
    Direct,
    /// `tousle bench sim`
    Sim,
}

impl BenchPart {
    /// The name used on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::File => "file",
            Self::Paper => "paper",
            Self::Wind => "wind",
            Self::Direct => "direct",
            Self::Sim => "sim",
        }
    }

    /// Whether nothing of it can be run without captures.
    pub fn needs_captures(self) -> bool {
        matches!(self, Self::Paper | Self::Wind | Self::Direct)
    }
}

/// `tousle bench sim`
#[derive(Debug, Args)]
pub struct BenchSimArgs {
    /// A folder of captures, each with its other hairstyle and its truth [default: what needs none].
    #[arg(long, value_name = "DIR")]
    pub captures: Option<PathBuf>,
    /// Only this capture; may be given several times [default: all].
    #[arg(long = "capture", value_name = "NAME", requires = "captures")]
    pub names: Vec<String>,
    /// What hair on the torso rubs on while the head moves, as for `simulate`; for the part `truth` [default: head].
    #[arg(long, value_parser = parse_torso_grip, value_name = "head|torso")]
    pub torso_grip: Option<tousle_sim::TorsoGrip>,
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
    /// The folder for tables, plots and the page (CSV, SVG, HTML) [default: print only].
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
    /// Drags a capture with one key.
    #[arg(long, default_value_t = 20, value_name = "N")]
    pub drags: usize,
    /// Drags a capture with several keys: so many of one strand in time, of two strands at once, and of two neighbors.
    #[arg(long, default_value_t = 10, value_name = "N")]
    pub several: usize,
    /// Where the dice begin.
    #[arg(long, default_value_t = 7, value_name = "N")]
    pub seed: u64,
    /// The folder for the tables and the page (CSV, HTML) [default: print only].
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

/// `tousle bench file`
#[derive(Debug, Args)]
pub struct BenchFileArgs {
    /// The fields.
    #[arg(required = true, value_name = "FIELD")]
    pub fields: Vec<PathBuf>,
    /// The folder for the table and the page (CSV, HTML) [default: print only].
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

/// `tousle bench paper`
#[derive(Debug, Args)]
pub struct BenchPaperArgs {
    /// A folder of captures, each with its session, its other hairstyle and its truth.
    #[arg(long, value_name = "DIR")]
    pub captures: PathBuf,
    /// Only this capture; may be given several times [default: all].
    #[arg(long = "capture", value_name = "NAME")]
    pub names: Vec<String>,
    /// The folder for tables and the page (CSV, JSON, HTML) [default: print only].
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}
