//! Promises of lost-wax trees: as many patterns as the flask takes, spread evenly, and a picture of tree and flask opened.

use super::*;

/// As few trees as hold all, none with more than the flask of the oven takes, and no row too many.
#[test]
fn patterns_that_do_not_fit_go_on_further_trees() {
    let mut figures = Figures::embedded().unwrap();
    let tree = |count: usize, figures: &Figures| {
        let order = MoldSpec { count, ..MoldSpec::new("tree", Route::LostWax, figures.clone()) };
        make(&drilled(), &order).unwrap()
    };
    let height = |mold: &Mold| {
        let flask = mold.pieces.iter().find(|p| p.kind == Kind::Flask).unwrap();
        let (low, high) = flask.mesh.bounds();
        high.z - low.z
    };
    let all = tree(5, &figures);
    assert!(all.castings == 5 && !all.findings.iter().any(|f| f.what.contains("the flask is")));
    let many = tree(40, &figures);
    let trees = 40usize.div_ceil(many.castings);
    assert!(
        trees > 1 && many.castings * (trees - 1) < 40 && many.castings * trees < 40 + trees,
        "{}",
        many.castings
    );
    assert!(height(&many) <= figures.flask_height.value, "{}", height(&many));
    figures.flask_height.value = height(&all) + 1e-6;
    assert_eq!(tree(5, &figures).castings, 5);
    figures.flask_height.value = height(&all) - 1.0;
    let fewer = tree(5, &figures);
    assert!(fewer.castings < 5 && height(&fewer) <= figures.flask_height.value, "{}", fewer.castings);
    // One row stays, whatever the oven; it is told.
    figures.flask_height.value = 50.0;
    let one = tree(5, &figures);
    assert!(one.castings > 0 && height(&one) > 50.0);
    assert!(one.findings.iter().any(|f| f.what.contains("the flask is") && f.what.contains("50 mm")));
}

/// Colours as the picture has them before light falls on them.
const SHOWN: [(&str, [u8; 3]); 5] = [
    ("pattern", [150, 180, 210]),
    ("gate", [214, 110, 80]),
    ("runner", [210, 180, 140]),
    ("flask", [130, 134, 140]),
    ("investment", [228, 224, 214]),
];

/// Whether a pixel has this colour in some light: rounding to a byte is half a level, on three channels against one brightness.
fn lit(pixel: &[u8], colour: [u8; 3]) -> bool {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (p, c) = ([pixel[0], pixel[1], pixel[2]].map(f64::from), colour.map(f64::from));
    let bright = dot(p, c) / dot(c, c);
    (0.3..=1.01).contains(&bright) && (0..3).all(|k| (p[k] - bright * c[k]).abs() <= 1.0)
}

/// In three views: the tree alone, in half a flask, and half the investment without it; the files name the picture.
#[test]
fn the_picture_of_a_tree_shows_it_with_flask_and_investment_cut_open() {
    let mold = make(&drilled(), &MoldSpec { count: 5, ..spec("tree", Route::LostWax) }).unwrap();
    assert!(measured(&mold).files.contains(&"tree.opened.png".to_string()));
    let picture = mold.extras.iter().find(|e| e.name == "tree.opened.png").unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(&picture.bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    let mut seen = [[0usize; 3]; SHOWN.len()];
    for (at, pixel) in pixels.chunks_exact(3).enumerate() {
        let third = at % info.width as usize * 3 / info.width as usize;
        SHOWN.iter().enumerate().filter(|(_, s)| lit(pixel, s.1)).for_each(|(k, _)| seen[k][third] += 1);
    }
    // A view is a third of the picture: what is shown in it, gates too, fills more than a thousandth of that; what is not, no
    // more than pixels on borders that are a mean of others.
    let view = (info.width * info.height) as usize / 3;
    let shown = seen.map(|n| n.map(|n| n > view / 1000));
    let expected = [
        [true, true, false],
        [true, true, false],
        [true, true, false],
        [false, true, true],
        [false, false, true],
    ];
    assert_eq!(shown, expected, "{seen:?} of {view}");
}
