use super::kernel::Kernel;
use super::parser::parse;
use super::program::{Asked, Comparison, Number, Program, Sum, Truth};
use super::*;

fn mask(condition: &str, pixels: &[u8]) -> Vec<u8> {
    let mut out = vec![7; pixels.len() / 3];
    Kernel::new(parse(condition).unwrap(), Processor::best()).mark(pixels, &mut out);
    out
}

/// Whether a condition holds for a pixel.
fn holds(condition: &str, pixel: [u8; 3]) -> bool {
    mask(condition, &pixel) == [255]
}

#[test]
fn red_pixels_are_marked_and_grey_or_dark_ones_are_not() {
    // 200 > 1.5 * 40; 90 is not over 1.5 * 60; 60 is not over 60.
    assert_eq!(mask(EXAMPLE, &[200, 40, 30, 90, 60, 0, 60, 10, 10, 61, 10, 10]), [255, 0, 0, 255]);
}

#[test]
fn products_come_before_sums_comparisons_before_and_and_and_before_or() {
    assert!(holds("r + 2 * g == 50", [10, 20, 0]));
    assert!(holds("(r + 2) * g == 240", [10, 20, 0]));
    assert!(holds("r > 99 && g > 99 || b > 5", [10, 20, 6]));
    assert!(!holds("r > 99 && (g > 99 || b > 5)", [10, 20, 6]));
    assert!(holds("!(r > 99) && -r < -9 && r - 2 - 3 == 5 && r / 5 / 2 == 1", [10, 0, 0]));
    assert!(holds("abs(r - g) == 10 && min(r, g) == 10 && max(r, g) == 20 && r != g", [10, 20, 0]));
}

#[test]
fn a_pixel_has_hue_saturation_value_and_brightness() {
    // (200, 40, 0): hue 256 * 40 / 200 = 51 steps of 1536, 11.95 degrees; saturation 1; brightness (15400 + 6000) / 256 = 83.
    assert!(holds("hue_deg == 11.953125 && saturation == 1 && value == 200 && brightness == 83", [200, 40, 0]));
    // (200, 0, 40) lies 51 steps before red: 1485 of 1536 steps.
    assert!(holds("hue_deg == 348.046875", [200, 0, 40]));
    assert!(holds("hue_deg == 120 && saturation == 0.5", [50, 100, 50]));
    assert!(holds("saturation == 0 && value == 0 && brightness == 0", [0, 0, 0]));
}

#[test]
fn what_is_no_number_compares_with_nothing() {
    // Grey has no hue, and 0 / 0 is no number; 5 / 0 is greater than all of them.
    for condition in ["hue_deg < 360", "hue_deg >= 0", "hue_deg != 5", "hue_deg == hue_deg", "r / g > 0", "r / g != 3"]
    {
        assert!(!holds(condition, [0, 0, 0]), "{condition}");
    }
    assert!(holds("!(hue_deg < 360)", [9, 9, 9]));
    assert!(holds("r / g > 1000000", [5, 0, 0]));
}

#[test]
fn what_is_written_twice_is_computed_once() {
    let program = parse("r > 1.5 * g && r > 1.5 * g || b > 1.5 * g").unwrap();
    // r, 1.5, g, 1.5 * g, b; two comparisons, and, or.
    assert_eq!((program.numbers.len(), program.truths.len()), (5, 4));
}

/// A mistake: its message, what it underlines, its help.
fn mistake(condition: &str) -> (String, &str, String) {
    let ConditionError { message, help, span, .. } = parse(condition).unwrap_err();
    (message, &condition[span], help)
}

