use std::time::Instant;
use weavelock::{sites::Sites, spec::*, tile::*, weave::*};
fn main() {
    let v: Vec<f64> = std::env::args().skip(1).map(|a| a.parse().unwrap()).collect();
    let weave = Weave::abc(v[0] as u32, v[1] as u32, v[2] as i32).unwrap();
    let profile = ProfileSpec {
        shape: Shape::Rise(v[4]),
        lift: v[5],
        cover: v[6],
        samples: v[3] as u32,
        bounds: if v.len() > 7 { Bounds::Prism } else { Bounds::Sandwich },
    };
    let n = (v[0] + v[1]) as i32;
    for _ in 0..3 {
        let t0 = Instant::now();
        let sites = Sites::new(&weave, &profile).unwrap();
        let lattice = Lattice::new(&weave.draft);
        let t1 = Instant::now();
        for kind in [Kind::Weft, Kind::Warp] {
            let p = Piece { strand: Strand { kind, index: 0 }, from: 0, to: n };
            let t2 = Instant::now();
            let t = tiles(&sites, &lattice, &[p]);
            let ms = t2.elapsed().as_secs_f64() * 1e3;
            match t {
                Ok(t) => {
                    let s = &t[0].solid;
                    let mut short = f64::INFINITY;
                    for f in &s.facets {
                        for k in 0..f.corners.len() {
                            let d = (s.vertices[f.corners[k] as usize]
                                - s.vertices[f.corners[(k + 1) % f.corners.len()] as usize])
                                .length();
                            short = short.min(d);
                        }
                    }
                    let plan = s
                        .facets
                        .iter()
                        .flat_map(|f| {
                            let p0 = s.vertices[f.corners[0] as usize];
                            f.corners.iter().map(move |&c| (s.vertices[c as usize] - p0).dot(f.normal).abs())
                        })
                        .fold(0.0, f64::max);
                    println!(
                        "{kind:?} sites {:.1}ms tile {ms:.1} ms cells {} V {} F {} vol {:.9} cellvol {:.9} short {short:.2e} nonplanar {plan:.2e}",
                        (t1 - t0).as_secs_f64() * 1e3,
                        s.cells.len(),
                        s.vertices.len(),
                        s.facets.len(),
                        s.volume(),
                        s.cells
                            .iter()
                            .map(|c| weavelock::solid::Solid {
                                vertices: c.vertices.clone(),
                                facets: c
                                    .facets
                                    .iter()
                                    .map(|f| weavelock::solid::Facet {
                                        corners: f.clone(),
                                        normal: Default::default()
                                    })
                                    .collect(),
                                cells: vec![]
                            }
                            .volume())
                            .sum::<f64>()
                    );
                }
                Err(e) => println!("{kind:?} {e}"),
            }
        }
    }
}
