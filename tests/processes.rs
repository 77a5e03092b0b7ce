//! Files of processes: those that come along are sound, copies can be edited, nonsense is refused with its reason.

use weavelock_fab::process::{Measured, Overrides, Process, Route, bed, beds, names, source};

/// What is wrong with a file, as a user is told it.
fn told(text: &str) -> String {
    Process::parse("my.toml", text).expect_err("accepted").to_string()
}

/// The text of a process with something replaced, which has to be there.
fn edited(name: &str, from: &str, to: &str) -> String {
    let text = source(name).expect("a process");
    assert!(text.contains(from), "{name} has no {from:?}");
    text.replacen(from, to, 1)
}

#[test]
fn every_process_that_comes_along_is_sound_and_says_where_its_numbers_come_from() {
    let all: Vec<Process> = names().map(|n| Process::find(n).unwrap_or_else(|e| panic!("{e}"))).collect();
    for name in [
        "fdm-pla",
        "fdm-petg",
        "sla",
        "silicone-platinum",
        "silicone-tin",
        "wax-injected",
        "wax-poured",
        "aluminium-lost-wax",
        "aluminium-lost-pla",
        "pu-resin",
    ] {
        assert!(all.iter().any(|p| p.name == name), "{name}");
    }
    for p in &all {
        assert_eq!(p.cavity.is_none(), p.route == Route::Print, "{}", p.name);
        assert!(!p.schedule.is_empty(), "{}", p.name);
        let figures =
            p.schedule.iter().filter_map(|i| i.figure.as_ref()).chain([&p.clearance, &p.least_wall]);
        assert!(figures.into_iter().all(|f| f.source.len() > 5), "{}", p.name);
    }
    assert!(beds().len() >= 5);
}

#[test]
fn nonsense_is_refused_with_line_and_reason() {
    let bad = [
        (edited("fdm-pla", "value = 0.2\nunit = \"%\"", "value = 80\nunit = \"%\""), "80 % is not possible"),
        (edited("fdm-pla", "value = 0.8", "value = -0.8"), "-0.8 mm is not possible"),
        (edited("fdm-pla", "title =", "titel ="), "unknown key \"titel\""),
        (
            edited("wax-poured", "material = \"silicone\"", "material = \"PLA\""),
            "PLA, which bears no more than 45 C",
        ),
        (
            edited("wax-injected", "material = \"silicone\"", "material = \"PETG\""),
            "PETG, which bears no more than 58 C",
        ),
        (
            edited(
                "silicone-platinum",
                "value = 0.1\nunit = \"%\"\nlow = 0.0\nhigh = 0.1",
                "value = 3\nunit = \"%\"\nlow = 2\nhigh = 4",
            ),
            "heat-cured silicone",
        ),
        (
            edited(
                "silicone-tin",
                "material = \"tin-cure RTV silicone\"",
                "material = \"heat-cured silicone\"",
            ),
            "is heat-cured",
        ),
        (edited("aluminium-lost-wax", "name = \"wax\"", "name = \"investment\""), "is net"),
        (edited("aluminium-lost-wax", "name = \"wax\"", "name = \"silicone\""), "two steps are called"),
        (edited("fdm-pla", "bed = \"prusa-mk4\"", "bed = \"my bed\""), "no bed \"my bed\""),
        (edited("fdm-pla", "unit = \"mm\"", "unit = \"in\""), "one of: mm"),
        (edited("sla", "route = \"print\"", "route = \"forge\""), "one of: print, cast-direct"),
        (edited("pu-resin", "high = 1.20", "high = 0.2"), "are not in order"),
        (edited("wax-injected", "unit = \"kPa\"", "unit = \"bar\""), "one of: C, h, min"),
    ];
    for (text, word) in bad {
        let told = told(&text);
        assert!(told.contains(word), "{word} is not in {told}");
        assert!(told.starts_with("my.toml:") && told.contains("hint: "), "{told}");
        assert!(
            told.split(':').nth(1).is_some_and(|line| line.parse::<usize>().is_ok_and(|l| l > 0)),
            "{told}"
        );
    }
}

