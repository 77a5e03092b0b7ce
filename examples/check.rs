use std::time::Instant;
use weavelock::{assembly::woven, contact, locking::*, spec::*, weave::*};
fn main() {
    let v: Vec<f64> = std::env::args().skip(1).map(|a| a.parse().unwrap()).collect();
    let weave = Weave::abc(v[0] as u32, v[1] as u32, v[2] as i32).unwrap();
    let profile = ProfileSpec {
        shape: Shape::Rise(0.6),
        lift: 1.,
        cover: 1.,
        samples: v[3] as u32,
        bounds: Bounds::Sandwich,
    };
    let (n, k, phase) = (v[4] as u32, v[5] as u32, v[6] as i32);
    let layout = Layout::Swatch {
        wefts: n,
        warps: n,
        cut: if k == 0 { Cut::Window } else { Cut::Tiles },
        repeat: k.max(1),
        phase,
    };
    let w = WovenSpec { weave, profile, layout, held: HeldSpec::None, pitch_mm: 20. };
    let spec = Spec {
        name: "x".into(),
        subject: Subject::Woven(w.clone()),
        fab: None,
        file: "x".into(),
        places: Default::default(),
    };
    let t0 = Instant::now();
    let woven = woven::build(&spec, &w).unwrap();
    let t1 = Instant::now();
    let patches = contact::woven::patches(&woven);
    let t2 = Instant::now();
    let c = check(&woven.assembly, &patches, v.get(7).map(|&p| weavelock::assembly::PartIx(p as u32)));
    let t3 = Instant::now();
    let size = |v: &Verdict| match v {
        Verdict::Locked(s) => format!(
            "locked {} forces rank {} residual {:.1e} pivot {:.1e} max {:.1}",
            s.forces.len(),
            s.rank,
            s.residual,
            s.smallest_pivot,
            s.forces.iter().map(|f| f.size).fold(0., f64::max)
        ),
        Verdict::Free(m) => format!("free opening {:.3} worst {:.1e}", m.opening, m.worst),
        Verdict::Undecided(g) => format!("undecided {} {}", g.why, g.size),
    };
    println!(
        "{:?} parts {} patches {} rows {} build {:.0} contact {:.0} check {:.0} ms\n  T {}\n  R {}",
        &v,
        woven.assembly.parts.len(),
        patches.len(),
        c.rows,
        (t1 - t0).as_secs_f64() * 1e3,
        (t2 - t1).as_secs_f64() * 1e3,
        (t3 - t2).as_secs_f64() * 1e3,
        size(&c.translation),
        size(&c.rigid)
    );
}
