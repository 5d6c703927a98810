//! Time: playing, scrubbing, looping, stepping.

/// Where in the motion the picture is.
#[derive(Clone, Debug, PartialEq)]
pub struct Player {
    /// The time shown, s on the field's clock.
    pub time_secs: f64,
    /// Whether time runs.
    pub playing: bool,
    /// Whether it begins again at the end.
    pub looping: bool,
    /// How fast: 1 is real time.
    pub speed: f64,
    start_secs: f64,
    end_secs: f64,
    rate_hz: f64,
}

impl Player {
    /// A player of a motion with these frames, at its first one.
    pub fn new(times_secs: &[f64]) -> Self {
        let mut player = Self {
            time_secs: 0.0,
            playing: false,
            looping: true,
            speed: 1.0,
            start_secs: 0.0,
            end_secs: 0.0,
            rate_hz: 60.0,
        };
        player.span(times_secs);
        player.time_secs = player.start_secs;
        player
    }

    /// The motion has these frames from now on.
    pub fn span(&mut self, times_secs: &[f64]) {
        if let [first, .., last] = times_secs {
            (self.start_secs, self.end_secs) = (*first, *last);
            self.rate_hz = (times_secs.len() - 1) as f64 / (last - first);
        }
        self.go(self.time_secs);
    }

    /// The first frame's time, s.
    pub fn start_secs(&self) -> f64 {
        self.start_secs
    }

    /// The last frame's time, s.
    pub fn end_secs(&self) -> f64 {
        self.end_secs
    }

    /// Frames a second.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// The frame shown, from 0.
    pub fn frame(&self) -> usize {
        ((self.time_secs - self.start_secs) * self.rate_hz).round() as usize
    }

    /// The nearest frame's time, s.
    pub fn snapped(&self, time_secs: f64) -> f64 {
        let frame = ((time_secs - self.start_secs) * self.rate_hz).round();
        (self.start_secs + frame / self.rate_hz).clamp(self.start_secs, self.end_secs)
    }

    /// Shows a time, held within the motion.
    pub fn go(&mut self, time_secs: f64) {
        self.time_secs = time_secs.clamp(self.start_secs, self.end_secs);
    }

    /// Shows a frame so many before or after, and stops.
    pub fn step(&mut self, frames: i32) {
        self.playing = false;
        self.go(self.snapped(self.time_secs) + f64::from(frames) / self.rate_hz);
    }

    /// Plays, from the beginning if the end was reached, or stops.
    pub fn toggle(&mut self) {
        self.playing = !self.playing;
        if self.playing && self.time_secs >= self.end_secs {
            self.time_secs = self.start_secs;
        }
    }

    /// So much time went by in the room, s.
    pub fn tick(&mut self, elapsed_secs: f64) {
        if !self.playing {
            return;
        }
        let next = self.time_secs + elapsed_secs * self.speed;
        let length = self.end_secs - self.start_secs;
        if next < self.end_secs {
            self.time_secs = next;
        } else if self.looping && length > 0.0 {
            self.time_secs = self.start_secs + (next - self.start_secs) % length;
        } else {
            self.time_secs = self.end_secs;
            self.playing = false;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames from 1 s to 2 s at 10 Hz.
    fn player() -> Player {
        let times: Vec<f64> = (0..11).map(|k| 1.0 + f64::from(k) / 10.0).collect();
        Player::new(&times)
    }

    #[test]
    fn it_plays_loops_and_stops() {
        let mut player = player();
        player.toggle();
        player.tick(0.7);
        assert!((player.time_secs - 1.7).abs() < 1e-12 && player.frame() == 7);
        player.tick(0.5);
        assert!((player.time_secs - 1.2).abs() < 1e-12);
        player.looping = false;
        player.tick(5.0);
        assert!(player.time_secs == 2.0 && !player.playing);
        player.toggle();
        assert!(player.time_secs == 1.0 && player.playing);
    }

    #[test]
    fn it_steps_by_frames_within_the_motion() {
        let mut player = player();
        player.go(1.234);
        player.step(1);
        assert!((player.time_secs - 1.3).abs() < 1e-12);
        player.step(-99);
        assert_eq!(player.time_secs, 1.0);
        assert!((player.snapped(1.96) - 2.0).abs() < 1e-12);
    }
}
