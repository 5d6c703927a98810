//! What can be done, and the keys that do it, as in other tools for animators. Menus and the help read the same table.

use crate::gust::Kind;
use eframe::egui::{Context, Key, KeyboardShortcut, Modifiers};

/// Something that can be done from anywhere in the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Plays or stops.
    PlayOrStop,
    /// Shows the next frame.
    NextFrame,
    /// Shows the frame before.
    PreviousFrame,
    /// Shows the first frame.
    ToStart,
    /// Shows the last frame.
    ToEnd,
    /// Sets the first key of the next drag here.
    SetFirstKey,
    /// Brings the chosen strand, or all hair, into the picture.
    Frame,
    /// Brings all into the picture.
    FrameAll,
    /// Looks from the front.
    Front,
    /// Looks from the subject's left.
    Side,
    /// Looks from behind.
    Back,
    /// Changes the wind at some place.
    Add(Kind),
    /// Draws hair as lines or as ribbons.
    HairLook,
    /// Shows or hides arrows.
    Arrows,
    /// Shows or hides the slice.
    Slice,
    /// Takes the last change back.
    Undo,
    /// Does again what was taken back.
    Redo,
    /// Mutes the chosen edit, or lets it be heard.
    Mute,
    /// Deletes the chosen edit.
    Delete,
    /// Nothing is chosen any more; a pending first key is forgotten.
    Deselect,
    /// Writes the field file.
    Save,
    /// Writes it under another name.
    SaveAs,
    /// Writes the motion for other tools.
    ExportMotion,
    /// Opens another field and groom.
    Open,
    /// Lists the shortcuts.
    Help,
}

/// A command and the key that does it.
#[derive(Clone, Copy, Debug)]
pub struct Shortcut {
    /// What it does.
    pub command: Command,
    /// The key.
    pub key: KeyboardShortcut,
    /// What it does, in words.
    pub text: &'static str,
}

const fn plain(command: Command, key: Key, text: &'static str) -> Shortcut {
    Shortcut { command, key: KeyboardShortcut::new(Modifiers::NONE, key), text }
}

const fn ctrl(command: Command, key: Key, text: &'static str) -> Shortcut {
    Shortcut { command, key: KeyboardShortcut::new(Modifiers::COMMAND, key), text }
}

const fn ctrl_shift(command: Command, key: Key, text: &'static str) -> Shortcut {
    let modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);
    Shortcut { command, key: KeyboardShortcut::new(modifiers, key), text }
}

/// All shortcuts, in the order of the help.
pub const SHORTCUTS: [Shortcut; 28] = [
    plain(Command::PlayOrStop, Key::Space, "play or stop"),
    plain(Command::NextFrame, Key::ArrowRight, "next frame"),
    plain(Command::PreviousFrame, Key::ArrowLeft, "frame before"),
    plain(Command::ToStart, Key::Home, "first frame"),
    plain(Command::ToEnd, Key::End, "last frame"),
    plain(Command::SetFirstKey, Key::K, "set the first key of the next drag here"),
    plain(Command::Frame, Key::F, "frame the chosen strand, or all hair"),
    plain(Command::FrameAll, Key::A, "frame all hair"),
    plain(Command::Front, Key::Num1, "look from the front"),
    plain(Command::Side, Key::Num3, "look from the subject's left"),
    plain(Command::Back, Key::Num7, "look from behind"),
    plain(Command::Add(Kind::Gust), Key::G, "add a gust"),
    plain(Command::Add(Kind::Calm), Key::C, "add a calm"),
    plain(Command::Add(Kind::Strength), Key::B, "add a place where the wind is stronger"),
    plain(Command::Add(Kind::Turn), Key::T, "add a place where the wind is turned"),
    plain(Command::HairLook, Key::H, "hair as lines or as ribbons"),
    plain(Command::Arrows, Key::W, "show or hide the wind's arrows"),
    plain(Command::Slice, Key::S, "show or hide the slice"),
    plain(Command::Mute, Key::M, "mute the chosen edit, or let it be heard"),
    plain(Command::Delete, Key::Delete, "delete the chosen edit"),
    plain(Command::Deselect, Key::Escape, "choose nothing"),
    ctrl_shift(Command::Redo, Key::Z, "redo"),
    ctrl(Command::Undo, Key::Z, "undo"),
    ctrl_shift(Command::SaveAs, Key::S, "save as another file"),
    ctrl(Command::Save, Key::S, "save"),
    ctrl(Command::ExportMotion, Key::E, "export the motion"),
    ctrl(Command::Open, Key::O, "open a field and a groom"),
    plain(Command::Help, Key::Questionmark, "list the shortcuts"),
];

/// What the mouse does in the picture, for the help.
pub const MOUSE: [(&str, &str); 8] = [
    ("click", "choose the strand under the pointer"),
    ("drag a control point", "pull it where it should be at this time"),
    ("drag a target", "move it"),
    ("drag a gust's place or the end of its arrow", "move it, or aim it"),
    ("drag beside the hair, Alt+drag, or middle button", "orbit"),
    ("Shift+middle button, or Alt+middle button", "pan"),
    ("wheel, or Alt+right button", "zoom"),
    ("drag on the timeline", "scrub; keys there can be dragged too"),
];

impl Shortcut {
    /// The key, as menus and the help show it.
    pub fn key_text(&self, ctx: &Context) -> String {
        let text = ctx.format_shortcut(&self.key);
        if self.key.logical_key == Key::Questionmark { "?".to_owned() } else { text }
    }
}

/// The key of a command, as a menu shows it.
pub fn key_text(ctx: &Context, command: Command) -> String {
    let found = SHORTCUTS.iter().find(|shortcut| shortcut.command == command);
    found.map(|shortcut| shortcut.key_text(ctx)).unwrap_or_default()
}

/// The commands whose keys were pressed.
///
/// While text is written, keys are text; while another widget has the focus of the keyboard, keys without Ctrl are its
/// own.
pub fn pressed(ctx: &Context) -> Vec<Command> {
    let (writes, focused) = (ctx.text_edit_focused(), ctx.egui_wants_keyboard_input());
    let is_free = |key: &KeyboardShortcut| !(writes || focused && key.modifiers.is_none());
    let free = SHORTCUTS.iter().filter(|shortcut| is_free(&shortcut.key));
    ctx.input_mut(|input| {
        free.filter(|shortcut| {
            // Which modifiers a question mark takes depends on the keyboard.
            if shortcut.command == Command::Help {
                input.key_pressed(shortcut.key.logical_key)
            } else {
                input.consume_shortcut(&shortcut.key)
            }
        })
        .map(|shortcut| shortcut.command)
        .collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_means_two_things() {
        for (k, a) in SHORTCUTS.iter().enumerate() {
            for b in &SHORTCUTS[..k] {
                assert!(a.key != b.key && a.command != b.command, "{:?} and {:?}", a.command, b.command);
            }
        }
    }

    #[test]
    fn the_documentation_lists_them_all() {
        let docs = include_str!("../../../docs/studio.md");
        let ctx = Context::default();
        for shortcut in SHORTCUTS {
            let row = format!("| {} | {} |", shortcut.key_text(&ctx), shortcut.text);
            assert!(docs.contains(&row), "docs/studio.md lacks the row {row}");
        }
        for (what, text) in MOUSE {
            assert!(docs.contains(&format!("| {what} | {text} |")), "docs/studio.md lacks `{what}`");
        }
    }
}
