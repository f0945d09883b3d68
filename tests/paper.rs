//! The paper's own examples: equations (12)-(18), Figures 1, 2, 5, 6, 8 and Table 1, on every backend.

#[macro_use]
mod support;

use qless::{BackendChoice, Kind, Options};
use qless_scenes::fssi::Level;
use qless_scenes::{Scene, fssi, paper};
use support::{certificate_error, check_certificates, check_reduction, diagnose, orders, reorder, settings};

on_each_backend!(
    equation_14_is_redundant_and_its_certificate_names_12_and_13,
    equation_14_with_another_right_hand_side_conflicts,
    reduction_17_and_18,
    figure_5_a_prescribed_dof_is_never_a_slave,
    figure_6_both_generated_boundary_conditions_are_found,
    figures_and_their_truth_in_every_order,
    figure_8_two_of_sixteen_are_redundant,
    table_1_at_all_seven_levels,
);

fn equation_14_is_redundant_and_its_certificate_names_12_and_13(backend: BackendChoice) {
    let scene = paper::equations_12_to_14(1.0).expect("a scene");
    for options in settings(backend) {
        let analysis = diagnose(&scene.system, &options);
        assert_eq!(analysis.rank(), 2);
        assert_eq!(analysis.kinds(), [Kind::Independent, Kind::Independent, Kind::Redundant]);
        let because = analysis.because(analysis.dependent()[0].row).expect("one of its rows");
        assert_eq!(because.iter().map(|term| term.row).collect::<Vec<_>>(), [0, 1]);
        assert!(because.iter().all(|term| (term.coefficient - 1.0).abs() < 1e-14), "{because:?}");
    }
}

fn equation_14_with_another_right_hand_side_conflicts(backend: BackendChoice) {
    let scene = paper::equations_12_to_14(0.0).expect("a scene");
    for options in settings(backend) {
        let analysis = diagnose(&scene.system, &options);
        assert_eq!(analysis.kinds(), [Kind::Independent, Kind::Independent, Kind::Conflicting]);
        // 0 - (1 + 0): the last row of Figure 3b.
        assert!((analysis.dependent()[0].mismatch + 1.0).abs() < 1e-14);
    }
}

fn reduction_17_and_18(backend: BackendChoice) {
    let scene = paper::equations_12_to_14(1.0).expect("a scene");
    for options in settings(backend) {
        let reduction = diagnose(&scene.system, &options).reduction().expect("within the gate");
        assert_eq!((reduction.slaves(), reduction.masters()), ([0, 1].as_slice(), [2].as_slice()));
        for (i, (t, g)) in [(-1.0, 2.0 / 3.0), (1.0, -1.0 / 3.0)].into_iter().enumerate() {
            let row: Vec<_> = reduction.t().row(i).collect();
            assert!(row.len() == 1 && (row[0].1 - t).abs() < 1e-15 && (reduction.g()[i] - g).abs() < 1e-15, "{row:?}");
        }
    }
}

fn figure_5_a_prescribed_dof_is_never_a_slave(backend: BackendChoice) {
    let scene = paper::figure_5(0.25).expect("a scene");
    for options in settings(backend) {
        let analysis = diagnose(&scene.system, &options);
        let reduction = analysis.reduction().expect("within the gate");
        assert_eq!(reduction.prescribed(), [1]);
        assert!(!reduction.slaves().contains(&1));
        assert!(reduction.g_matrix().nnz() > 0, "u_p stays symbolic");
        check_reduction(&scene.system, &analysis, &reduction, 1e-14);
    }
}

fn figure_6_both_generated_boundary_conditions_are_found(backend: BackendChoice) {
    let scene = paper::figure_6(0.5).expect("a scene");
    let truth = scene.truth.generated.clone().expect("known");
    assert_eq!(truth.iter().map(|g| g.0).collect::<Vec<_>>(), [2, 4], "u3 and u5");
    for options in settings(backend) {
        let analysis = diagnose(&scene.system, &options);
        assert_eq!(analysis.generated().len(), truth.len());
        for (found, known) in analysis.generated().iter().zip(&truth) {
            assert!(found.0 == known.0 && (found.1 - known.1).abs() < 1e-14, "{found:?} for {known:?}");
            let because = analysis.because_fixed(found.0).expect("factored before");
            assert!(certificate_error(&scene.system, &[(found.0, 1.0)], &because) < 1e-14, "{because:?}");
        }
    }
}

fn figures() -> Vec<(&'static str, Scene)> {
    vec![
        ("figure 1", paper::figure_1(0.5).expect("a scene")),
        ("figure 2", paper::figure_2(paper::FloorInput::Chain).expect("a scene")),
        ("figure 5", paper::figure_5(1.5).expect("a scene")),
        ("figure 6", paper::figure_6(-2.0).expect("a scene")),
        ("figure 8", paper::figure_8().expect("a scene")),
    ]
}

fn figures_and_their_truth_in_every_order(backend: BackendChoice) {
    for (name, scene) in figures() {
        let (m, n) = (scene.system.equations(), scene.system.dofs());
        let natural = (0..m).collect();
        let mut rows = vec![natural];
        rows.extend(orders(m));
        for (order, dofs) in rows.iter().zip(orders(n).iter().cycle()) {
            let system = reorder(&scene.system, order, dofs);
            for options in settings(backend) {
                let analysis = diagnose(&system, &options);
                assert_eq!(Some(analysis.rank()), scene.truth.rank_free, "{name}");
                assert_eq!(analysis.kinds().contains(&Kind::Conflicting), scene.truth.conflicting, "{name}");
                let generated = scene.truth.generated.as_ref().map(Vec::len);
                assert!(generated.is_none_or(|g| g == analysis.generated().len()), "{name}: generated");
                check_certificates(&system, &analysis);
                check_reduction(&system, &analysis, &analysis.reduction().expect("within the gate"), 1e-13);
            }
        }
    }
}

fn figure_8_two_of_sixteen_are_redundant(backend: BackendChoice) {
    let scene = paper::figure_8().expect("a scene");
    assert_eq!((scene.system.equations(), scene.system.prescribed().len()), (16, 2));
    for options in settings(backend) {
        let analysis = diagnose(&scene.system, &options);
        assert_eq!(analysis.dependent().iter().filter(|d| d.kind == Kind::Redundant).count(), 2);
        assert_eq!(analysis.rank(), 14);
    }
}

fn table_1_at_all_seven_levels(backend: BackendChoice) {
    let levels = [Level::P50, Level::P60, Level::P70, Level::P80, Level::P90, Level::P100, Level::P110];
    let equations = [7580, 10300, 13808, 17408, 22360, 26888, 31832];
    let redundant = [168, 192, 216, 240, 276, 288, 300];
    for ((level, equations), redundant) in levels.into_iter().zip(equations).zip(redundant) {
        let scene = fssi::tie(&level.mesh(), 1).expect("a scene");
        assert_eq!(scene.system.equations(), equations);
        let analysis = diagnose(&scene.system, &Options { backend, ..Options::default() });
        assert_eq!(analysis.dependent().len(), redundant);
        assert!(analysis.dependent().iter().all(|d| d.kind == Kind::Redundant));
        assert_eq!(analysis.rank(), equations - redundant);
        check_certificates(&scene.system, &analysis);
        let reduction = analysis.reduction().expect("within the gate");
        assert!(reduction.growth() <= 1.0 + 1e-12, "growth {}", reduction.growth());
        check_reduction(&scene.system, &analysis, &reduction, 1e-13);
    }
}
