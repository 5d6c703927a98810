//! Makes the pictures of `docs/studio.md`: `pictures DEMO_FOLDER PICTURE_FOLDER`, from what `tousle demo` wrote.

#[path = "../tests/common/mod.rs"]
mod common;

use anyhow::Context;
use common::Window;
use eframe::egui::{Key, Modifiers, vec2};
use std::path::PathBuf;
use tousle_studio::files::Files;

/// Large enough to be read, small enough for a page.
const SIZE: [f32; 2] = [1200.0, 760.0];

fn main() -> anyhow::Result<()> {
    let mut folders = std::env::args_os().skip(1).map(PathBuf::from);
    let [demo, pictures] = [folders.next(), folders.next()].map(|f| f.context("expected two folders"));
    let (demo, pictures) = (demo?, pictures?);
    std::fs::create_dir_all(&pictures)?;
    let scratch = tempfile::tempdir()?;
    let field = scratch.path().join("gusts.eff.mcap");
    std::fs::copy(demo.join("gusts.eff.mcap"), &field)?;
    let files = Files { field, groom: demo.join("bob.json"), ..Files::default() };

    let mut window = Window::open(&files, SIZE);
    window.studio_mut().player.go(2.0);
    let save = |window: &mut Window, name: &str| {
        // Around the window's content the harness leaves a margin.
        let image = window.image();
        let (width, height) = (image.width() - 2 * MARGIN, image.height() - 2 * MARGIN);
        image::imageops::crop_imm(&image, MARGIN, MARGIN, width, height).to_image().save(pictures.join(name))
    };
    save(&mut window, "studio-open.png")?;

    let studio = window.studio_mut();
    studio.camera.yaw = 0.35;
    studio.chosen_strand = studio.document.groom.strands.iter().position(|strand| strand.name == STRAND);
    window.settle();
    let tip = window.place(&format!("{STRAND} point {POINT}"));
    window.drag(tip, vec2(46.0, -52.0));
    save(&mut window, "studio-pull.png")?;

    window.press(Modifiers::COMMAND, Key::Z);
    window.press(Modifiers::NONE, Key::G);
    window.studio_mut().player.go(2.5);
    save(&mut window, "studio-gust.png")?;
    window.press(Modifiers::COMMAND, Key::Z);

    window.press(Modifiers::NONE, Key::Escape);
    window.press(Modifiers::NONE, Key::S);
    window.studio_mut().camera.yaw = 0.9;
    save(&mut window, "studio-wind.png")?;
    Ok(())
}

const MARGIN: u32 = 8;

/// A lock beside the face, and its tip.
const STRAND: &str = "B59";
const POINT: usize = 15;
