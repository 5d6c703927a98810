//! The window's colors: those of the project's pages in the dark.

use eframe::egui::{Color32, Context, CornerRadius, Stroke, Theme, Visuals};

/// The ground.
pub const PAPER: Color32 = Color32::from_rgb(0x13, 0x15, 0x18);
/// Panels.
pub const CARD: Color32 = Color32::from_rgb(0x1b, 0x1e, 0x22);
/// Text.
pub const INK: Color32 = Color32::from_rgb(0xe9, 0xe6, 0xdf);
/// What matters less.
pub const MUTED: Color32 = Color32::from_rgb(0x9a, 0x9f, 0xa6);
/// Borders.
pub const LINE: Color32 = Color32::from_rgb(0x2d, 0x31, 0x37);
/// What is chosen.
pub const ACCENT: Color32 = Color32::from_rgb(0x5c, 0xc0, 0xc4);
/// Behind what is chosen.
pub const ACCENT_SOFT: Color32 = Color32::from_rgb(0x1f, 0x35, 0x38);
/// Targets and keys.
pub const WARM: Color32 = Color32::from_rgb(0xf0, 0x9a, 0x5b);
/// Errors.
pub const BAD: Color32 = Color32::from_rgb(0xf2, 0x77, 0x70);

/// Dresses the window.
pub fn apply(ctx: &Context) {
    ctx.set_theme(Theme::Dark);
    let mut visuals = Visuals::dark();
    visuals.panel_fill = CARD;
    visuals.window_fill = CARD;
    visuals.extreme_bg_color = PAPER;
    visuals.faint_bg_color = Color32::from_rgb(0x21, 0x25, 0x2a);
    visuals.selection.bg_fill = ACCENT_SOFT;
    visuals.selection.stroke = Stroke::new(1.0, ACCENT);
    visuals.hyperlink_color = ACCENT;
    visuals.window_stroke = Stroke::new(1.0, LINE);
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.fg_stroke = Stroke::new(1.0, INK);
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, LINE);
    let radius = CornerRadius::same(5);
    let fills = [0x24_29_2e, 0x2d_33_39, 0x36_3d_44];
    for (widget, fill) in
        [&mut widgets.inactive, &mut widgets.hovered, &mut widgets.active].into_iter().zip(fills)
    {
        let [_, r, g, b] = u32::to_be_bytes(fill);
        widget.bg_fill = Color32::from_rgb(r, g, b);
        widget.weak_bg_fill = widget.bg_fill;
        widget.bg_stroke = Stroke::NONE;
        widget.fg_stroke = Stroke::new(1.0, INK);
        widget.corner_radius = radius;
    }
    widgets.noninteractive.corner_radius = radius;
    ctx.set_visuals_of(Theme::Dark, visuals);
    ctx.all_styles_mut(|style| {
        style.spacing.item_spacing = [8.0, 6.0].into();
        style.spacing.button_padding = [8.0, 4.0].into();
    });
}
