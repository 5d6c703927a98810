//! The editor's window: `tousle-studio FIELD --groom GROOM`, which `tousle studio` runs too.

#![warn(clippy::print_stdout, clippy::print_stderr, reason = "they panic where nobody listens")]

use anyhow::{anyhow, bail};
use clap::Parser;
use eframe::egui::ViewportBuilder;
use eframe::egui_wgpu::{WgpuError, WgpuSetup};
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use tousle_core::Axis;
use tousle_groom::GroomOptions;
use tousle_studio::Studio;
use tousle_studio::files::{Files, Opened, open};

/// Edits a wind field by pulling hair.
#[derive(Debug, Parser)]
#[command(name = "tousle studio", version)]
struct Args {
    /// The field.
    field: PathBuf,
    /// The hairstyle in which strands are pulled.
    #[arg(long)]
    groom: PathBuf,
    /// The unit of the groom's positions, where its file names none.
    #[arg(long, value_parser = parse_unit, value_name = "mm|cm|m|in")]
    groom_unit: Option<tousle_core::LengthUnit>,
    /// The groom's up axis, where its file names none.
    #[arg(long, value_parser = parse_axis, value_name = "AXIS", allow_hyphen_values = true)]
    groom_up: Option<Axis>,
    /// The groom's axis along which the nose points [default: x where z is up, z where y is up].
    #[arg(long, value_parser = parse_axis, value_name = "AXIS", allow_hyphen_values = true)]
    groom_forward: Option<Axis>,
    /// Scale and shift the groom so that its roots lie on the field's head.
    #[arg(long)]
    fit_to_head: bool,
}

fn main() -> ExitCode {
    match run(Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Where nobody listens the exit code says it alone.
            let _ = say(&error, io::stderr());
            ExitCode::FAILURE
        }
    }
}

/// What failed and, line by line, why.
fn say(error: &anyhow::Error, mut out: impl Write) -> io::Result<()> {
    writeln!(out, "error: {error}")?;
    error.chain().skip(1).try_for_each(|cause| writeln!(out, "  because {cause}"))
}

fn run(args: Args) -> anyhow::Result<()> {
    let files = files(args);
    let opened = open(&files)?;
    window(files, opened)
}

fn files(args: Args) -> Files {
    let mut groom_options = GroomOptions::default();
    groom_options.unit = args.groom_unit;
    groom_options.up_axis = args.groom_up;
    groom_options.forward = args.groom_forward;
    Files { field: args.field, groom: args.groom, groom_options, fit_to_head: args.fit_to_head }
}

fn window(files: Files, opened: Opened) -> anyhow::Result<()> {
    let mut options = eframe::NativeOptions {
        viewport: ViewportBuilder::default()
            .with_title("tousle studio")
            .with_inner_size([1360.0, 860.0])
            .with_min_inner_size([800.0, 560.0]),
        ..eframe::NativeOptions::default()
    };
    // The picture's numbers lie in storage buffers, which the fourth, OpenGL, need not have.
    if let WgpuSetup::CreateNew(setup) = &mut options.wgpu_options.wgpu_setup {
        setup.instance_descriptor.backends = wgpu::Backends::PRIMARY;
    }
    let create: eframe::AppCreator<'_> = Box::new(|context| {
        let state = context.wgpu_render_state.as_ref().ok_or("egui draws without wgpu")?;
        Ok(Box::new(Studio::new(opened, files, state, &context.egui_ctx)))
    });
    eframe::run_native("tousle studio", options, create).map_err(|error| in_words(&error))
}

/// What a person can do about a window that does not open.
fn in_words(error: &eframe::Error) -> anyhow::Error {
    let advice = match error {
        eframe::Error::Wgpu(WgpuError::RequestAdapterError(_) | WgpuError::CreateSurfaceError(_)) => {
            "no graphics card with Vulkan, Metal or Direct3D 12 was found; without one, Mesa's software Vulkan will do \
             (Debian and Ubuntu: apt install mesa-vulkan-drivers)"
        }
        eframe::Error::Winit(_) | eframe::Error::WinitEventLoop(_) => {
            "no display was found: run it on a desktop, or under `xvfb-run`; `tousle edit` edits without a window"
        }
        _ => "the window could not be opened",
    };
    anyhow!(error.to_string()).context(advice)
}

fn parse_unit(name: &str) -> anyhow::Result<tousle_core::LengthUnit> {
    tousle_core::LengthUnit::from_name(name).ok_or_else(|| anyhow!("expected mm, cm, m or in"))
}

fn parse_axis(name: &str) -> anyhow::Result<Axis> {
    let Some(axis) = Axis::from_name(name) else { bail!("expected x, y, z, -x, -y or -z") };
    Ok(axis)
}
