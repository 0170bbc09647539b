use engine::filter::LINKED_IN;
use engine::random::{Random, Stream};
use filter_api::{Descriptor, Filter, Format, Frame, FrameMut, Plugin};

/// Width and height, with the smallest there are, single rows and columns, odd and even.
const SIZES: &[(usize, usize)] = &[(1, 1), (1, 2), (2, 1), (7, 1), (1, 7), (2, 2), (3, 3), (5, 4), (16, 12), (33, 17)];

/// Bytes of a frame: noise, or (every third time) patches of one value with steps between them.
fn pixels(random: &mut Random, format: Format, width: usize, height: usize) -> Vec<u8> {
    let plain = random.below(3) == 0;
    let mut value = 0;
    let mut bytes = Vec::with_capacity(width * height * format.channels());
    for _ in 0..width * height * format.channels() {
        if !plain || random.below(8) == 0 {
            value = random.below(256) as u8;
        }
        bytes.push(if format == Format::Mask { if value < 128 { 0 } else { 255 } } else { value });
    }
    bytes
}

/// Defaults; every parameter alone at its least and greatest value; all at their least; all at their greatest.
fn settings(descriptor: &Descriptor) -> Vec<Vec<f64>> {
    let parameters = descriptor.parameters;
    let default: Vec<f64> = parameters.iter().map(|parameter| parameter.default).collect();
    let mut settings = vec![default.clone()];
    for (index, parameter) in parameters.iter().enumerate() {
        for end in [parameter.min, parameter.max] {
            settings.push(default.clone());
            if let Some(values) = settings.last_mut() {
                values[index] = end;
            }
        }
    }
    settings.push(parameters.iter().map(|parameter| parameter.min).collect());
    settings.push(parameters.iter().map(|parameter| parameter.max).collect());
    settings
}

fn output(plugin: &Plugin, filter: &mut dyn Filter, input: Frame<'_>) -> Vec<u8> {
    let (width, height, format) = (input.width_px(), input.height_px(), plugin.descriptor.writes);
    let length = width * height * format.channels();
    // Every byte must be written, so what stood there before must not matter.
    let [first, second] = [7, 99].map(|before| {
        let mut out = vec![before; length];
        filter.process(input, FrameMut::new(width, height, format, &mut out).unwrap()).unwrap();
        out
    });
    assert_eq!(first, second, "{} at {width}x{height}", plugin.descriptor.name);
    first
}

fn check(plugin: &Plugin, values: &[f64], random: &mut Random) {
    let descriptor = plugin.descriptor;
    let mut used = (plugin.create)(values).unwrap();
    for format in descriptor.reads {
        for (width, height) in SIZES.iter().copied() {
            let place = format!("{} {values:?}, {format:?} {width}x{height}", descriptor.name);
            let bytes = pixels(random, *format, width, height);
            let input = Frame::new(width, height, *format, &bytes).unwrap();
            let mut fresh = (plugin.create)(values).unwrap();
            let wanted = output(plugin, fresh.as_mut(), input);
            assert!(output(plugin, used.as_mut(), input) == wanted, "{place}: remembers another frame");
            if descriptor.writes == Format::Mask {
                assert!(wanted.iter().all(|byte| [0, 255].contains(byte)), "{place}: not a mask");
            }
        }
    }
}

#[test]
fn a_frame_and_the_parameters_decide_the_output_whatever_was_seen_before() {
    let mut random = Random::new(1, Stream::Camera);
    for plugin in LINKED_IN {
        let all = settings(plugin.descriptor);
        let (defaults, ends) = (&all[0], &all[all.len() - 2..]);
        for values in &all {
            // Values may be in range and yet not go together, but never the defaults, nor the ends of all ranges.
            if (plugin.create)(values).is_ok() || values == defaults || ends.contains(values) {
                check(plugin, values, &mut random);
            }
        }
    }
}

#[test]
fn another_size_or_format_than_agreed_is_an_error_and_no_panic() {
    for plugin in LINKED_IN {
        let descriptor = plugin.descriptor;
        let mut filter = (plugin.create)(&settings(descriptor)[0]).unwrap();
        let mut process = |format: Format, width: usize| {
            let bytes = vec![0; 12 * format.channels()];
            let mut out = vec![0; width * 3 * descriptor.writes.channels()];
            let input = Frame::new(4, 3, format, &bytes).unwrap();
            filter.process(input, FrameMut::new(width, 3, descriptor.writes, &mut out).unwrap())
        };
        for format in [Format::Rgb, Format::Grey, Format::Mask] {
            let reads = descriptor.reads.contains(&format);
            assert_eq!(process(format, 4).is_ok(), reads, "{} and {format:?}", descriptor.name);
            assert!(process(format, 3).is_err(), "{}", descriptor.name);
        }
    }
}

#[test]
fn descriptors_are_complete() {
    for plugin in LINKED_IN {
        let descriptor = plugin.descriptor;
        assert!(descriptor.purpose.ends_with('.') && !descriptor.reads.is_empty(), "{}", descriptor.name);
        assert!(!descriptor.version.is_empty() && !descriptor.licence.is_empty(), "{}", descriptor.name);
        for parameter in descriptor.parameters {
            assert!(parameter.purpose.ends_with('.') && !parameter.unit.is_empty(), "{}", parameter.name);
        }
    }
}
