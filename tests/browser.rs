//! What a page promises in a real browser: headless Chromium, driven over a pipe. Where there is none, or it has no
//! WebGL 2, the tests say "not run" and check nothing.

use crate::support::{joined, window};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};
use weavelock::contact::Joined;
use weavelock::report::content::{Answer, Chapter, Format, Picture};
use weavelock::report::draw::mesh::CreaseAngle;
use weavelock::report::draw::{Background, Scene};
use weavelock::report::draw::{Image, Item, Mesh, Size, View, figures, palette, render};
use weavelock::report::moves;
use weavelock::report::page::{PageInput, page};
use weavelock::report::viewer::{Answers, of_assembly};

/// The wait for one answer: a picture of 2,000 parts in software takes seconds, on a busy machine many.
const PATIENCE: Duration = Duration::from_secs(120);

pub struct Browser {
    child: Child,
    answers: Receiver<Value>,
    number: u64,
    session: Option<String>,
    /// What the page said or threw.
    heard: Vec<Value>,
    folder: PathBuf,
}

impl Browser {
    /// `None`: no browser here.
    fn open(flags: &[&str]) -> Option<Browser> {
        let names = ["chromium", "chromium-browser", "google-chrome"];
        let works = |n: &&&str| {
            Command::new(n).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
        };
        let Some(name) = names.iter().find(works) else {
            println!("not run: no Chromium on this machine");
            return None;
        };
        // One for each browser: of one that was killed, some processes may go on writing for a moment.
        static OPENED: AtomicUsize = AtomicUsize::new(0);
        let count = OPENED.fetch_add(1, Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("weavelock-browser-{}-{count}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder for the browser");
        // The pipe's ends are the descriptors 3 and 4.
        let script = format!("exec {name} \"$@\" 3<&0 4>&1 1>/dev/null 2>/dev/null");
        let profile = format!("--user-data-dir={}", folder.display());
        let own = [
            "--headless=new",
            "--no-sandbox",
            "--disable-dev-shm-usage",
            "--no-first-run",
            "--remote-debugging-pipe",
            &profile,
        ];
        let mut child = Command::new("sh")
            .args(["-c", &script, "sh"])
            .args(own)
            .args(flags)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("a shell");
        let (send, answers) = channel();
        let mut out = BufReader::new(child.stdout.take().expect("a pipe"));
        std::thread::spawn(move || {
            let mut message = Vec::new();
            while matches!(out.read_until(0, &mut message), Ok(n) if n > 0) {
                message.pop();
                let read = serde_json::from_slice(&message).unwrap_or(Value::Null);
                message.clear();
                if send.send(read).is_err() {
                    break;
                }
            }
        });
        let mut browser = Browser { child, answers, number: 0, session: None, heard: Vec::new(), folder };
        let target = browser.call("Target.createTarget", json!({"url": "about:blank"}))["targetId"].clone();
        let attached = browser.call("Target.attachToTarget", json!({"targetId": target, "flatten": true}));
        browser.session = attached["sessionId"].as_str().map(String::from);
        ["Page.enable", "Runtime.enable", "Log.enable"].iter().for_each(|m| drop(browser.call(m, json!({}))));
        Some(browser)
    }

    /// With WebGL drawn by the processor.
    pub fn with_webgl() -> Option<Browser> {
        Browser::open(&["--use-angle=swiftshader", "--enable-unsafe-swiftshader"])
    }

    pub fn call(&mut self, method: &str, params: Value) -> Value {
        self.number += 1;
        let mut message = json!({"id": self.number, "method": method, "params": params});
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        let pipe = self.child.stdin.as_mut().expect("a pipe");
        pipe.write_all(format!("{message}\0").as_bytes())
            .and_then(|()| pipe.flush())
            .expect("the browser listens");
        loop {
            let answer = self.answers.recv_timeout(PATIENCE).unwrap_or_else(|e| panic!("{method}: {e}"));
            if answer["id"] == json!(self.number) {
                assert!(answer["error"].is_null(), "{method}: {answer}");
                return answer["result"].clone();
            }
            self.heard.push(answer);
        }
    }

    /// The value of an expression; a promise is waited for.
    pub fn ask(&mut self, expression: &str) -> Value {
        let params = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let answer = self.call("Runtime.evaluate", params);
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {answer}");
        answer["result"]["value"].clone()
    }

    /// Waits until the text of an element holds these words: a page tells of a step when its next frame is drawn, and on a
    /// busy machine that takes its time.
    pub fn reads(&mut self, element: &str, words: &str) {
        let text = format!("document.querySelector('{element}').textContent");
        let start = Instant::now();
        while !self.ask(&text).as_str().is_some_and(|t| t.contains(words)) {
            assert!(start.elapsed() < PATIENCE, "{words:?} is not in {}", self.ask(&text));
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    pub fn load(&mut self, html: &str) {
        let file = self.folder.join("page.html");
        std::fs::write(&file, html).expect("a page");
        let size = json!({"width": 700, "height": 700, "deviceScaleFactor": 1, "mobile": false});
        self.call("Emulation.setDeviceMetricsOverride", size);
        // A picture beyond the viewport is laid out without them: the canvas would be another one than measured.
        self.call("Emulation.setScrollbarsHidden", json!({"hidden": true}));
        self.call("Page.navigate", json!({"url": format!("file://{}", file.display())}));
        let ready = "document.readyState === 'complete' && (!!window.weavelock || !!document.querySelector('[role=status]'))";
        let waited = (0..600).any(|_| {
            std::thread::sleep(Duration::from_millis(50));
            self.ask(ready) == json!(true)
        });
        assert!(waited, "the page never got ready: {:?}", self.complaints());
    }

    /// Console messages and exceptions. Not counted: the driver's remark that reading pixels waits for the picture. That
    /// wait is what the timing of a frame and the count of visible parts ask for, and the remark may arrive at any time
    /// after it.
    pub fn complaints(&self) -> Vec<String> {
        let loud = ["Runtime.consoleAPICalled", "Runtime.exceptionThrown", "Log.entryAdded"];
        let asked_for = |h: &Value| {
            let entry = &h["params"]["entry"];
            let text = entry["text"].as_str().unwrap_or_default();
            entry["source"] == json!("rendering") && text.contains("GPU stall due to ReadPixels")
        };
        let said = self.heard.iter().filter(|h| loud.iter().any(|m| h["method"] == json!(m)));
        said.filter(|h| !asked_for(h)).map(|h| h["params"].to_string()).collect()
    }

    pub fn key(&mut self, key: &str, code: u32) {
        for kind in ["keyDown", "keyUp"] {
            self.call(
                "Input.dispatchKeyEvent",
                json!({"type": kind, "key": key, "windowsVirtualKeyCode": code}),
            );
        }
    }

    /// The canvas as it is on the screen.
    pub fn canvas(&mut self) -> Rgba {
        let place = self.ask("(() => { const b = document.querySelector('canvas').getBoundingClientRect(); return [b.x, b.y, b.width, b.height]; })()");
        let n = |k: usize| place[k].as_f64().expect("a number");
        let clip = json!({"x": n(0), "y": n(1), "width": n(2), "height": n(3), "scale": 1});
        let shot = self.call(
            "Page.captureScreenshot",
            json!({"format": "png", "clip": clip, "captureBeyondViewport": true}),
        );
        decoded(&unbase64(shot["data"].as_str().expect("a picture")))
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

pub fn unbase64(text: &str) -> Vec<u8> {
    let value = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let letters: Vec<u8> = text.bytes().filter(|c| *c != b'=').collect();
    let group = |g: &[u8]| {
        let word = (0..4).fold(0u32, |w, k| w << 6 | g.get(k).map_or(0, |c| u32::from(value(*c))));
        [(word >> 16) as u8, (word >> 8) as u8, word as u8][..g.len() - 1].to_vec()
    };
    letters.chunks(4).flat_map(group).collect()
}

/// Pixels with 3 or 4 bytes each.
pub struct Rgba {
    pub width: u32,
    pub height: u32,
    pub colours: Vec<[u8; 3]>,
}

fn decoded(bytes: &[u8]) -> Rgba {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
    let mut raw = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut raw).expect("a picture");
    let colours = raw.chunks_exact(info.color_type.samples()).map(|p| [p[0], p[1], p[2]]).collect();
    Rgba { width: info.width, height: info.height, colours }
}

/// Share of the warm pixels (red well above blue) among those that are clearly warm or cool.
fn warm_share(colours: impl Iterator<Item = [u8; 3]>) -> f64 {
    // Paper and ink are grey: their channels lie closer together than these colours' in any light.
    const APART: i32 = 24;
    let (mut warm, mut all) = (0.0, 0.0);
    for c in colours {
        let difference = i32::from(c[0]) - i32::from(c[2]);
        warm += f64::from(u8::from(difference > APART));
        all += f64::from(u8::from(difference.abs() > APART));
    }
    assert!(all > 0.0, "an empty picture");
    warm / all
}

fn of_image(image: &Image) -> impl Iterator<Item = [u8; 3]> + '_ {
    let (w, h) = (image.size().width(), image.size().height());
    let seen = (0..h).flat_map(move |y| (0..w).filter_map(move |x| image.pixel(x, y)));
    seen.filter(|p| p[3] > 200).map(|p| [p[0], p[1], p[2]])
}

pub fn bare(exhibits: Vec<weavelock::report::viewer::Exhibit>, pictures: Vec<Picture>) -> PageInput {
    let none = || Answer::not_run("a test");
    PageInput {
        title: "a page".into(),
        lead: "for a browser".into(),
        pictures,
        exhibits,
        draft: none(),
        verdict: Answer::Given(Chapter::default()),
        plan: none(),
        blocking: none(),
        flexible: none(),
        repeats: none(),
        chirality: none(),
        parts: none(),
        molds: none(),
        ledger: none(),
        findings: none(),
        limits: vec![],
    }
}

/// Steps of all kinds: single parts up, one by a screw, two at once. Only to be shown; nothing says that it can be done.
pub fn shown_plan(joined: &Joined) -> Value {
    let ids: Vec<&str> = joined.assembly.parts.iter().map(|p| p.id.as_str()).collect();
    let up = |k: usize| json!({"parts": [ids[k]], "kind": "translation", "direction": [0.0, 0.6, 0.8], "distance": 3.0 + (k % 7) as f64, "clear": 0.0, "stays": &ids[k + 1..]});
    let mut steps: Vec<Value> = (0..ids.len() - 3).map(up).collect();
    let [a, b, c] = [ids[ids.len() - 3], ids[ids.len() - 2], ids[ids.len() - 1]];
    steps.push(json!({"parts": [a], "kind": "screw", "point": [1.0, 2.0, 0.0], "axis": [0.0, 0.6, 0.8], "angle": 2.5, "advance": 1.5, "ends": "inside", "clear": 0.0, "stays": [b, c]}));
    steps.push(json!({"parts": [a, b], "kind": "several", "ends": "apart", "clear": 0.0, "stays": [c], "motions": [
        {"parts": [a], "kind": "translation", "direction": [1.0, 0.0, 0.0], "distance": 2.0},
        {"parts": [b], "kind": "screw", "point": [0.0, 0.0, 1.0], "axis": [1.0, 0.0, 0.0], "angle": -1.0, "advance": 0.0}]}));
    json!({"outcome": "assembled", "clearance_mm": 0.0, "steps": steps})
}

/// `wefts` x `warps` plain strands in pieces of one unit tile: as many parts as the product.
pub fn swatch(wefts: u32, warps: u32) -> Joined {
    let layout = format!("wefts = {wefts}\nwarps = {warps}\ncut = \"tiles\"\nrepeat = 1\n");
    let joined = joined(&crate::support::woven([1, 1, 1], 8, &format!("[swatch]\n{layout}")));
    assert_eq!(joined.assembly.parts.len() as u32, wefts * warps);
    joined
}

fn page_of(joined: &Joined, plan: Option<Value>) -> String {
    let answers = Answers { plan, ..Answers::default() };
    page(&bare(vec![of_assembly(joined, &answers)], vec![]))
}

/// Largest difference between where the page has the parts and where the plan says, after `done` steps.
fn misplaced(browser: &mut Browser, joined: &Joined, plan: &Value, done: f64) -> f64 {
    let ids: Vec<&str> = joined.assembly.parts.iter().map(|p| p.id.as_str()).collect();
    let meant = moves::displacements(&moves::read(&plan["steps"], &ids).moves, ids.len(), done);
    let found = browser.ask("weavelock.parts().map((id) => weavelock.pose(id))");
    let off = |k: usize| {
        let columns = meant[k].to_cols_array();
        (0..12).map(|c| (found[k][c].as_f64().expect("a number") - columns[c]).abs()).fold(0.0, f64::max)
    };
    (0..ids.len()).map(off).fold(0.0, f64::max)
}

/// Round-off of poses in f64: a few hundred operations on lengths up to 100 units.
const ROUND_OFF: f64 = 1e-11;

#[test]
fn steps_move_the_parts_to_where_the_plan_says() {
    let Some(mut browser) = Browser::with_webgl() else { return };
    let joined = swatch(2, 10);
    let plan = shown_plan(&joined);
    browser.load(&page_of(&joined, Some(plan.clone())));
    assert_eq!(browser.ask("weavelock.parts().length"), json!(20));
    let step = "[...document.querySelectorAll('button')].find((b) => b.getAttribute('aria-label').startsWith('Next step')).click()";
    for k in 1..=19 {
        browser.ask(step);
        assert_eq!(browser.ask("weavelock.done()"), json!(k));
        let off = misplaced(&mut browser, &joined, &plan, f64::from(k));
        assert!(off < ROUND_OFF, "after step {k}: {off}");
    }
    browser.reads("[aria-live]", "step 19 of 19");
    // Backward, to a share of a step, and by keys.
    for done in [18.25, 0.5, 17.75, 0.0] {
        browser.ask(&format!("weavelock.go({done})"));
        let off = misplaced(&mut browser, &joined, &plan, done);
        assert!(off < ROUND_OFF, "at {done}: {off}");
    }
    browser.ask("document.querySelector('canvas').focus()");
    ["n", "n", "p"].iter().for_each(|k| browser.key(k, 0));
    assert_eq!(browser.ask("weavelock.done()"), json!(1));
    assert_eq!(browser.complaints(), Vec::<String>::new());
}

/// Both pictures show the same parts from nearly the same place (the viewer fits a drum, the still picture each corner);
/// what a few degrees of perspective hide or show of a side is less than this share.
const VIEWS_DIFFER: f64 = 0.03;

#[test]
fn the_live_picture_shows_what_the_still_one_shows() {
    let Some(mut browser) = Browser::with_webgl() else { return };
    let joined = joined(&window([1, 1, 1], 8, 2, 2));
    let plan = shown_plan(&joined);
    browser.load(&page_of(&joined, Some(plan.clone())));
    let asm = &joined.assembly;
    let ids: Vec<&str> = asm.parts.iter().map(|p| p.id.as_str()).collect();
    let read = moves::read(&plan["steps"], &ids).moves;
    for done in [0usize, 1, 2] {
        let settled = format!("weavelock.go({done}); new Promise((r) => setTimeout(r, 600))");
        browser.ask(&settled);
        let live = browser.canvas();
        let moved = moves::displacements(&read, ids.len(), done as f64);
        let mut scene = Scene { background: Background::Transparent, ..Scene::of(asm, View::default()) };
        let on: Vec<usize> =
            if done == 0 { (0..4).collect() } else { moves::on_table(&read[done - 1]).collect() };
        scene.items.iter_mut().zip(&moved).for_each(|(i, d)| i.pose = *d * i.pose);
        scene.items = on.iter().map(|&k| scene.items[k].clone()).collect();
        let still = render(&scene, Size::new(live.width, live.height).expect("a size"));
        // Faint parts would count as neither; they are left out of both.
        browser.ask("weavelock.state.left = 'none'; weavelock.draw()");
        let live = browser.canvas();
        let (a, b) = (warm_share(live.colours.into_iter()), warm_share(of_image(&still)));
        println!("after {done} steps: {a:.3} of the live picture is warm, {b:.3} of the still one");
        assert!((a - b).abs() < VIEWS_DIFFER, "after {done} steps: {a:.3} live, {b:.3} still");
    }
    assert_eq!(browser.complaints(), Vec::<String>::new());
}

#[test]
fn without_webgl_the_still_picture_stays_and_says_so() {
    let Some(mut browser) = Browser::open(&["--disable-3d-apis", "--disable-gpu", "--mute-audio"]) else {
        return;
    };
    let joined = joined(&window([1, 1, 1], 4, 2, 2));
    let still =
        figures::together(&joined.assembly).picture(Size::new(80, 60).expect("a size")).expect("a picture");
    assert!(matches!(still.format, Format::Png(_)));
    browser.load(&page(&bare(vec![of_assembly(&joined, &Answers::default())], vec![still])));
    let seen = "[document.querySelector('.still img').getBoundingClientRect().width > 0, document.querySelector('canvas') === null, document.querySelector('[role=status]').textContent.includes('WebGL')]";
    assert_eq!(browser.ask(seen), json!([true, true, true]));
}

/// Frame times of the processor's own WebGL, and what is promised at any size.
fn at_size(wefts: u32, warps: u32) {
    let Some(mut browser) = Browser::with_webgl() else { return };
    let joined = swatch(wefts, warps);
    let plan = shown_plan(&joined);
    let html = page_of(&joined, Some(plan.clone()));
    browser.load(&html);
    let count = wefts * warps;
    assert_eq!(browser.ask("weavelock.steps()"), json!(count - 1));
    let last = f64::from(count) - 1.0;
    for done in [1.0, last / 2.0 + 0.5, last] {
        browser.ask(&format!("weavelock.go({done})"));
        let off = misplaced(&mut browser, &joined, &plan, done);
        assert!(off < ROUND_OFF, "at {done}: {off}");
    }
    browser.ask("weavelock.go(0)");
    let mut time = |rough: bool| {
        let times = browser
            .ask(&format!("[0, 0, 0, 0, 0].map(() => weavelock.frame({rough})).sort((a, b) => a - b)"));
        times[2].as_f64().expect("a time")
    };
    let (moving, full) = (time(true), time(false));
    let shares = browser.ask("weavelock.shares()");
    let all: f64 = shares.as_object().expect("shares").values().filter_map(Value::as_f64).sum();
    assert!((all - 1.0).abs() < 1e-9 && shares.as_object().is_some_and(|s| s.len() as u32 > count / 2));
    assert_eq!(browser.complaints(), Vec::<String>::new());
    println!(
        "{count} parts, {} triangles, page of {} kB: {moving:.0} ms a frame while it moves, {full:.0} ms at rest (WebGL in software)",
        browser.ask("weavelock.triangles()"),
        html.len() / 1000
    );
}

#[test]
#[ignore = "a few seconds of software WebGL"]
fn twenty_and_two_hundred_parts() {
    at_size(2, 10);
    at_size(10, 20);
}

#[test]
#[ignore = "half a minute of software WebGL"]
fn two_thousand_parts() {
    at_size(40, 50);
}

/// Kept beside the tests that use them, so that a change of the palette is seen here.
#[test]
fn wefts_are_warm_and_warps_cool_in_pixels() {
    let cube = Item::new(
        std::sync::Arc::new(Mesh::of(
            &joined(&window([1, 1, 1], 4, 2, 2)).assembly.solids[0],
            CreaseAngle::default(),
        )),
        palette::of_part("weft-0", 0),
    );
    let scene = |colour| Scene {
        items: vec![Item { colour, ..cube.clone() }],
        view: View::default(),
        background: Background::Transparent,
    };
    let size = Size::new(60, 60).expect("a size");
    let share = |id: &str| warm_share(of_image(&render(&scene(palette::of_part(id, 0)), size)));
    assert!(share("weft-0") > 0.99 && share("warp-0") < 0.01, "{} {}", share("weft-0"), share("warp-0"));
}
