//! The demo's page, through the crate's public door.

mod scene;
mod unpack;

use scene::{MadeUp, NASTY, made_up};
use tousle_page::{Compared, DemoPage, Figure, FileEntry, HairView, PageError, StageLine, demo_page};
use unpack::Unpacked;

fn page_of(made_up: &MadeUp, title: &str) -> Result<String, PageError> {
    let text = || NASTY.to_owned();
    demo_page(&DemoPage {
        title,
        intro: &[text()],
        source: NASTY,
        capture: &made_up.capture,
        session: &made_up.session,
        field: &made_up.field,
        method: NASTY,
        scene: &made_up.scene,
        hair: &[HairView {
            name: NASTY,
            about: NASTY,
            groom: &made_up.groom,
            motion: &made_up.motion,
            compared: Some(Compared { name: NASTY, motion: &made_up.calm }),
        }],
        figures: &[Figure { label: text(), value: text(), unit: text(), note: text() }],
        stages: &[StageLine { name: text(), text: text(), command: text(), secs: Some(0.5) }],
        folder: NASTY,
        files: &[FileEntry { name: text(), what: text(), bytes: 812 }],
        notes: &[text()],
    })
}

/// A page of a capture and its field alone.
fn bare(made_up: &MadeUp) -> DemoPage<'_> {
    DemoPage {
        title: "bare",
        intro: &[],
        source: "",
        capture: &made_up.capture,
        session: &made_up.session,
        field: &made_up.field,
        method: "paper",
        scene: &made_up.scene,
        hair: &[],
        figures: &[],
        stages: &[],
        folder: "",
        files: &[],
        notes: &[],
    }
}

#[test]
fn the_page_is_well_formed_and_loads_nothing() {
    let html = page_of(&made_up(6, 10), "a page").unwrap();
    unpack::check_nesting(&html).unwrap();
    assert!(html.starts_with("<!doctype html>"));
    assert!(html.contains("default-src 'none'"));
    // The script names the SVG namespace, which no browser fetches; there is no other address.
    for (at, _) in html.match_indices("http") {
        assert!(
            html[at..].starts_with("http-equiv") || html[at..].starts_with("http://www.w3.org/2000/svg"),
            "{}",
            &html[at..(at + 60).min(html.len())]
        );
    }
}

#[test]
fn names_stay_text_wherever_they_come_out() {
    let html = page_of(&made_up(6, 10), NASTY).unwrap();
    assert!(!html.contains("<img"), "a name became markup");
    assert!(html.contains("&lt;/script&gt;&lt;img src=x onerror=alert(1)&gt;&quot;&#39;&amp;"));
    let data = Unpacked::of(&html);
    assert_eq!(data.json["hair"][0]["name"], NASTY);
    assert_eq!(data.json["markers"]["names"][3], NASTY);
}

#[test]
fn the_legend_means_the_flags_of_the_method() {
    let made_up = made_up(6, 10);
    let legend = |method| {
        let page = DemoPage { method, ..bare(&made_up) };
        let html = demo_page(&page).unwrap();
        let legend = html.split("Measured: a marker was in the voxel at that time. ").nth(1).unwrap();
        legend.split(" The arrow").next().unwrap().to_owned()
    };
    assert!(legend("physical").contains("the locks around narrowed down the air there"));
    assert!(legend("paper").contains("from measured voxels around it"));
}

#[test]
fn positions_come_back_within_the_bound_they_state() {
    let made_up = made_up(6, 10);
    let html = page_of(&made_up, "a page").unwrap();
    let data = Unpacked::of(&html);
    let hair = &data.json["hair"][0];
    for (positions, motion) in
        [(&hair["positions"], &made_up.motion), (&hair["compared"]["positions"], &made_up.calm)]
    {
        assert_eq!(positions["step_m"], 5e-5);
        let back = data.positions(positions, &positions["packed"]);
        assert_eq!(back.len(), 3 * motion.positions_m.len());
        let worst = back
            .iter()
            .zip(motion.positions_m.as_flattened())
            .map(|(back, there)| (back.unwrap() - f64::from(*there)).abs())
            .fold(0.0, f64::max);
        assert!(worst <= 2.5001e-5, "{worst}");
    }
}

