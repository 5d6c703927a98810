/// Places of the words at a plot's points, chosen so that none covers another.
pub(super) struct Labels {
    /// Where words may stand: left, right, top, bottom, px.
    room: [f64; 4],
    /// Where some do already, likewise.
    taken: Vec<[f64; 4]>,
}

/// Where a word stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// The end of the word that is nearer to its point, px.
    pub x: f64,
    /// Its base line, px.
    pub y: f64,
    /// Whether it ends there; it begins there otherwise.
    pub is_left: bool,
}

/// From a point to its word, and how far a line of text reaches above and below its base line, px.
const GAP: f64 = 6.0;
const ABOVE: f64 = 10.0;
const BELOW: f64 = 3.0;

impl Labels {
    /// No words in this room yet: left, right, top, bottom, px.
    pub fn new(room: [f64; 4]) -> Self {
        Self { room, taken: Vec::new() }
    }

    /// A place for a word at a point: right or left of it, above it if that is free; `None` if all around it is taken.
    pub fn place(&mut self, [x, y]: [f64; 2], word: &str) -> Option<Place> {
        let width = super::text_width(word);
        let lines = [y - GAP, y + GAP + ABOVE - BELOW];
        let places = lines
            .into_iter()
            .flat_map(|y| [Place { x: x + GAP, y, is_left: false }, Place { x: x - GAP, y, is_left: true }]);
        let extent = |place: &Place| {
            let left = if place.is_left { place.x - width } else { place.x };
            [left, left + width, place.y - ABOVE, place.y + BELOW]
        };
        let is_free = |place: &Place| {
            let extent = extent(place);
            is_within(extent, self.room) && !self.taken.iter().any(|other| do_meet(extent, *other))
        };
        let place = places.into_iter().find(is_free)?;
        self.taken.push(extent(&place));
        Some(place)
    }
}

fn is_within(a: [f64; 4], room: [f64; 4]) -> bool {
    a[0] >= room[0] && a[1] <= room[1] && a[2] >= room[2] && a[3] <= room[3]
}

fn do_meet(a: [f64; 4], b: [f64; 4]) -> bool {
    a[0] < b[1] && b[0] < a[1] && a[2] < b[3] && b[2] < a[3]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Five words at one point: four stand round it, the fifth finds no room.
    #[test]
    fn words_stand_round_their_point() {
        let mut labels = Labels::new([0.0, 400.0, 0.0, 200.0]);
        let at = |labels: &mut Labels| labels.place([200.0, 100.0], "30 mm").map(|p| (p.is_left, p.y));
        let places: Vec<_> = (0..5).map(|_| at(&mut labels)).collect();
        let four = [(false, 94.0), (true, 94.0), (false, 113.0), (true, 113.0)].map(Some);
        assert_eq!(places[..4], four);
        assert_eq!(places[4], None);
    }

    #[test]
    fn words_stay_in_the_drawing() {
        let mut labels = Labels::new([50.0, 400.0, 30.0, 200.0]);
        let corner = labels.place([390.0, 32.0], "960/s");
        assert_eq!(corner, Some(Place { x: 384.0, y: 45.0, is_left: true }));
    }
}