#[test]
fn a_mistake_says_where_it_is_and_what_to_write() {
    let answers = [
        ("r = 60", "=", "two numbers are compared by ==, or better by < and >"),
        ("r > 60 and g < 9", "and", "'and' is written &&"),
        ("r > 60 & g < 9", "&", "'and' is written &&"),
        ("not r > 60", "not", "'not' is written !"),
        ("!r > 60", "r", "put the comparison into parentheses: !(r > 60)"),
        ("60 < r < 90", "<", "write 60 < r && r < 90"),
        ("red > 60", "red", "did you mean r?"),
        ("gren > 60", "gren", "did you mean g?"),
        ("hue > 60", "hue", "did you mean hue_deg?"),
        ("brightnes > 60", "brightnes", "did you mean brightness?"),
        ("r - g", "r - g", "compare it: r - g > 60"),
        ("r > 60 && g", "g", "compare it: g > 60"),
        ("(r > 60) > g", "(r > 60)", "compare numbers, and join comparisons by && and ||: r > 60 && g < 90"),
        ("r > 1.5g", "1.5g", "write digits and at most one point, without a unit: 60, 1.5"),
        ("r > 2 g", "g", "put a sign before it: * + - / < > && ||"),
        ("r > 60)", ")", "leave the parenthesis out, or write what belongs before it"),
        ("(r > 60", "", "write it as here: r > 1.5 * g && r > 60"),
        ("r >", "", "write it as here: r > 1.5 * g && r > 60"),
        ("min(r) > 3", ")", "leave the parenthesis out, or write what belongs before it"),
        ("r ** 2 > 3", "**", "write a power as a product: r * r"),
        ("", "", "write which pixels are marked: r > 1.5 * g"),
    ];
    for (condition, wanted, help) in answers {
        let (message, underlined, found) = mistake(condition);
        assert_eq!((underlined, found.as_str()), (wanted, help), "{condition}: {message}");
    }
}

#[test]
fn hostile_conditions_are_refused() {
    let refused = |condition: &str| parse(condition).unwrap_err().message;
    assert!(refused(&"(".repeat(900)).contains("nested deeper than 24"));
    assert!(refused(&"-".repeat(900)).contains("nested deeper than 24"));
    assert!(refused(&" ".repeat(1_001)).contains("longer than 1000 bytes"));
    let long = (0..70).map(|number| format!("r>{number}")).collect::<Vec<_>>().join("||");
    assert!(refused(&long).contains("more than 64 numbers"));
}

#[test]
fn nearness_is_compared_in_one_over_metres_and_mixes_with_no_colour() {
    let mut filter = create("nearness > 0.5").unwrap();
    // 2 m, a little nearer, nothing seen.
    let pixels: Vec<u8> = [4096_u16, 4097, 0].iter().flat_map(|nearness| nearness.to_le_bytes()).collect();
    let mut out = [7; 3];
    let input = Frame::new(3, 1, Format::Depth, &pixels).unwrap();
    filter.process(input, FrameMut::new(3, 1, Format::Mask, &mut out).unwrap()).unwrap();
    assert_eq!(out, [0, 255, 0]);
    let mixed = parse("nearness > 0.5 && r > 60").unwrap_err();
    assert_eq!(mixed.message, "the condition looks at colour and at nearness: those are two images");
    assert_eq!(parse("depth < 2").unwrap_err().help, "did you mean nearness?");
}

/// A number by its definition, one pixel at a time.
fn number(program: &Program, place: usize, pixel: [i32; 3]) -> f32 {
    let [red, green, blue] = pixel;
    let (max, min) = (red.max(green).max(blue), red.min(green).min(blue));
    let of = |place: usize| number(program, place, pixel);
    match program.numbers[place] {
        Number::Constant(value) => value,
        // Of a depth frame; the conditions here look at colours.
        Number::Pixel(Asked::Nearness) => f32::NAN,
        Number::Pixel(Asked::Red) => red as f32,
        Number::Pixel(Asked::Green) => green as f32,
        Number::Pixel(Asked::Blue) => blue as f32,
        Number::Pixel(Asked::Value) => max as f32,
        Number::Pixel(Asked::Brightness) => ((77 * red + 150 * green + 29 * blue) >> 8) as f32,
        Number::Pixel(Asked::Saturation) if max == 0 => 0.0,
        Number::Pixel(Asked::Saturation) => (max - min) as f32 / max as f32,
        Number::Pixel(Asked::Hue) if max == min => f32::NAN,
        Number::Pixel(Asked::Hue) => {
            let step = |difference: i32| difference * 256 / (max - min);
            let steps = match max {
                max if max == red => step(green - blue),
                max if max == green => 512 + step(blue - red),
                _ => 1024 + step(red - green),
            };
            (steps.rem_euclid(1536) * 360) as f32 / 1536.0
        }
        Number::Negative(a) => -of(a),
        Number::Absolute(a) => of(a).abs(),
        Number::Two(Sum::Add, a, b) => of(a) + of(b),
        Number::Two(Sum::Subtract, a, b) => of(a) - of(b),
        Number::Two(Sum::Multiply, a, b) => of(a) * of(b),
        Number::Two(Sum::Divide, a, b) => of(a) / of(b),
        Number::Two(Sum::Least, a, b) if of(a) < of(b) => of(a),
        Number::Two(Sum::Greatest, a, b) if of(a) > of(b) => of(a),
        Number::Two(_, _, b) => of(b),
    }
}

