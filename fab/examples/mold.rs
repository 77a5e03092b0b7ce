//! A mold for one part: `cargo run --release -p weavelock-fab --example mold -- part.stl rigid out [count]`

use std::path::Path;
use std::process::ExitCode;
use weavelock_fab::files::{Batch, obj, stl};
use weavelock_fab::mesh::Mesh;
use weavelock_fab::mold::figures::Figures;
use weavelock_fab::mold::{MoldSpec, Route, check_openscad, make, write};

type Fallible<T> = Result<T, Box<dyn std::error::Error>>;

fn main() -> ExitCode {
    match run(&std::env::args().skip(1).collect::<Vec<_>>()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => {
            eprintln!("error: {e}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &[String]) -> Fallible<()> {
    let [file, route, folder, rest @ ..] = arguments else {
        return Err("give a mesh (STL, OBJ), a route (rigid, silicone, lost-wax) and a folder".into());
    };
    let route = match route.as_str() {
        "rigid" => Route::Rigid,
        "silicone" => Route::Silicone,
        "lost-wax" => Route::LostWax,
        other => return Err(format!("no route \"{other}\"").into()),
    };
    let (name, folder) =
        (Path::new(file).file_stem().unwrap_or_default().to_string_lossy(), Path::new(folder));
    let mut spec = MoldSpec::new(&name, route, Figures::embedded()?);
    spec.count = rest.first().map_or(Ok(1), |c| c.parse())?;
    let part = read(file)?;
    let start = std::time::Instant::now();
    let mold = make(&part, &spec)?;
    eprintln!("made in {:.2?}", start.elapsed());
    let mut batch = Batch::new(folder)?;
    let mut report = write(&mold, &mut batch)?;
    batch.commit()?;
    eprintln!("written and measured after {:.2?}", start.elapsed());
    check_openscad(&mut report, folder, "openscad");
    println!("{}", serde_json::to_string_pretty(&report)?);
    Ok(())
}

fn read(file: &str) -> Fallible<Mesh> {
    if file.ends_with(".obj") {
        return Ok(obj::read(&std::fs::read_to_string(file)?)?);
    }
    Ok(stl::read(&mut std::fs::File::open(file)?)?)
}