/// Silicone that cures hot goes by many names; room-temperature vulcanizing is none of them.
#[test]
fn silicone_that_is_cured_hot_is_refused_by_name_and_by_shrinkage() {
    let tin = "material = \"tin-cure RTV silicone\"";
    let as_material = |word: &str| edited("silicone-tin", tin, &format!("material = \"{word}\""));
    for word in [
        "HTV silicone",
        "peroxide-cured silicone",
        "Hot-cured silicone",
        "silicone rubber (HCR)",
        "LSR silicone",
    ] {
        let told = told(&as_material(word));
        assert!(told.contains("is heat-cured") && told.contains("take platinum-cure"), "{word}: {told}");
    }
    for word in ["room temperature vulcanizing silicone", "RTV-2 silicone, vulcanises at room temperature"] {
        Process::parse("my.toml", &as_material(word)).unwrap_or_else(|e| panic!("{word}: {e}"));
    }
    assert!(told(&edited("silicone-tin", "title = \"", "title = \"heat-cured ")).contains("is heat-cured"));
    let hot = edited(
        "silicone-platinum",
        "value = 0.1\nunit = \"%\"\nlow = 0.0\nhigh = 0.1",
        "value = 3\nunit = \"%\"\nlow = 2\nhigh = 4",
    );
    let renamed = hot.replacen("name = \"silicone\"", "name = \"cure\"", 1);
    assert!(told(&renamed).contains("casts silicone, and 3 % is not possible"), "{}", told(&renamed));
    let own = Overrides { shrinkage: [("cure".into(), 3.0)].into(), ..Overrides::default() };
    let soft = source("silicone-platinum").unwrap().replacen("name = \"silicone\"", "name = \"cure\"", 1);
    let refused = Process::parse("my.toml", &soft).unwrap().with(&own).unwrap_err().to_string();
    assert!(refused.contains("heat-cured"), "{refused}");
}

/// The text of a process with the heat of its pour set, in the cavity and in the schedule.
fn poured_at(name: &str, was: [&str; 2], cavity: &str, schedule: &str) -> String {
    let [pour, line] = was;
    let head = "[cavity.pour] # temperature of what is poured\n";
    edited(name, &format!("{head}value = {pour}"), &format!("{head}value = {cavity}")).replacen(
        &format!("value = {line}, unit = \"C\""),
        &format!("value = {schedule}, unit = \"C\""),
        1,
    )
}

/// Metal and wax below their melting points are refused, in the cavity and in the schedule, each at its line.
#[test]
fn what_is_poured_is_liquid() {
    let line_of = |text: &str, word: &str| 1 + text[..text.find(word).unwrap()].matches('\n').count();
    let cold = poured_at(
        "aluminium-lost-wax",
        ["720\nunit = \"C\"\nlow = 680", "720"],
        "600\nunit = \"C\"\nlow = 590",
        "600",
    )
    .replacen("value = 600, unit = \"C\", low = 680", "value = 600, unit = \"C\", low = 590", 1);
    let both = told(&cold);
    for key in ["[cavity.pour]", "value = 600, unit"] {
        let line = line_of(&cold, key);
        let fault = both
            .lines()
            .find(|l| l.starts_with(&format!("my.toml:{line}:")))
            .unwrap_or_else(|| panic!("{line}: {both}"));
        for word in
            ["aluminium A356", "at 600 C", "not liquid below 615 C", "grade S", "hint: pour it hotter"]
        {
            assert!(fault.contains(word), "{word}: {fault}");
        }
    }
    assert_eq!(both.lines().count(), 2, "{both}");
    let wax =
        edited("wax-injected", "value = 65, unit = \"C\", low = 60", "value = 40, unit = \"C\", low = 30");
    let faults = told(&wax);
    assert!(
        faults.contains("injection wax is to be poured at 40 C, and is not liquid below 46 C"),
        "{faults}"
    );
    // At 720 C bronze is not liquid, at 1100 C gypsum is no investment.
    let bronze = |heat: &str| {
        poured_at(
            "aluminium-lost-pla",
            ["720\nunit = \"C\"\nlow = 680\nhigh = 760", "?"],
            &format!("{heat}\nunit = \"C\"\nlow = {heat}\nhigh = {heat}"),
            "?",
        )
        .replacen("material = \"aluminium A356\"", "material = \"bronze CuSn10\"", 1)
    };
    assert!(
        told(&bronze("720"))
            .contains("bronze CuSn10 is to be poured at 720 C, and is not liquid below 850 C")
    );
    assert!(told(&bronze("1100")).contains("gypsum breaks down"));
}

#[test]
fn the_cavity_and_the_schedule_pour_at_the_same_heat() {
    let metal = edited("aluminium-lost-pla", "value = 720, unit", "value = 700, unit");
    let faults = told(&metal);
    let line = 1 + metal[..metal.find("value = 700, unit").unwrap()].matches('\n').count();
    assert!(faults.starts_with(&format!("my.toml:{line}:")), "{line}: {faults}");
    assert!(faults.contains("at 700 C, and the cavity is said to be filled at 720 C"), "{faults}");
    let no_figure = edited("wax-poured", "melts = \"beeswax or paraffin\"", "melts = \"\"");
    assert!(told(&no_figure).contains("\"melts\" is not a text"));
    let hours = edited("pu-resin", "stage = \"resin\"", "melts = \"polyurethane resin\"\nstage = \"resin\"");
    assert!(told(&hours).contains("has no figure in C"), "{}", told(&hours));
    let both = poured_at("wax-poured", ["85", "85"], "84", "84");
    assert_eq!(Process::parse("my.toml", &both).unwrap().cavity.unwrap().pour.value, 84.0);
}