fn truth(program: &Program, place: usize, pixel: [i32; 3]) -> bool {
    let (of, number) = (|place| truth(program, place, pixel), |place| number(program, place, pixel));
    match program.truths[place] {
        Truth::Compare(Comparison::Less, a, b) => number(a) < number(b),
        Truth::Compare(Comparison::AtMost, a, b) => number(a) <= number(b),
        Truth::Compare(Comparison::Equal, a, b) => number(a) == number(b),
        Truth::Compare(Comparison::Different, a, b) => number(a) < number(b) || number(a) > number(b),
        Truth::Not(a) => !of(a),
        Truth::And(a, b) => of(a) && of(b),
        Truth::Or(a, b) => of(a) || of(b),
    }
}

#[test]
fn every_compilation_marks_the_pixels_of_the_definition() {
    let conditions = [
        EXAMPLE,
        "hue_deg < 40 || hue_deg > 320 && saturation >= 0.25 && !(value < 30)",
        "abs(r - g) + abs(g - b) <= 0.3 * brightness || min(r, g) == max(g, b)",
        "r / g > b / r && -(r - b) / 3 != 7 || max(r / b, 0) < 0.1",
    ];
    let mut random = crate::random::Random::new(1, crate::random::Stream::Test);
    for condition in conditions {
        let program = parse(condition).unwrap();
        for levels in [2, 5, 40, 256] {
            // Two whole blocks and a part of one.
            let pixels: Vec<u8> = (0..3 * 700).map(|_| random.below(levels) as u8).collect();
            let wanted: Vec<u8> = pixels
                .chunks_exact(3)
                .map(|pixel| truth(&program, program.result, [pixel[0], pixel[1], pixel[2]].map(i32::from)))
                .map(|marked| if marked { 255 } else { 0 })
                .collect();
            for processor in Processor::all() {
                let mut out = vec![7; 700];
                Kernel::new(program.clone(), processor).mark(&pixels, &mut out);
                assert_eq!(out, wanted, "{condition} on {}", processor.name());
            }
        }
    }
}

#[test]
#[ignore = "takes the time of two filters: run it alone"]
fn a_condition_costs_at_most_one_and_a_half_times_the_filter_colour() {
    let catalogue = crate::filter::Catalogue::linked_in();
    let colour = catalogue.find("colour").unwrap();
    let mut colour = colour.start(&[0.0, 25.0, 0.4, 20.0]).unwrap();
    let mut own = create(EXAMPLE).map_err(|error| error.message).unwrap();
    let mut random = crate::random::Random::new(1, crate::random::Stream::Test);
    let pixels: Vec<u8> = (0..3 * 160 * 120).map(|_| random.below(256) as u8).collect();
    let mut out = vec![0; 160 * 120];
    let mut least = |filter: &mut dyn Running| {
        let mut once = || {
            #[expect(clippy::disallowed_methods, reason = "this test measures time")]
            let begin = std::time::Instant::now();
            for _ in 0..20 {
                let input = Frame::new(160, 120, Format::Rgb, &pixels).unwrap();
                filter.process(input, FrameMut::new(160, 120, Format::Mask, &mut out).unwrap()).unwrap();
            }
            begin.elapsed().as_secs_f64() / 20.0
        };
        (0..200).map(|_| once()).fold(f64::INFINITY, f64::min) * 1e6
    };
    let (colour, own) = (least(colour.as_mut()), least(own.as_mut()));
    println!("colour {colour:.2} us, where {own:.2} us, ratio {:.2}", own / colour);
    assert!(own <= 1.5 * colour);
}
