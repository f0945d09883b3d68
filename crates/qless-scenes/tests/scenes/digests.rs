use qless_scenes::families::Degree;
use qless_scenes::{Rng, Scene, SceneError, families, fssi};

/// FNV-1a over the bits of matrix and right-hand side.
fn digest(scene: &Scene) -> u64 {
    let (matrix, rhs) = (scene.system.matrix(), scene.system.rhs());
    let starts = matrix.starts().iter().map(|&s| s as u64);
    let columns = matrix.columns().iter().map(|&j| u64::from(j));
    let words = starts.chain(columns).chain(matrix.values().iter().chain(rhs).map(|v| v.to_bits()));
    let bytes = words.flat_map(u64::to_le_bytes);
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn scenes_have_the_same_bits_everywhere() -> Result<(), SceneError> {
    let mesh = fssi::Level::P50.mesh();
    let windows = families::Windows { extent: [8, 8, 4], d: 2, window: 3, stride: 2, rows: 3, combos: 9 };
    let sides = [families::Side::jittered(3, Degree::Quadratic, 1)?, families::Side::uniform(4, Degree::Linear)?];
    let [slave, master] = sides.clone();
    let face = families::Mortar::face(sides, [master, slave]);
    let sphere = families::Surface::Sphere;
    let found = [
        digest(&fssi::tie(&mesh, 1)?),
        digest(&fssi::mortar(&mesh, 1)?),
        digest(&families::planted(100, 150, 20, 1, false)?),
        digest(&families::gradient([6, 6, 6], 3, 1)?),
        digest(&windows.scene(1)?),
        digest(&families::rbe2(50, 2, 1)?),
        digest(&families::random_graph(50, 60, 1)?.shuffle(1)?.0),
        digest(&families::mortar_short(50)?),
        digest(&families::Mortar { components: 3, skew: true, sums: 4, ..face }.scene(1)?),
        digest(&families::MortarSurface { sums: 4, ..families::MortarSurface::new(sphere, [7, 5], [5, 5]) }.scene(1)?),
        digest(&families::PeriodicCell::new(4, 5, families::Edges::Own).scene(1)?),
        digest(&families::Linkage { rows: 3, columns: 4, pitch: 1, length: 1, balls: true }.scene(1)?),
        digest(&families::geometric_chain(50, 1.01)?),
        digest(&families::spotted_band(50, 1)?),
        digest(&families::typed_twice(20, 5, 1)?),
        digest(&families::typed_cosines(5, 5, 1)?.beside(&families::recurrence(9)?)?),
    ];
    let expected = [
        0x2df8_9599_243d_dbbf,
        0x46f3_ec65_de83_2cbd,
        0xa086_4cdd_0df4_58d7,
        0x0c91_3477_6b83_bbee,
        0x2b6d_dec2_af5a_9ea5,
        0x50d2_3b30_dde7_9689,
        0xe2aa_238f_d710_a15b,
        0x6700_0adb_93a2_5e00,
        0xbbc7_6d40_6edc_adbe,
        0xc0a0_a3ae_2a12_e6c3,
        0x7184_ae1c_b39d_c1ef,
        0xd032_85eb_cb4b_5ec2,
        0x3b30_5aba_73d8_3663,
        0x07b9_bf3e_a3d7_b1d1,
        0x3c92_9092_eefc_9737,
        0xd372_8b66_2ac0_08eb,
    ];
    assert_eq!(found, expected, "found {found:#018x?}");
    Ok(())
}

#[test]
fn random_numbers_are_splitmix64() {
    let mut rng = Rng::new(1_234_567);
    let published = [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423];
    assert_eq!(published.map(|_| rng.bits()), published);
}
