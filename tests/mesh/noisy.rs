//! Made assemblies written as files in every format, turned: the verdict must be the one they were made for.

use super::files::{Format, Put, write};
use super::made::all;
use std::path::Path;
use weavelock::contact::{Joined, join};
use weavelock::locking::{Verdict, check};
use weavelock::spec;

pub fn judged(spec_file: &Path) -> Result<(Joined, [Verdict; 2]), String> {
    let spec = spec::read(spec_file).map_err(|f| f.to_string())?;
    let joined = join(&spec).map_err(|f| f.to_string())?;
    let check = check(&joined.assembly, &joined.patches, None);
    Ok((joined, [check.translation, check.rigid]))
}

#[test]
#[ignore = "to look at"]
fn look() {
    let dir = std::env::temp_dir().join(format!("weavelock-made-{}", std::process::id()));
    let axis = [1., 2., -0.5];
    let puts = [
        Put::turned(axis, 0.0, Format::ObjFull),
        Put::turned(axis, 1.234, Format::ObjFull),
        Put::turned(axis, 1.234, Format::StlBinary),
        Put::turned(axis, 1.234, Format::StlText),
        Put::turned(axis, 1.234, Format::Obj(6)),
        Put::turned(axis, 1.234, Format::Obj(5)),
        Put::turned(axis, 1.234, Format::Obj(4)),
        Put::turned(axis, 1.234, Format::ObjSignificant(6)),
        Put::turned(axis, 1.234, Format::ThreeMf),
    ];
    let only = std::env::var("ONLY").unwrap_or_default();
    let (mut wrong, mut all_count) = (0, 0);
    for made in all().iter().filter(|m| m.name.contains(&only)) {
        let mut line = format!("{:28} {:?}:", made.name, made.want);
        for put in puts {
            all_count += 1;
            match judged(&write(made, put, "0.001 mm", &dir)) {
                Ok((j, v)) if v.each_ref().map(|v| v.word()) == made.want => {
                    if std::env::var("MORE").is_ok() {
                        println!("{} {:?} {:?} {:?}", made.name, put.format, j.remarks, v[1]);
                    }
                    line += " ok";
                }
                Ok((j, v)) => {
                    wrong += 1;
                    let w = v.each_ref().map(|v| &v.word()[..1]).concat();
                    line += &format!(" {w}!{:?}({} patches)", put.format, j.patches.len());
                    if std::env::var("MORE").is_ok() {
                        println!("{:?} {:?}", j.remarks, v);
                    }
                }
                Err(e) => {
                    wrong += 1;
                    line += &format!(" ERR {:?} {}", put.format, e.lines().next().unwrap_or(""));
                }
            }
        }
        println!("{line}");
    }
    std::fs::remove_dir_all(&dir).ok();
    println!("{wrong} of {all_count} wrong");
}
