//! Writes the demo's page for a made-up session: something to look at while working on the page.
//!
//! ```text
//! cargo run -p tousle-page --example synthetic_page -- page.html
//! ```

#[path = "../tests/scene/mod.rs"]
mod scene;

use std::error::Error;
use tousle_page::{Compared, DemoPage, Figure, FileEntry, HairView, StageLine, demo_page};

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("usage: synthetic_page PAGE.html")?;
    let made_up = scene::made_up(64, 30);
    let intro = [
        "A head in a gust that nobody measured: everything on this page is made up by formulas, to try the page."
            .to_owned(),
        "Drag to look around. All that moves on this page follows the bar below.".to_owned(),
    ];
    let figures =
        [figure("strands", "64", ""), figure("peak wind", "3.0", "m/s"), figure("measured", "0", "voxels")];
    let stages = [StageLine {
        name: "make up".into(),
        text: "a head, hair, wind".into(),
        command: "cargo run -p tousle-page --example synthetic_page".into(),
        secs: None,
    }];
    let files = [FileEntry { name: "page.html".into(), what: "this page".into(), bytes: 2_000_000 }];
    let page = DemoPage {
        title: "Hair that sways by a formula",
        intro: &intro,
        source: "No capture: a made-up session.",
        capture: &made_up.capture,
        session: &made_up.session,
        field: &made_up.field,
        method: "by hand",
        scene: &made_up.scene,
        hair: &[HairView {
            name: "made-up hair",
            about: "64 locks that sway by a formula",
            groom: &made_up.groom,
            motion: &made_up.motion,
            compared: Some(Compared { name: "calmer", motion: &made_up.calm }),
        }],
        figures: &figures,
        stages: &stages,
        folder: ".",
        files: &files,
        notes: &[],
    };
    let html = demo_page(&page)?;
    println!("{path}: {} bytes", html.len());
    std::fs::write(path, html)?;
    Ok(())
}

fn figure(label: &str, value: &str, unit: &str) -> Figure {
    Figure { label: label.into(), value: value.into(), unit: unit.into(), note: String::new() }
}