/// Of every metal and wax that comes along it is known when it is liquid; resin and silicone do not melt.
#[test]
fn of_what_melts_it_is_known_when() {
    for p in names().map(|n| Process::find(n).unwrap()) {
        let Some(cavity) = &p.cavity else { continue };
        let melts = p.route.is_metal() || p.material.contains("wax");
        assert_eq!(cavity.liquid.is_some(), melts, "{}", p.name);
        let poured = |i: &weavelock_fab::process::Instruction| i.melts.as_ref() == Some(&p.material);
        assert_eq!(p.schedule.iter().filter(|i| poured(i)).count(), usize::from(melts), "{}", p.name);
    }
}

#[test]
fn a_route_has_its_cavity_and_its_schedule() {
    let lost = |name: &str| source(name).unwrap().split("[[schedule]]").next().unwrap().to_string();
    let bad = [
        (
            edited("wax-injected", "route = \"cast\"", "route = \"lost-wax\""),
            "metal is poured into investment",
        ),
        (
            edited("aluminium-lost-wax", "route = \"lost-wax\"", "route = \"cast\""),
            "goes through a silicone mold",
        ),
        (edited("pu-resin", "route = \"cast\"", "route = \"cast-direct\""), "goes into a printed mold"),
        (edited("pu-resin", "route = \"cast\"", "route = \"print\""), "a printed part has no cavity"),
        (lost("pu-resin"), "\"schedule\" is missing"),
    ];
    for (text, word) in bad {
        let told = told(&text);
        assert!(told.contains(word) && told.contains("hint: "), "{word} is not in {told}");
    }
    assert!(Process::parse("my.toml", &lost("fdm-pla")).is_ok(), "a print needs no schedule");
}

#[test]
fn all_faults_of_a_file_are_told_at_once() {
    let text = edited("wax-poured", "material = \"silicone\"", "material = \"PLA\"")
        .replacen("value = 0.15", "value = -1", 1)
        .replacen("supports", "support", 1)
        .replacen("grade = \"S\"", "grade = \"Z\"", 1);
    let told = told(&text);
    for word in
        ["bears no more", "-1 mm", "unknown key \"support\"", "\"supports\" is missing", "one of: S, 2, I, M"]
    {
        assert!(told.contains(word), "{word} is not in {told}");
    }
}

#[test]
fn the_coupon_replaces_the_figure_of_each_step_that_was_measured() {
    let wax = Process::find("wax-injected").unwrap();
    let with = |texts: &[&str]| {
        let measured = texts.iter().map(|t| Measured::parse(t).unwrap()).collect();
        wax.with(&Overrides { measured, ..Overrides::default() })
    };
    let steps = |p: &Process| p.steps.iter().map(|s| s.shrinkage.value).collect::<Vec<_>>();
    let p = with(&["print=59.70", "wax=58.80 mm"]).unwrap();
    // Before the wax there is the silicone, which was not measured: 59.70 less a thousandth.
    let expected = [0.5, 0.1, 100.0 * (1.0 - 58.80 / (59.70 * 0.999))];
    assert!(steps(&p).iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{:?}", steps(&p));
    assert!(p.steps[0].shrinkage.source.contains("59.7"));
    let told = with(&["print=40", "metal=58"]).unwrap_err().to_string();
    assert!(
        told.contains("print: a bar of 40 mm after it, and so a shrinkage of 33.3333 %")
            && told.contains("step \"metal\""),
        "{told}"
    );
    for bad in ["print", "print=", "=59", "print=long", "print=inf"] {
        assert!(Measured::parse(bad).is_err(), "{bad}");
    }
}

#[test]
fn beds_go_by_name_or_by_size() {
    assert_eq!(bed("prusa-mk4").unwrap().size, [250.0, 210.0, 220.0]);
    for text in ["300 x 300 x 400 mm", "300x300x400", "300 X 300 \u{d7} 400"] {
        assert_eq!(bed(text).unwrap().size, [300.0, 300.0, 400.0], "{text}");
    }
    for text in [
        "",
        "prusa",
        "300 x 300",
        "300 x 300 x -1",
        "300 x 300 x nan",
        "1 x 1 x 1",
        "1e9 x 1 x 1",
        "3 x 3 x 3 x 3",
    ] {
        assert!(bed(text).unwrap_err().contains("prusa-mk4"), "{text}");
    }
}
