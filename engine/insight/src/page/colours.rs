//! The colours of rules can be told apart, whatever a reader's eyes are, and seen on the page.

const STYLE: &str = include_str!("web/style.css");

type Linear = [f64; 3];

/// Machado, Oliveira and Fernandes 2009, severity 1: protan, deutan, tritan; and eyes that see all colours.
const EYES: [[Linear; 3]; 4] = [
    [[0.152_286, 1.052_583, -0.204_868], [0.114_503, 0.786_281, 0.099_216], [-0.003_882, -0.048_116, 1.051_998]],
    [[0.367_322, 0.860_646, -0.227_968], [0.280_085, 0.672_501, 0.047_413], [-0.011_820, 0.042_940, 0.968_881]],
    [[1.255_528, -0.076_749, -0.178_779], [-0.078_411, 0.930_809, 0.147_602], [0.004_733, 0.691_367, 0.303_900]],
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
];

fn times(matrix: &[Linear; 3], colour: Linear) -> Linear {
    matrix.map(|row| row.iter().zip(colour).map(|(factor, part)| factor * part).sum())
}

fn linear(hex: &str) -> Linear {
    [1, 3, 5].map(|at| {
        let value = f64::from(u8::from_str_radix(&hex[at..at + 2], 16).unwrap()) / 255.0;
        if value <= 0.040_45 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
    })
}

/// CIE Lab under D65.
fn lab(colour: Linear) -> Linear {
    let xyz = times(
        &[
            [0.412_456_4, 0.357_576_1, 0.180_437_5],
            [0.212_672_9, 0.715_152_2, 0.072_175_0],
            [0.019_333_9, 0.119_192_0, 0.950_304_1],
        ],
        colour.map(|part| part.clamp(0.0, 1.0)),
    );
    let root = |value: f64| if value > 0.008_856 { libm::cbrt(value) } else { 7.787 * value + 16.0 / 116.0 };
    let [x, y, z] = [xyz[0] / 0.950_47, xyz[1], xyz[2] / 1.088_83].map(root);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Each value of a variable in the style: of the light page, then of the dark one.
fn values(name: &str) -> Vec<&'static str> {
    STYLE.split(&format!("--{name}: ")).skip(1).map(|rest| rest.split(';').next().unwrap()).collect()
}

fn of_page(page: usize) -> [&'static str; 6] {
    [0, 1, 2, 3, 4, 5].map(|rule| values(&format!("rule-{rule}"))[page])
}

#[test]
fn no_two_rules_look_alike_to_any_eyes() {
    for page in [0, 1] {
        for eyes in &EYES {
            let seen = of_page(page).map(|hex| lab(times(eyes, linear(hex))));
            for (index, first) in seen.iter().enumerate() {
                for second in &seen[index + 1..] {
                    let away = first.iter().zip(second).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
                    assert!(away >= 20.0, "page {page}: {first:?} and {second:?} are {away:.1} apart");
                }
            }
        }
    }
}

#[test]
fn every_rule_stands_out_from_the_paper() {
    let luminance = |hex: &str| linear(hex).iter().zip([0.2126, 0.7152, 0.0722]).map(|(a, b)| a * b).sum::<f64>();
    for page in [0, 1] {
        let paper = luminance(values("paper")[page]);
        for hex in of_page(page) {
            let (high, low) = (luminance(hex).max(paper), luminance(hex).min(paper));
            let contrast = (high + 0.05) / (low + 0.05);
            assert!(contrast >= 3.0, "page {page}: {hex} has a contrast of {contrast:.2}");
        }
    }
}

#[test]
fn every_canvas_is_a_picture_with_words_or_hidden_from_readers() {
    let canvases: Vec<_> = include_str!("web/index.html").split("<canvas").skip(1).collect();
    assert_eq!(canvases.len(), 6);
    for canvas in canvases {
        let tag = canvas.split('>').next().unwrap();
        assert!(tag.contains("role=\"img\" aria-label=\"") || tag.contains("aria-hidden=\"true\""), "{tag}");
    }
}
