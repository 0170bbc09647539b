//! The floor as a model that is learned while driving: which greys had what the robot then drove over.
//!
//! A histogram is taken of the strip at the bottom middle of each frame. It waits until the robot has driven [`WAY`] on, and so
//! stands where the strip was; then it goes into the model, which fades by 1/512 with each. Where the robot was put down, which
//! is on floor, its strip goes into the model at once. A pixel is floor if enough of the model has its grey, or one near it.
//!
//! A robot that stands and turns sees many strips and drives over none: a strip that was seen less than [`APART`] after the last
//! one replaces it, so that [`MOST`] of them are enough.

use filter_api::{Filter, FilterError, Format, Frame, FrameMut, Moved};

use crate::part;

/// What a strip waits for, in tenths of a millimetre.
const WAY: u32 = 4_000;
/// Strips that wait stand so far apart, in tenths of a millimetre.
const APART: u32 = 400;
/// The most strips that wait.
const MOST: usize = (WAY / APART) as usize + 2;
/// A histogram adds up to about this.
const WHOLE: u32 = 32_768;
/// The model fades by one over two to this.
const FADING: u32 = 9;
/// Bytes of a strip that waits: its place on the way, and 256 shares.
const STRIP_BYTES: usize = 4 + 2 * 256;

/// A strip that the robot has not driven over yet.
#[derive(Debug, Clone, Copy)]
struct Strip {
    /// How far the robot had driven.
    way: u32,
    shares: [u16; 256],
}

/// The filter `floor` with `memory`.
pub(crate) struct FloorMemory {
    /// Height and width of the strip.
    strip: [f64; 2],
    levels: usize,
    /// In 1/65536.
    rare: u64,
    model: [u32; 256],
    total: u32,
    way: u32,
    waiting: [Strip; MOST],
    waiting_count: usize,
    jumped: bool,
    /// What the model makes of each grey: 0 if it is floor.
    foreign: [u8; 256],
    luma: Vec<u8>,
}

impl FloorMemory {
    pub(crate) fn new(strip: [f64; 2], levels: usize, rare: f64) -> Self {
        Self {
            strip,
            levels,
            rare: (rare * 65_536.0).round() as u64,
            model: [0; 256],
            total: 0,
            way: 0,
            waiting: [Strip { way: 0, shares: [0; 256] }; MOST],
            waiting_count: 0,
            jumped: true,
            foreign: [0; 256],
            luma: Vec::new(),
        }
    }

    /// The shares of the greys in the strip of a frame of this size.
    fn shares(&self, luma: &[u8], width_px: usize, height_px: usize) -> [u16; 256] {
        let [rows, columns] = [part(self.strip[0], height_px), part(self.strip[1], width_px)];
        let left = (width_px - columns) / 2;
        let mut counts = [0_u32; 256];
        for row in luma.chunks_exact(width_px).skip(height_px - rows) {
            for grey in &row[left..left + columns] {
                counts[usize::from(*grey)] += 1;
            }
        }
        let pixels = (rows * columns) as u64;
        counts.map(|count| (u64::from(count) * u64::from(WHOLE) / pixels) as u16)
    }

    fn learn(&mut self, shares: &[u16; 256]) {
        self.total += WHOLE - (self.total >> FADING);
        for (model, share) in self.model.iter_mut().zip(shares) {
            *model = *model - (*model >> FADING) + u32::from(*share);
        }
    }

    /// What the model makes of each grey now.
    fn judge(&mut self) {
        let least = self.rare * u64::from(self.total);
        // By grey: the sum of all below it.
        let mut below = [0_u64; 257];
        for (grey, share) in self.model.iter().enumerate() {
            below[grey + 1] = below[grey] + u64::from(*share);
        }
        for (grey, foreign) in self.foreign.iter_mut().enumerate() {
            let near = grey.saturating_sub(self.levels)..(grey + self.levels + 1).min(256);
            *foreign = if ((below[near.end] - below[near.start]) << 16) >= least { 0 } else { 255 };
        }
    }

    /// The greys that are floor: first, last, and the share of the model that has them, in percent.
    fn greys(&self) -> Vec<(usize, usize, u64)> {
        let mut greys: Vec<(usize, usize, u64)> = Vec::new();
        for grey in (0..256).filter(|grey| self.foreign[*grey] == 0) {
            let share = u64::from(self.model[grey]);
            match greys.last_mut() {
                Some((_, last, sum)) if *last + 1 == grey => (*last, *sum) = (grey, *sum + share),
                _ => greys.push((grey, grey, share)),
            }
        }
        let total = u64::from(self.total).max(1);
        greys.into_iter().map(|(first, last, sum)| (first, last, (100 * sum + total / 2) / total)).collect()
    }

