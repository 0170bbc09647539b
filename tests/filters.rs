use std::sync::Arc;

use engine::filter::{Catalogue, Entry, Form, conformance, mount_of};
use engine::settings::Settings;
use filter_api::{Descriptor, Format, Frame, FrameMut};

use crate::support::filters::{entries, forms};

/// Every filter in every form, with words for the form. In isolation only one: each instance is a process.
fn all() -> Vec<(&'static str, Arc<Entry>)> {
    let mut all: Vec<_> = entries(&Catalogue::linked_in()).into_iter().map(|entry| ("linked in", entry)).collect();
    for (form, catalogue) in forms() {
        let of_form = entries(&catalogue).into_iter().map(|entry| (form, entry));
        all.extend(of_form.filter(|(form, entry)| *form != "native and isolated" || entry.descriptor.name == "sobel"));
    }
    all
}

#[test]
fn every_filter_keeps_the_law_in_every_form() {
    for (form, entry) in all() {
        let frames = conformance(&entry);
        let frames = frames.unwrap_or_else(|error| panic!("{} ({form}): {error}", entry.descriptor.name));
        // Defaults and the ends of all ranges at least, in one format and ten sizes, three frames each.
        assert!(frames >= 90, "{} ({form})", entry.descriptor.name);
    }
}

#[test]
fn another_size_or_format_than_agreed_is_an_error_and_no_panic() {
    for (form, entry) in all() {
        let descriptor = entry.descriptor;
        let defaults: Vec<f64> = descriptor.parameters.iter().map(|parameter| parameter.default).collect();
        let mut filter = entry.start(&defaults).unwrap();
        filter.mount(&mount_of(&Settings::default().camera)).unwrap();
        let mut process = |format: Format, width: usize| {
            let bytes = vec![0; 12 * format.channels()];
            let mut out = vec![0; width * 3 * descriptor.writes.channels()];
            let input = Frame::new(4, 3, format, &bytes).unwrap();
            filter.process(input, FrameMut::new(width, 3, descriptor.writes, &mut out).unwrap())
        };
        for format in [Format::Rgb, Format::Grey, Format::Mask, Format::Depth] {
            let reads = descriptor.reads.contains(&format);
            assert_eq!(process(format, 4).is_ok(), reads, "{} ({form}) and {format:?}", descriptor.name);
            assert!(process(format, 3).is_err(), "{} ({form})", descriptor.name);
        }
    }
}

#[test]
fn descriptors_are_complete() {
    for (form, entry) in all() {
        let descriptor = entry.descriptor;
        assert!(descriptor.purpose.ends_with('.') && !descriptor.reads.is_empty(), "{} ({form})", descriptor.name);
        assert!(!descriptor.version.is_empty() && !descriptor.licence.is_empty(), "{}", descriptor.name);
        for parameter in descriptor.parameters {
            assert!(parameter.purpose.ends_with('.') && !parameter.unit.is_empty(), "{}", parameter.name);
        }
    }
}

#[test]
fn a_filter_says_the_same_of_itself_in_every_form() {
    let linked_in = Catalogue::linked_in();
    for (form, entry) in all().into_iter().filter(|(_, entry)| entry.form != Form::LinkedIn) {
        let own = linked_in.find(entry.descriptor.name).unwrap();
        // The C contract has one bit for each format: which one a filter likes best stays at home.
        let told = |descriptor: &Descriptor| {
            let mut reads = descriptor.reads.to_vec();
            reads.sort_by_key(|format| format.bit());
            (reads, format!("{:?}", Descriptor { reads: &[], ..*descriptor }))
        };
        assert_eq!(told(entry.descriptor), told(own.descriptor), "{form}");
    }
}
