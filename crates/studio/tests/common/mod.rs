//! A small made-up world on the disk, and the studio on it without a display.

#![allow(clippy::unwrap_used, dead_code, reason = "a test may panic; not every one needs all of this")]

use eframe::egui;
use eframe::egui_wgpu::RendererOptions;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use egui_kittest::wgpu::{WgpuTestRenderer, create_render_state, default_wgpu_setup};
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::time::{Duration, Instant};
use tempfile::TempDir;
use tousle_core::{Attachment, Body, Collider, NoProgress, Pose, PoseTrack, Quantity, Shape, Vec3};
use tousle_eff::{Eff, WriteOptions};
use tousle_field::{Field, FieldSequence, GridSpec, Scene, VoxelFlag};
use tousle_studio::Studio;
use tousle_studio::files::{Files, open};

/// A folder with a field and a groom.
pub struct World {
    /// The folder; it goes with the world.
    pub folder: TempDir,
    /// The two files.
    pub files: Files,
}

/// A head with two dozen locks, a second and a half of wind from the front that grows and turns.
pub fn world() -> World {
    let folder = tempfile::tempdir().unwrap();
    let [field, groom] = ["wind.eff.mcap", "locks.json"].map(|name| folder.path().join(name));
    let mut out = BufWriter::new(File::create(&field).unwrap());
    tousle_eff::write(&eff(), &mut out, &WriteOptions::default(), &NoProgress).unwrap();
    out.into_inner().unwrap();
    std::fs::write(&groom, groom_json()).unwrap();
    World { folder, files: Files { field, groom, ..Files::default() } }
}

fn eff() -> Eff {
    let grid = GridSpec::cube(0.6, 0.1).unwrap();
    let step = |k: u32| {
        let t = f64::from(k) / 30.0;
        let wind = Vec3::new(-1.2, 0.8 * t - 0.4, 0.0);
        let mut step = Field { outside: wind, ..Field::still(&grid) };
        for flat in 0..grid.n_voxels() {
            step.set_vector(flat, wind);
            if flat % 5 < 2 {
                step.flags[flat] = if flat % 5 == 0 { VoxelFlag::Measured } else { VoxelFlag::Interpolated };
            }
        }
        step
    };
    let field = FieldSequence {
        grid,
        quantity: Quantity::AirVelocity,
        start_secs: 0.0,
        rate_hz: 30.0,
        steps: (0..46).map(step).collect(),
        layers: Vec::new(),
    };
    let head = Shape::Ellipsoid { center_m: Vec3::zeros(), half_axes_m: Vec3::new(0.095, 0.075, 0.115) };
    let neck =
        Shape::Capsule { a_m: Vec3::new(-0.01, 0.0, -0.1), b_m: Vec3::new(-0.03, 0.0, -0.2), radius_m: 0.05 };
    let collider = |name: &str, shape, attachment| Collider { name: name.into(), shape, attachment };
    let scene = Scene {
        poses: PoseTrack::still(Pose::identity()),
        rest_pose: Pose::identity(),
        gravity_world: -9.81 * Vec3::z(),
        air_density: 1.2,
        body: Body {
            colliders: vec![
                collider("head", head, Attachment::Head),
                collider("neck", neck, Attachment::Torso),
            ],
            pivot_m: Vec3::new(-0.02, 0.0, -0.1),
            friction: 0.2,
        },
    };
    Eff {
        name: "made up".into(),
        method: "by hand".into(),
        generator: "test".into(),
        field,
        scene,
        samples: None,
        attachments: Vec::new(),
    }
}

/// Locks that hang from a ring about the head, 3 cm outside it, so that they never touch it.
fn groom_json() -> String {
    let lock = |k: u32| {
        let (sin, cos) = libm::sincos(f64::from(k) * std::f64::consts::TAU / 24.0);
        let points =
            (0..9).map(|j| format!("[{}, {}, {}]", 0.13 * cos, 0.11 * sin, 0.06 - 0.02 * f64::from(j)));
        format!(
            "{{\"name\": \"L{k:02}\", \"length_m\": 0.16, \"linear_density_kg_per_m\": 0.0015, \
             \"lock_width_m\": 0.009, \"bending_stiffness_N_m2\": 4e-6, \"internal_damping_time_s\": 0.02, \
             \"rest_curve_m\": [{}]}}",
            points.collect::<Vec<_>>().join(", ")
        )
    };
    format!("{{\"strands\": [{}]}}", (0..24).map(lock).collect::<Vec<_>>().join(", "))
}

