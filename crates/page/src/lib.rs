//! One self-contained page that shows a capture, its field and the hair moving in it.
