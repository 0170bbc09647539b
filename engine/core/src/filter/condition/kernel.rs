//! A condition computed for many pixels at once: each of its numbers over a block of pixels, then the next.

use dispatch::{Processor, compiled_for_each_processor};

use filter_api::NEARNESS_ONE;

use super::program::{Asked, Comparison, Number, Program, Sum, Truth};

/// Pixels of a block: its numbers stay in the nearest cache.
const LANES: usize = 256;

type Numbers = [f32; LANES];
/// 0 or 255 of each pixel.
type Truths = [u8; LANES];

/// A program with room for what it computes of one block.
pub(super) struct Kernel {
    program: Program,
    processor: Processor,
    /// Red, green and blue.
    colours: Box<[Numbers; 3]>,
    numbers: Vec<Numbers>,
    truths: Vec<Truths>,
}

impl Kernel {
    pub(super) fn new(program: Program, processor: Processor) -> Self {
        let numbers = program.numbers.iter().map(|number| match number {
            Number::Constant(value) => [*value; LANES],
            _ => [0.0; LANES],
        });
        let (numbers, truths) = (numbers.collect(), vec![[0; LANES]; program.truths.len()]);
        Self { program, processor, colours: Box::new([[0.0; LANES]; 3]), numbers, truths }
    }

    /// Whether its frames hold nearness.
    pub(super) fn looks_at_depth(&self) -> bool {
        self.program.looks_at_depth()
    }

    /// Writes 255 where the condition holds, else 0; `pixels` has three bytes for each one of `out`, or two of nearness.
    pub(super) fn mark(&mut self, pixels: &[u8], out: &mut [u8]) {
        mark(self.processor, self, pixels, out);
    }
}

compiled_for_each_processor! {
    /// Marks block by block; what the end of the last block computes is not used.
    fn mark<'a>(kernel: &'a mut Kernel, pixels: &'a [u8], out: &'a mut [u8]) {
        let Kernel { program, colours, numbers, truths, .. } = kernel;
        let depth = program.looks_at_depth();
        let bytes = if depth { 2 } else { 3 };
        for (pixels, out) in pixels.chunks(bytes * LANES).zip(out.chunks_mut(LANES)) {
            if depth { nearness(pixels, &mut colours[0]) } else { split(pixels, colours) }
            for (place, number) in program.numbers.iter().enumerate() {
                let (before, rest) = numbers.split_at_mut(place);
                if let Some(to) = rest.first_mut() {
                    compute(number, colours, before, to);
                }
            }
            for (place, truth) in program.truths.iter().enumerate() {
                let (before, rest) = truths.split_at_mut(place);
                if let Some(to) = rest.first_mut() {
                    decide(truth, numbers, before, to);
                }
            }
            out.copy_from_slice(&truths[program.result][..out.len()]);
        }
    }
}

/// The three colours apart.
#[inline(always)]
fn split(pixels: &[u8], [red, green, blue]: &mut [Numbers; 3]) {
    let lanes = red.iter_mut().zip(green).zip(blue);
    for (pixel, ((red, green), blue)) in pixels.chunks_exact(3).zip(lanes) {
        *red = f32::from(pixel[0]);
        *green = f32::from(pixel[1]);
        *blue = f32::from(pixel[2]);
    }
}

/// Nearness in 1/m: exact, since it is counted in powers of two.
#[inline(always)]
fn nearness(pixels: &[u8], to: &mut Numbers) {
    for (pixel, to) in pixels.as_chunks::<2>().0.iter().zip(to) {
        *to = f32::from(u16::from_le_bytes(*pixel)) / f32::from(NEARNESS_ONE);
    }
}

