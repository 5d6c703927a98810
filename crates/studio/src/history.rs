//! Undo and redo over values.

/// A value with all its former states, and those that were undone.
#[derive(Clone, Debug)]
pub struct History<T> {
    past: Vec<Step<T>>,
    present: Step<T>,
    future: Vec<Step<T>>,
    n_made: u64,
}

/// A state, and what was done to come to it.
#[derive(Clone, Debug)]
struct Step<T> {
    value: T,
    /// What an undo of it takes back: `drag B07`.
    label: String,
    /// Unlike that of any other state of this history.
    id: u64,
}

impl<T> History<T> {
    /// A history that begins with a value.
    pub fn new(value: T) -> Self {
        let present = Step { value, label: String::new(), id: 0 };
        Self { past: Vec::new(), present, future: Vec::new(), n_made: 0 }
    }

    /// The value as it is now.
    pub fn present(&self) -> &T {
        &self.present.value
    }

    /// Which state is the present one; the same number means the same value.
    pub fn id(&self) -> u64 {
        self.present.id
    }

    /// A new state; what was undone is forgotten.
    pub fn commit(&mut self, label: impl Into<String>, value: T) {
        self.n_made += 1;
        let next = Step { value, label: label.into(), id: self.n_made };
        self.past.push(std::mem::replace(&mut self.present, next));
        self.future.clear();
    }

    /// What [`History::undo`] would take back; `None` at the beginning.
    pub fn undo_label(&self) -> Option<&str> {
        (!self.past.is_empty()).then_some(self.present.label.as_str())
    }

    /// What [`History::redo`] would do again; `None` at the end.
    pub fn redo_label(&self) -> Option<&str> {
        self.future.last().map(|step| step.label.as_str())
    }

    /// Goes back by one state; `false` at the beginning.
    pub fn undo(&mut self) -> bool {
        let Some(before) = self.past.pop() else { return false };
        self.future.push(std::mem::replace(&mut self.present, before));
        true
    }

    /// Goes forward by one state; `false` at the end.
    pub fn redo(&mut self) -> bool {
        let Some(after) = self.future.pop() else { return false };
        self.past.push(std::mem::replace(&mut self.present, after));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn undo_and_redo_walk_the_states() {
        let mut history = History::new(0);
        history.commit("one", 1);
        history.commit("two", 2);
        assert_eq!((history.undo_label(), history.redo_label()), (Some("two"), None));
        let id = history.id();
        assert!(history.undo() && *history.present() == 1);
        assert_eq!((history.undo_label(), history.redo_label()), (Some("one"), Some("two")));
        assert!(history.redo() && *history.present() == 2 && history.id() == id);
        assert!(!history.redo());
        assert!(history.undo() && history.undo() && !history.undo());
        history.commit("three", 3);
        assert_eq!(history.redo_label(), None);
        assert_ne!(history.id(), id);
    }
}
