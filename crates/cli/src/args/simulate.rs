//! `tousle simulate`: the hair, the shot, the equations, and what is written.

use super::GroomArgs;
use super::values::{
    parse_axis, parse_finite, parse_head_axes, parse_integrator, parse_sim_method, parse_time,
    parse_torso_grip, parse_unit,
};
use clap::{ArgGroup, Args, ValueEnum};
use std::path::PathBuf;

/// The shot's own body.
#[derive(Clone, Debug, Args)]
#[command(group = ArgGroup::new("mesh").multiple(true))]
pub struct BodyArgs {
    /// A closed triangle mesh of the shot's own head, in place of the field's shapes that move with the head. Its origin
    /// is the head's center.
    #[arg(long, value_name = "HEAD.obj", group = "mesh", requires_all = ["mesh_unit", "mesh_up"])]
    pub head_mesh: Option<PathBuf>,
    /// The same for what stays with the torso, placed as it is while the head is at rest.
    #[arg(long, value_name = "TORSO.obj", group = "mesh", requires_all = ["mesh_unit", "mesh_up"])]
    pub torso_mesh: Option<PathBuf>,
    /// The unit of the meshes' positions; no OBJ file states it.
    #[arg(long, requires = "mesh", value_parser = parse_unit, value_name = "mm|cm|m|in")]
    pub mesh_unit: Option<tousle_core::LengthUnit>,
    /// The meshes' up axis: x, y or z, with a minus sign where that axis points down.
    #[arg(long, requires = "mesh", value_parser = parse_axis, value_name = "AXIS", allow_hyphen_values = true)]
    pub mesh_up: Option<tousle_core::Axis>,
    /// The meshes' axis along which the nose points [default: x where z is up, z where y is up].
    #[arg(long, requires = "mesh", value_parser = parse_axis, value_name = "AXIS", allow_hyphen_values = true)]
    pub mesh_forward: Option<tousle_core::Axis>,
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
    /// With --integrator adaptive, the most that a step may be off, mm, 0.0001 or more [default: 0.1].
    #[arg(long, value_name = "MM")]
    pub tolerance_mm: Option<f64>,
    /// Compute in single precision: faster, for hair of usual proportions and steps of 1/480 s or longer. With
    /// method physical, for the integrators implicit and implicit-euler.
    #[arg(long)]
    pub single: bool,
    /// The longest step, s [default: the method's own].
    #[arg(long, value_name = "S")]
    pub dt_secs: Option<f64>,
    /// The shot's own head motion in place of the capture's: .npz in the capture's world axes with `t` (T), `R`
    /// (T,3,3), `p` (T,3), so that world = R head + p, at even times; or an animated transform in .usda: the prim behind the
    /// colon, or the only one that is animated.
    #[arg(long, value_name = "POSES.npz|FILE.usda[:/PRIM]")]
    pub head: Option<PathBuf>,
    /// The head's own axes in its USD prim: up and where the nose points [default: up as the stage; nose Z where Y
    /// is up, X where Z is up].
    #[arg(long, value_parser = parse_head_axes, value_name = "UP,NOSE", requires = "head", allow_hyphen_values = true)]
    pub head_axes: Option<tousle_core::HeadAxes>,
    /// The time code of the USD stage that meets the field's first step [default: the stage's first].
    #[arg(long, value_parser = parse_finite, value_name = "CODE", requires = "head", allow_hyphen_values = true)]
    pub head_start: Option<f64>,
    /// What hair on the shoulders rubs on when the head moves: a surface that goes along with the head, so that it
    /// slides off a shoulder that the head turns away from; or the torso's own, which stays and holds it.
    #[arg(long, value_parser = parse_torso_grip, default_value = "head", value_name = "head|torso")]
    pub torso_grip: tousle_sim::TorsoGrip,
    /// What the wind does outside the field's span: `once`, the air is still before and after it; `loop`, the field and the
    /// capture's head motion begin again; `hold`, the last step's wind blows on.
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
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true, value_parser = clap::value_parser!(u32).range(1..))]
    pub resume: Option<Option<u32>>,
    /// How strands are drawn in a .usda output [default: curves].
    #[arg(long, value_enum, value_name = "SHAPE")]
    pub shape: Option<ShapeArg>,
    /// Put what the hair touches into a .usda output too, as guides that renderers leave out.
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