#[inline(always)]
fn compute(number: &Number, colours: &[Numbers; 3], before: &[Numbers], to: &mut Numbers) {
    match *number {
        Number::Constant(_) => {}
        // Of a depth frame there is nothing else.
        Number::Pixel(Asked::Red | Asked::Nearness) => to.copy_from_slice(&colours[0]),
        Number::Pixel(Asked::Green) => to.copy_from_slice(&colours[1]),
        Number::Pixel(Asked::Blue) => to.copy_from_slice(&colours[2]),
        Number::Pixel(Asked::Hue) => of_colours(colours, to, hue_deg),
        Number::Pixel(Asked::Saturation) => of_colours(colours, to, saturation),
        Number::Pixel(Asked::Value) => of_colours(colours, to, value),
        Number::Pixel(Asked::Brightness) => of_colours(colours, to, brightness),
        Number::Negative(a) => of_one(&before[a], to, |a| -a),
        Number::Absolute(a) => of_one(&before[a], to, f32::abs),
        Number::Two(sum, a, b) => {
            let (a, b) = (&before[a], &before[b]);
            match sum {
                Sum::Add => of_two(a, b, to, |a, b| a + b),
                Sum::Subtract => of_two(a, b, to, |a, b| a - b),
                Sum::Multiply => of_two(a, b, to, |a, b| a * b),
                Sum::Divide => of_two(a, b, to, |a, b| a / b),
                Sum::Least => of_two(a, b, to, least),
                Sum::Greatest => of_two(a, b, to, greatest),
            }
        }
    }
}

#[inline(always)]
fn decide(truth: &Truth, numbers: &[Numbers], before: &[Truths], to: &mut Truths) {
    match *truth {
        Truth::Compare(comparison, a, b) => {
            let (a, b) = (&numbers[a], &numbers[b]);
            match comparison {
                Comparison::Less => compare(a, b, to, |a, b| a < b),
                Comparison::AtMost => compare(a, b, to, |a, b| a <= b),
                Comparison::Equal => compare(a, b, to, |a, b| a == b),
                Comparison::Different => compare(a, b, to, differ),
            }
        }
        Truth::Not(a) => of_one(&before[a], to, |a| !a),
        Truth::And(a, b) => of_two(&before[a], &before[b], to, |a, b| a & b),
        Truth::Or(a, b) => of_two(&before[a], &before[b], to, |a, b| a | b),
    }
}

#[inline(always)]
fn of_one<T: Copy>(a: &[T; LANES], to: &mut [T; LANES], make: impl Fn(T) -> T) {
    for (to, a) in to.iter_mut().zip(a) {
        *to = make(*a);
    }
}

#[inline(always)]
fn of_two<T: Copy>(a: &[T; LANES], b: &[T; LANES], to: &mut [T; LANES], make: impl Fn(T, T) -> T) {
    for ((to, a), b) in to.iter_mut().zip(a).zip(b) {
        *to = make(*a, *b);
    }
}

#[inline(always)]
fn compare(a: &Numbers, b: &Numbers, to: &mut Truths, holds: impl Fn(f32, f32) -> bool) {
    for ((to, a), b) in to.iter_mut().zip(a).zip(b) {
        *to = if holds(*a, *b) { 255 } else { 0 };
    }
}

#[inline(always)]
fn of_colours([red, green, blue]: &[Numbers; 3], to: &mut Numbers, make: impl Fn(f32, f32, f32) -> f32) {
    for (((to, red), green), blue) in to.iter_mut().zip(red).zip(green).zip(blue) {
        *to = make(*red, *green, *blue);
    }
}

/// Written out, so that what is no number comes out the same on every processor: the second one is taken.
#[inline(always)]
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn greatest(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Not `!=`, which holds for what is no number.
#[inline(always)]
fn differ(a: f32, b: f32) -> bool {
    (a < b) | (a > b)
}

#[inline(always)]
fn value(red: f32, green: f32, blue: f32) -> f32 {
    greatest(greatest(red, green), blue)
}

#[inline(always)]
fn saturation(red: f32, green: f32, blue: f32) -> f32 {
    let max = value(red, green, blue);
    let spread = max - least(least(red, green), blue);
    // Black has none; 0 / 1 is 0.
    spread / greatest(max, 1.0)
}

/// In 1536 steps round the circle, as the filter `colour` counts; grey has no hue.
#[inline(always)]
fn hue_deg(red: f32, green: f32, blue: f32) -> f32 {
    let max = value(red, green, blue);
    let spread = max - least(least(red, green), blue);
    let (base, difference) = if max == red {
        (0.0, green - blue)
    } else if max == green {
        (512.0, blue - red)
    } else {
        (1024.0, red - green)
    };
    let steps = base + (difference * 256.0 / spread).trunc();
    let steps = if steps < 0.0 { steps + 1536.0 } else { steps };
    steps * (360.0 / 1536.0)
}

#[inline(always)]
fn brightness(red: f32, green: f32, blue: f32) -> f32 {
    // At most 65,280: exact.
    ((77.0 * red + 150.0 * green + 29.0 * blue) / 256.0).trunc()
}