    /// Takes a strip in that is seen now; learns those that were driven over since.
    fn take(&mut self, shares: [u16; 256]) {
        if self.jumped {
            (self.jumped, self.waiting_count, self.way) = (false, 0, 0);
            self.learn(&shares);
        }
        let driven_over = self.waiting[..self.waiting_count].iter().take_while(|strip| self.way - strip.way >= WAY);
        let driven_over = driven_over.count();
        for index in 0..driven_over {
            let shares = self.waiting[index].shares;
            self.learn(&shares);
        }
        self.waiting.copy_within(driven_over..self.waiting_count, 0);
        self.waiting_count -= driven_over;
        let way = self.way;
        match self.waiting[..self.waiting_count].last_mut() {
            Some(last) if way - last.way < APART => last.shares = shares,
            _ => {
                self.waiting[self.waiting_count] = Strip { way, shares };
                self.waiting_count += 1;
            }
        }
        self.judge();
    }
}

impl Filter for FloorMemory {
    fn process(&mut self, input: Frame<'_>, mut output: FrameMut<'_>) -> Result<(), FilterError> {
        output.check_same_size(&input)?;
        if matches!(input.format(), Format::Mask | Format::Depth) {
            return Err(FilterError("floor reads colour or grey frames".to_owned()));
        }
        let (width_px, height_px) = (input.width_px(), input.height_px());
        if width_px == 0 || height_px == 0 {
            return Ok(());
        }
        let mut luma = std::mem::take(&mut self.luma);
        luma.resize(width_px * height_px, 0);
        input.write_luma(&mut luma)?;
        let shares = self.shares(&luma, width_px, height_px);
        self.take(shares);
        for (grey, out) in luma.iter().zip(output.pixels()) {
            *out = self.foreign[usize::from(*grey)];
        }
        self.luma = luma;
        Ok(())
    }

    fn moved(&mut self, moved: &Moved) {
        // What is said twice before a frame adds up.
        self.jumped |= moved.jumped;
        self.way = self.way.saturating_add((moved.driven_m.abs() * 10_000.0).round() as u32);
    }

    fn keeps(&self) -> usize {
        4 * 256 + 16 + MOST * STRIP_BYTES
    }

    fn save(&self, kept: &mut [u8]) {
        let head = [self.total, self.way, self.waiting_count as u32, u32::from(self.jumped)];
        let numbers = self.model.iter().copied().chain(head).flat_map(u32::to_le_bytes);
        let strips = self.waiting.iter().enumerate().flat_map(|(index, strip)| {
            // What waits no more is not kept.
            let waits = index < self.waiting_count;
            let way = if waits { strip.way } else { 0 };
            let shares = strip.shares.into_iter().flat_map(move |share| if waits { share } else { 0 }.to_le_bytes());
            way.to_le_bytes().into_iter().chain(shares)
        });
        for (place, byte) in kept.iter_mut().zip(numbers.chain(strips)) {
            *place = byte;
        }
    }

    fn words(&self) -> String {
        if self.total == 0 {
            return "no floor is known yet".to_owned();
        }
        let greys = self.greys().into_iter().map(|(first, last, percent)| format!("{first} to {last} ({percent} %)"));
        format!("greys of the floor driven over: {}", greys.collect::<Vec<_>>().join(", "))
    }

