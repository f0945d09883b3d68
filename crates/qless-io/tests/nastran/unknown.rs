//! Cards of unknown names: those that may constrain are left out, others are named, usual ones are not.

use super::given::{equations, model, warnings};

const TIE: &str = "CEND\nBEGIN BULK\nGRID,1\nGRID,2\nRBE2,9,1,1,2\n";

#[test]
fn names_that_sound_as_if_they_constrain_make_the_model_incomplete() {
    for name in ["RBX", "RSPOT", "RJOINTX", "RXCON", "RGLUE", "MPCX", "SPC3"] {
        let model = model(&format!("{TIE}{name},1,2\n"));
        let expected = format!("line 6: {name}: the card is not known, and may constrain; it is left out");
        assert_eq!(warnings(&model), [expected]);
        assert_eq!(model.left_out().count(), 1, "{name}");
    }
}

#[test]
fn other_unknown_names_are_said_once() {
    let model = model(&format!("{TIE}ZZTOP,1\nCQUAD4,1,1,1,2\nZZTOP,2\n"));
    let expected = "line 6: ZZTOP: the card is not known; all cards of this name are ignored";
    assert_eq!(warnings(&model), [expected]);
    assert_eq!(model.left_out().count(), 0);
}

#[test]
fn usual_cards_are_passed_over_without_a_word() {
    let names = "PARAM CQUAD4 CTRIA3 CHEXA CTETRA CPENTA CPYRAM CBAR CBEAM CBUSH CELAS2 CONM2 CONROD CROD CGAP CSHEAR \
                 PSHELL PCOMP PCOMPG PSOLID PBAR PBARL PBEAML PBUSH PROD PELAS PSHEAR MAT1 MAT8 MAT10 MATT1 EIGRL EIGR \
                 PLOAD4 FORCE1 MOMENT2 GRAV RFORCE TEMP TEMPD TEMPP1 TABLED1 TABDMP1 TLOAD1 RLOAD2 DLOAD DAREA FREQ1 \
                 TSTEP TSTEPNL NLPARM DESVAR DRESP1 DVPREL1 DMIG DTI SET1 PLOTEL SPCOFF RGYRO RSPINR CAERO1 SPLINE1 \
                 AERO AEROS TRIM FLUTTER MKAERO1 MDLPRM CHBDYG CONV RADM VIEW USET1 BCTPARM BSURFS GENEL NSM1 PVISC";
    let cards = names.split_whitespace().fold(String::new(), |cards, name| cards + name + ",1\n");
    assert_eq!(warnings(&model(&format!("{TIE}{cards}"))), [""; 0]);
}

#[test]
fn a_singular_mean_is_left_out_alone() {
    let tie = "CEND\nBEGIN BULK\nGRID,1\nGRID,2,,1.\nGRID,3,,2.\nRBE2,9,1,1,2\n";
    let why = "the connected components do not determine 1:4; connect more of them, or remove it from REFC";
    let um = "the element cannot be solved for the components after UM; choose others that it connects";
    for (mean, why, claims) in [
        ("RBE3,7,,1,1234,1.,123,2,3", why, vec!["1:1", "1:2", "1:3", "1:4"]),
        ("RBE3,7,,1,1,1.,123,2,3\n,UM,2,3", um, vec!["2:3"]),
    ] {
        let model = model(&format!("{tie}{mean}\n"));
        assert_eq!(warnings(&model), [format!("line 7: RBE3 7 is left out: {why}")]);
        assert_eq!((model.left_out().count(), equations(&model)), (1, vec!["1 2:1 -1 1:1".to_owned()]));
        let claimed: Vec<String> = model.left_out_claims().iter().map(|(dof, _)| dof.to_string()).collect();
        assert_eq!(claimed, claims);
    }
}
