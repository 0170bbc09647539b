use engine::filter::LINKED_IN;
use filter_api::{Format, Frame, FrameMut};

#[test]
fn another_size_or_format_than_agreed_is_an_error_and_no_panic() {
    for plugin in LINKED_IN {
        let descriptor = plugin.descriptor;
        let defaults: Vec<f64> = descriptor.parameters.iter().map(|parameter| parameter.default).collect();
        let mut filter = (plugin.create)(&defaults).unwrap();
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
