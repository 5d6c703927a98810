//! How long the window's frames take while nothing is simulated and while a lock is pulled about: `frames DEMO_FOLDER`, on what
//! `tousle demo` wrote; `frames DEMO_FOLDER GROOM` with another hairstyle.

#[path = "../tests/common/mod.rs"]
mod common;

use anyhow::Context;
use common::Window;
use eframe::egui::{Key, Modifiers, Pos2, vec2};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tousle_studio::files::Files;

const SIZE: [f32; 2] = [1200.0, 760.0];

/// Each time is looked at for so long.
const LOOK_SECS: f64 = 6.0;

fn main() -> anyhow::Result<()> {
    let mut paths = std::env::args_os().skip(1).map(PathBuf::from);
    let demo = paths.next().context("expected the folder that `tousle demo` wrote")?;
    let scratch = tempfile::tempdir()?;
    let field = scratch.path().join("gusts.eff.mcap");
    std::fs::copy(demo.join("gusts.eff.mcap"), &field)?;
    let groom = paths.next().unwrap_or_else(|| demo.join("bob.json"));
    let mut window = Window::open(&Files { field, groom, ..Files::default() }, SIZE);
    let groom = window.studio().document.groom.clone();
    println!("{} strands, {} control points", groom.strands.len(), groom.n_points());

    let studio = window.studio_mut();
    studio.player.go(2.0);
    let strand = groom.strands.iter().position(|strand| strand.name == "B59").unwrap_or(0);
    studio.chosen_strand = Some(strand);
    window.settle();
    let tip =
        format!("{} point {}", groom.strands[strand].name, groom.strands[strand].rest_curve_m.len() - 1);
    let tip = window.place(&tip);
    look(&mut window, "at rest", |_| tip);
    window.press(Modifiers::NONE, Key::Space);
    look(&mut window, "playing", |_| tip);
    window.press(Modifiers::NONE, Key::Space);
    window.studio_mut().player.go(2.0);
    window.settle();
    window.hold(tip);
    // Out and then about, so that every frame asks for something new.
    let circle = |secs: f64| {
        let (sin, cos) = libm::sincos(secs * 3.0);
        tip + vec2(30.0 + 12.0 * cos as f32, -20.0 + 12.0 * sin as f32)
    };
    look(&mut window, "pulling", circle);
    Ok(())
}

/// Draws frames for a while and says what they took, and how many motions came meanwhile.
fn look(window: &mut Window, what: &str, pointer: impl Fn(f64) -> Pos2) {
    let start = Instant::now();
    let (mut took, mut n_motions) = (Vec::new(), 0);
    let mut motion = window.studio().motion().cloned();
    while start.elapsed().as_secs_f64() < LOOK_SECS {
        took.push(window.frame(pointer(start.elapsed().as_secs_f64())));
        let now = window.studio().motion().cloned();
        n_motions += usize::from(now.as_ref().map(Arc::as_ptr) != motion.as_ref().map(Arc::as_ptr));
        motion = now;
    }
    took.sort_unstable();
    let ms = |share: f64| {
        let at = ((took.len() - 1) as f64 * share) as usize;
        took.get(at).map_or(0.0, Duration::as_secs_f64) * 1e3
    };
    println!(
        "{what}: {} frames in {LOOK_SECS:.0} s, median {:.1} ms, 95 in 100 within {:.1} ms, the longest {:.1} ms; {n_motions} motions",
        took.len(),
        ms(0.5),
        ms(0.95),
        ms(1.0)
    );
}