    fn load(&mut self, kept: &[u8]) -> Result<(), FilterError> {
        let wrong = || FilterError("this is not what floor keeps".to_owned());
        if kept.len() != self.keeps() {
            return Err(wrong());
        }
        let number = |at: usize| u32::from_le_bytes([kept[at], kept[at + 1], kept[at + 2], kept[at + 3]]);
        let [total, way, count, jumped] = [1024, 1028, 1032, 1036].map(number);
        let strips = 1040;
        let way_of = |index: usize| number(strips + index * STRIP_BYTES);
        let count = count as usize;
        let in_order = count <= MOST && (0..count).all(|index| way_of(index) <= way);
        // Neither can grow beyond what fading leaves of it.
        let most = WHOLE << FADING;
        if !in_order || total > most || (0..256).any(|grey| number(4 * grey) > most) || jumped > 1 {
            return Err(wrong());
        }
        for (grey, model) in self.model.iter_mut().enumerate() {
            *model = number(4 * grey);
        }
        (self.total, self.way, self.waiting_count, self.jumped) = (total, way, count, jumped == 1);
        for (index, strip) in self.waiting.iter_mut().enumerate() {
            strip.way = way_of(index);
            let shares = kept[strips + index * STRIP_BYTES + 4..].chunks_exact(2);
            for (share, bytes) in strip.shares.iter_mut().zip(shares) {
                *share = u16::from_le_bytes([bytes[0], bytes[1]]);
            }
        }
        self.judge();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames of two rows, the lower of which is the strip; 6 levels, 3 %.
    struct Driving(FloorMemory);

    impl Driving {
        fn new() -> Self {
            Self(FloorMemory::new([0.5, 1.0], 6, 0.03))
        }

        fn sees(&mut self, driven_m: f64, jumped: bool, above: u8, below: u8) -> Vec<u8> {
            self.0.moved(&Moved { driven_m, turned_rad: 0.0, jumped });
            let mut out = vec![7; 2];
            let pixels = [above, below];
            let input = Frame::new(1, 2, Format::Grey, &pixels).unwrap();
            self.0.process(input, FrameMut::new(1, 2, Format::Mask, &mut out).unwrap()).unwrap();
            out
        }
    }

    #[test]
    fn what_the_robot_was_put_on_is_floor_and_six_levels_round_it() {
        let mut robot = Driving::new();
        assert_eq!(robot.sees(0.0, true, 106, 100), [0, 0]);
        assert_eq!(robot.sees(0.0, false, 107, 100), [255, 0]);
        assert_eq!(robot.sees(0.0, false, 94, 93), [0, 255]);
    }

    #[test]
    fn a_shade_becomes_floor_once_it_was_driven_over() {
        let mut robot = Driving::new();
        robot.sees(0.0, true, 100, 100);
        assert_eq!(robot.sees(0.1, false, 100, 50), [0, 255]);
        assert_eq!(robot.sees(0.39, false, 50, 100), [255, 0]);
        // One strip of the shade beside one of the light, on which the robot was put, and one that it drove over: a third.
        assert_eq!(robot.sees(0.01, false, 50, 100), [0, 0]);
        assert_eq!(robot.0.words(), "greys of the floor driven over: 44 to 56 (33 %), 94 to 106 (67 %)");
    }

    #[test]
    fn what_the_robot_turned_away_from_never_becomes_floor() {
        let mut robot = Driving::new();
        robot.sees(0.0, true, 100, 100);
        robot.sees(0.01, false, 100, 200);
        robot.sees(0.0, false, 100, 100);
        assert_eq!(robot.sees(0.5, false, 200, 100), [255, 0]);
    }

    #[test]
    fn being_put_elsewhere_forgets_what_waits_and_not_what_is_known() {
        let mut robot = Driving::new();
        robot.sees(0.0, true, 100, 100);
        robot.sees(0.1, false, 100, 50);
        robot.sees(0.0, true, 100, 150);
        assert_eq!(robot.sees(0.5, false, 50, 100), [255, 0]);
        assert_eq!(robot.sees(0.0, false, 150, 100), [0, 0]);
    }

    #[test]
    fn what_is_saved_goes_on_in_the_same_way() {
        let mut robot = Driving::new();
        robot.sees(0.0, true, 100, 100);
        robot.sees(0.1, false, 100, 50);
        let mut kept = vec![9; robot.0.keeps()];
        robot.0.save(&mut kept);
        let mut other = Driving::new();
        other.sees(0.0, true, 7, 7);
        other.0.load(&kept).unwrap();
        for driven_m in [0.2, 0.2, 0.3] {
            assert_eq!(other.sees(driven_m, false, 50, 100), robot.sees(driven_m, false, 50, 100));
        }
        let mut again = [vec![0; robot.0.keeps()], vec![0; robot.0.keeps()]];
        robot.0.save(&mut again[0]);
        other.0.save(&mut again[1]);
        assert_eq!(again[0], again[1]);
        assert!(other.0.load(&kept[1..]).is_err());
        kept[1032] = 200;
        assert!(other.0.load(&kept).is_err());
    }
}
