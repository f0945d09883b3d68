//! Calls of the library as `fuzz/fuzz_targets/api.rs` makes them: the inputs kept, the seeds, and random ones.

use std::path::Path;

#[path = "../fuzz/src/api.rs"]
mod api;

#[test]
fn inputs_that_were_kept() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz");
    let folders = ["seeds/api", "corpus/api"].map(|folder| std::fs::read_dir(root.join(folder)));
    let mut files: Vec<_> = folders.into_iter().flatten().flatten().flatten().map(|entry| entry.path()).collect();
    files.sort();
    assert!(files.len() > 2, "{} inputs", files.len());
    for file in files {
        println!("{}", file.display());
        api::api(&std::fs::read(&file).expect("readable"));
    }
}

#[test]
fn random_inputs() {
    let mut rng = qless_scenes::Rng::new(1);
    for _ in 0..3000 {
        let length = 100 + rng.below(1500);
        let byte =
            |rng: &mut qless_scenes::Rng| if rng.below(3) > 0 { rng.below(8) as u8 } else { rng.below(256) as u8 };
        api::api(&(0..length).map(|_| byte(&mut rng)).collect::<Vec<u8>>());
    }
}