/// The studio on some files, in a window of this size that nobody sees.
pub struct Window {
    harness: Harness<'static, Option<Studio>>,
}

impl Window {
    /// Opens it and waits until the first motion is there.
    pub fn open(files: &Files, size: [f32; 2]) -> Self {
        let state = create_render_state(default_wgpu_setup(), RendererOptions::PREDICTABLE);
        let renderer = WgpuTestRenderer::from_render_state(state.clone());
        let mut opened = Some((open(files).unwrap(), files.clone()));
        let harness = Harness::builder()
            .with_size(size)
            .with_render_cursor(false)
            .with_step_dt(1.0 / 60.0)
            .renderer(renderer)
            .build_ui_state(
                move |ui, studio: &mut Option<Studio>| {
                    if let Some((opened, files)) = opened.take() {
                        *studio = Some(Studio::new(opened, files, &state, ui.ctx()));
                    }
                    studio.as_mut().unwrap().show(ui);
                },
                None,
            );
        let mut window = Self { harness };
        window.settle();
        window
    }

    /// The editor.
    pub fn studio(&self) -> &Studio {
        self.harness.state().as_ref().unwrap()
    }

    /// The editor, to be set up.
    pub fn studio_mut(&mut self) -> &mut Studio {
        self.harness.state_mut().as_mut().unwrap()
    }

    /// Runs frames until no simulation is awaited.
    pub fn settle(&mut self) {
        let end = Instant::now() + Duration::from_secs(120);
        self.harness.run_steps(3);
        while self.studio().is_busy() {
            assert!(Instant::now() < end, "no answer in two minutes");
            std::thread::sleep(Duration::from_millis(5));
            self.harness.run_steps(2);
        }
        self.harness.run_steps(3);
    }

    /// Whether there is a widget of this name.
    pub fn has(&self, name: &str) -> bool {
        self.harness.query_by_label(name).is_some()
    }

    /// The place of the widget of this name.
    pub fn place(&self, name: &str) -> egui::Pos2 {
        self.harness.get_by_label(name).rect().center()
    }

    /// Clicks on the widget of this name.
    pub fn click(&mut self, name: &str) {
        self.harness.get_by_label(name).click();
        self.settle();
    }

    /// Clicks on a place.
    pub fn click_at(&mut self, at: egui::Pos2) {
        self.harness.hover_at(at);
        self.harness.drag_at(at);
        self.harness.drop_at(at);
        self.settle();
    }

    /// Drags from a place by so much, in some steps.
    pub fn drag(&mut self, from: egui::Pos2, by: egui::Vec2) {
        self.harness.hover_at(from);
        self.harness.run_steps(1);
        self.harness.drag_at(from);
        self.harness.run_steps(1);
        for k in 1..=4 {
            self.harness.hover_at(from + by * (k as f32 / 4.0));
            self.harness.run_steps(2);
        }
        self.harness.drop_at(from + by);
        self.settle();
    }

    /// Puts the button down on a place, and leaves it there.
    pub fn hold(&mut self, at: egui::Pos2) {
        self.harness.hover_at(at);
        self.harness.run_steps(1);
        self.harness.drag_at(at);
        self.harness.run_steps(1);
    }

    /// One frame, drawn, with the pointer at a place. Out: how long it took.
    pub fn frame(&mut self, pointer: egui::Pos2) -> Duration {
        let start = Instant::now();
        self.harness.hover_at(pointer);
        self.harness.run_steps(1);
        self.harness.render().unwrap();
        start.elapsed()
    }

    /// Presses a key.
    pub fn press(&mut self, modifiers: egui::Modifiers, key: egui::Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.settle();
    }

    /// Writes over the text of the field of this name.
    pub fn write(&mut self, name: &str, text: &str) {
        self.harness.get_by_label(name).click();
        self.settle();
        self.press(egui::Modifiers::COMMAND, egui::Key::A);
        self.harness.get_by_label(name).type_text(text);
        self.settle();
    }

    /// What is seen.
    pub fn image(&mut self) -> image::RgbaImage {
        self.harness.remove_cursor();
        self.settle();
        self.harness.render().unwrap()
    }
}

/// The layers in a field file.
pub fn layers_in(path: &Path) -> Vec<tousle_field::FieldLayer> {
    let file = File::open(path).unwrap();
    tousle_eff::read(file, &tousle_eff::ReadOptions::default()).unwrap().field.layers
}
