//! What is edited: a field's stack of edits, with undo and whether it was saved. Knows no window and no disk.

use crate::edits::{self, StackedEdit};
use crate::history::History;
use std::path::PathBuf;
use std::sync::Arc;
use tousle_core::Groom;
use tousle_edit::EditError;
use tousle_field::{FieldLayer, FieldSequence, Scene};

/// A field, the groom it is edited in, and the stack of edits.
#[derive(Clone, Debug)]
pub struct Document {
    /// The field without its layers; these are the stack.
    pub field: Arc<FieldSequence>,
    /// What the field blows around.
    pub scene: Arc<Scene>,
    /// The hairstyle in which strands are pulled.
    pub groom: Arc<Groom>,
    /// Where all this came from.
    pub source: Source,
    stack: History<Vec<FieldLayer>>,
    saved: Option<u64>,
}

/// Where a document came from, and where it goes when it is saved.
#[derive(Clone, Debug, Default)]
pub struct Source {
    /// The field file.
    pub field_path: PathBuf,
    /// The groom file.
    pub groom_path: PathBuf,
    /// The number of each strand in it, from 0: those that cannot be simulated are left out.
    pub strand_numbers: Vec<usize>,
    /// The field file's bytes: its packed voxels are copied when it is saved, never packed anew.
    pub packed: Arc<[u8]>,
}

impl Document {
    /// A document of a field as it was read.
    pub fn new(mut field: FieldSequence, scene: Scene, groom: Groom, source: Source) -> Self {
        let layers = std::mem::take(&mut field.layers);
        Self {
            field: Arc::new(field),
            scene: Arc::new(scene),
            groom: Arc::new(groom),
            source,
            stack: History::new(layers),
            saved: Some(0),
        }
    }

    /// The layers, bottom first.
    pub fn stack(&self) -> &[FieldLayer] {
        self.stack.present()
    }

    /// Which state of the stack this is; the same number means the same stack.
    pub fn revision(&self) -> u64 {
        self.stack.id()
    }

    /// The edit with an id.
    pub fn edit(&self, id: &str) -> Option<StackedEdit> {
        edits::edit(self.stack(), id)
    }

    /// A new state of the stack, which undo takes back under this label.
    pub fn commit(&mut self, label: impl Into<String>, stack: Vec<FieldLayer>) {
        if stack != *self.stack.present() {
            self.stack.commit(label, stack);
        }
    }

    /// Mutes an edit, or lets it be heard again.
    ///
    /// # Errors
    /// [`EditError::NoLayer`] if no edit has this id.
    pub fn mute(&mut self, id: &str, muted: bool) -> Result<(), EditError> {
        let stack = tousle_edit::mute(self.stack(), id, muted)?;
        self.commit(if muted { "mute" } else { "unmute" }, stack);
        Ok(())
    }

    /// Gives an edit another name.
    ///
    /// # Errors
    /// [`EditError::NoLayer`] if no edit has this id.
    pub fn rename(&mut self, id: &str, name: &str) -> Result<(), EditError> {
        let stack = tousle_edit::rename(self.stack(), id, name)?;
        self.commit("rename", stack);
        Ok(())
    }

    /// Takes an edit out.
    ///
    /// # Errors
    /// [`EditError::NoLayer`] if no edit has this id.
    pub fn delete(&mut self, id: &str) -> Result<(), EditError> {
        let stack = tousle_edit::remove(self.stack(), id)?;
        self.commit("delete", stack);
        Ok(())
    }

    /// Takes the last change back; `false` if there is none.
    pub fn undo(&mut self) -> bool {
        self.stack.undo()
    }

    /// Does again what was taken back; `false` if there is nothing.
    pub fn redo(&mut self) -> bool {
        self.stack.redo()
    }

    /// What undo would take back.
    pub fn undo_label(&self) -> Option<&str> {
        self.stack.undo_label()
    }

    /// What redo would do again.
    pub fn redo_label(&self) -> Option<&str> {
        self.stack.redo_label()
    }

    /// Whether the stack differs from what is on the disk.
    pub fn is_dirty(&self) -> bool {
        self.saved != Some(self.stack.id())
    }

    /// The stack as it is now is on the disk.
    pub fn mark_saved(&mut self) {
        self.saved = Some(self.stack.id());
    }

    /// A stack that was not saved when the studio last ended takes the place of the one in the file.
    pub fn restore(&mut self, stack: Vec<FieldLayer>) {
        self.commit("restore unsaved edits", stack);
    }
}

#[cfg(test)]
mod tests {
    use crate::testing;

    #[test]
    fn the_stack_is_changed_and_changed_back() {
        let mut document = testing::document();
        assert!(!document.is_dirty() && document.undo_label().is_none());
        document.commit("drag A", vec![testing::layer("lift")]);
        assert!(document.is_dirty());
        document.mark_saved();
        document.mute("lift", true).unwrap();
        document.rename("lift", "Lift the fringe").unwrap();
        assert_eq!(document.edit("lift").unwrap().name, "Lift the fringe");
        assert!(document.undo() && document.undo());
        assert!(!document.is_dirty() && !document.stack()[0].muted);
        assert_eq!(document.redo_label(), Some("mute"));
        document.delete("lift").unwrap();
        assert!(document.stack().is_empty() && document.redo_label().is_none());
        assert!(document.delete("lift").is_err());
    }

    #[test]
    fn a_change_that_changes_nothing_is_none() {
        let mut document = testing::document();
        document.commit("nothing", Vec::new());
        assert!(!document.is_dirty() && document.undo_label().is_none());
    }
}
