//! `tousle bench`: what is measured, on what, and where the tables go.

use super::values::{parse_part, parse_torso_grip};
use clap::{Args, Subcommand};
use std::path::PathBuf;

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
    /// Drags a capture with one key.
    #[arg(long, default_value_t = 20, value_name = "N")]
    pub drags: usize,
    /// Drags a capture with several keys: so many of one strand in time, of two strands at once, and of two neighbors.
    #[arg(long, default_value_t = 10, value_name = "N")]
    pub several: usize,
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