#[test]
fn markers_come_back_with_their_gaps() {
    let made_up = made_up(6, 10);
    let html = page_of(&made_up, "a page").unwrap();
    let data = Unpacked::of(&html);
    let markers = &data.json["markers"];
    let back = data.positions(markers, &markers["positions"]);
    let tracks: Vec<_> = made_up.capture.strands.iter().flat_map(|s| &s.markers).collect();
    let n_frames = markers["n_frames"].as_u64().unwrap() as usize;
    assert_eq!((n_frames, markers["rate_hz"].as_f64()), (240, Some(60.0)));
    let mut n_gaps = 0;
    for frame in 0..n_frames {
        for (m, track) in tracks.iter().enumerate() {
            let there = track.at(2 * frame);
            n_gaps += usize::from(there.is_none());
            for axis in 0..3 {
                let back = back[(frame * tracks.len() + m) * 3 + axis];
                assert_eq!(back.is_some(), there.is_some());
                assert!(back.zip(there).is_none_or(|(b, t)| (b - t[axis]).abs() <= 2.5001e-5));
            }
        }
    }
    assert!(n_gaps > 500, "{n_gaps}");
}

#[test]
fn the_wind_comes_back_with_its_flags() {
    let made_up = made_up(6, 10);
    let html = page_of(&made_up, "a page").unwrap();
    let data = Unpacked::of(&html);
    let wind = &data.json["wind"];
    let (step, top) = (wind["step"].as_f64().unwrap(), wind["top"].as_f64().unwrap());
    assert!((step - 0.01 * top).abs() < 1e-12 && top > 1.0);
    assert_eq!((wind["n_steps"].as_u64(), wind["rate_hz"].as_f64()), (Some(60), Some(15.0)));
    let (vectors, flags) = (data.integers(&wind["vectors"]), data.integers(&wind["flags"]));
    let n = made_up.field.grid.n_voxels();
    for (k, field) in made_up.field.steps.iter().step_by(2).enumerate() {
        for (i, &u) in field.u.iter().enumerate() {
            let back = f64::from(vectors[k * 3 * n + i]) * step;
            assert!((back - f64::from(u)).abs() <= 0.5 * step + 1e-9);
        }
        for (i, &flag) in field.flags.iter().enumerate() {
            assert_eq!(flags[k * n + i], flag as i16);
        }
    }
}

#[test]
fn a_page_without_hair_or_body_still_shows_the_rest() {
    let mut made_up = made_up(6, 10);
    made_up.session.body.colliders.clear();
    made_up.scene.body.colliders.clear();
    made_up.session.fans.clear();
    let html = demo_page(&bare(&made_up)).unwrap();
    unpack::check_nesting(&html).unwrap();
    let data = Unpacked::of(&html);
    assert_eq!(data.json["span_secs"][1].as_f64(), Some(made_up.field.end_secs()));
    assert!(data.json["body"]["shapes"].as_array().unwrap().is_empty());
}

#[test]
fn the_same_input_gives_the_same_page() {
    let once = page_of(&made_up(6, 10), "a page").unwrap();
    assert!(once == page_of(&made_up(6, 10), "a page").unwrap());
}

#[test]
fn a_page_of_the_demos_size_stays_small() {
    let html = page_of(&made_up(60, 30), "a page").unwrap();
    assert!(html.len() < 6_000_000, "{}", html.len());
}

/// Noise cannot be packed: the page shows it at fewer times and says so.
#[test]
fn a_field_of_noise_does_not_swell_the_page() {
    let mut noisy = made_up(6, 30);
    let mut state = 1_u32;
    for u in noisy.field.steps.iter_mut().flat_map(|s| &mut s.u) {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        *u = (state >> 8) as f32 / (1 << 24) as f32 - 0.5;
    }
    let html = page_of(&noisy, "noise").unwrap();
    assert!(html.len() < 6_000_000, "{}", html.len());
    assert!(html.contains("This page shows the field 3.75 times a second"));
    assert_eq!(Unpacked::of(&html).json["wind"]["n_steps"], 15);
}

#[test]
fn what_does_not_fit_is_refused_with_its_place() {
    let mut broken = made_up(6, 10);
    broken.motion.positions_m[6 * 14 * 3 + 5][1] = f32::NAN;
    let error = page_of(&broken, "a page").unwrap_err();
    assert!(matches!(error, PageError::NotFinite { frame: 3, .. }), "{error}");

    let mut broken = made_up(6, 10);
    broken.calm.positions_m.pop();
    assert!(matches!(page_of(&broken, "a page"), Err(PageError::MotionDoesNotFit { .. })));

    let mut broken = made_up(6, 10);
    broken.motion.times_secs[7] = f64::NAN;
    assert!(matches!(page_of(&broken, "a page"), Err(PageError::BadTimes { frame: 7, .. })));

    let mut broken = made_up(6, 10);
    broken.field.steps[2].u[5] = f32::INFINITY;
    assert!(matches!(page_of(&broken, "a page"), Err(PageError::Field(_))));
}
