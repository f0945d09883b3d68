//! Tells what the commands that this reader does not support do to constraints.

use super::command::CommandKey;

/// The effect of an unsupported command on constraints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandEffect {
    /// The command makes or changes constraints.
    Constrains,
    /// The command prescribes or releases values: of the solid model, on planes of symmetry, or of a perturbed step.
    Prescribes,
    /// The command generates nodes.
    MakesNodes,
    /// The command makes ANSYS execute other commands.
    RunsOthers,
    /// The command replaces the model by what a file has, or by nothing.
    Replaces,
    /// The command has no effect on constraints.
    Nothing,
    Unknown,
}

/// Commands that make or change constraints: interfaces, copies of equations, merged nodes and the like.
const CONSTRAIN: &str = "CEIN CECY CESG CPIN CPCY CPME DJ DSCA DFLX DVAL \
    CBDO CYCL CYCO PSME SLOA NUMM DCVS DSUR EMBE MCFO ELBO";

/// Commands that prescribe or release values.
const PRESCRIBE: &str = "DSYM DK DL DA DTRA SBCT PERT";

/// Commands that generate or copy nodes and meshes.
const NODES: &str = "NGEN FILL NSYM NREA NDIS KMES LMES AMES VMES FVME IMES VSWE VDRA VROT VEXT EXTO EGEN EINT ESUR ENGE NKPT \
    CENT NMOV UPGE EREI ESYM ENSY VOFF AMAP VMAP XMES OMES NWPL NORA EMOR EORI NTRA  TRNO MOVE EREA EMID AROT ADRA ARSY LSYM VSYM";

/// Commands that execute other commands.
const OTHERS: &str = "/INP *USE INRE LSRE LSSO IGES *REP *GO ~CAT EXUN";

/// Commands that replace the model.
const REPLACE: &str = "CDRE LDRE FLRE";

/// Commands of archives and plain decks without effect on constraints: elements, materials, sections, loads, output, the solid model.
const NOTHING: &str = "ET EN E EBLO TYPE MAT REAL SECN SECT SECD SECO SECB SECC SECF SECP ESYS KEYO KEYW R RMOR RLBL RDEL \
    MP MPDA MPTE MPDE MPTR MPCO TB TBDA TBTE TBFI TBPT TBEO TBDE TBMO TBIN ETBL ETDE ETCO DOF ELIS NLIS ERES  SHPP TSHA TOFF \
    CM CMBL CMDE CMGR CMSE CMED CMLI NSEL NSLE NSLK NSLL NSLA NSLV ESEL ESLN ESLL ESLA ESLV ALLS KSEL KSLL KSLN LSEL LSLA LSLK \
    ASEL ASLL ASLV VSEL VSLA DOFS NMOD NROT NANG NRRA NDEL EDEL EMOD NUMO NUMC LOCA CS CSWP CSKP CSCI CSDE CSYS CLOC DSYS WPCS \
    SF SFE SFL SFA SFB SFBE SFG SFGR SFFU SFDE SFED SFCU SFEL SFET SFSC SFCO BF BFE BFK BFL BFA BFV BFBL BFEB BFUN BFCU BFDE BFED BFES BFTR \
    ACEL OMEG DOME CGOM CGLO DCGO CMOM CMDO CMRO CMAC IRLF TREF TUNI IC ICDE IRLI KUSE FCUM FSCA  FSUM FTRA \
    ANTY NLGE NROP NSUB DELT AUTO TIME KBC OUTP OUTR OUTT CNVT LNSR PRED NEQI NCNV CRPL BETA ALPH DMPR DMPS DMPO MDAM EQSL \
    MODO MXPA MODC HROP HARF TRNO TINT TIMI RESC STAB ARCL BCSO DSPO PCGO  SSTI PSTR EMAT ESAV SPOP LUMP OPNC NLDI NLHI CNTR \
    COUP CNCH  EKIL EALI ESTI GAUG SAVE FINI END EXIT STAT TITL NOOR VERI BATC RATE CUTC MONI TRAN BUCO CAMP SYNC CORI \
    CRES RSPL SUBO SEOP SEEX SEGE M MDEL MGEN TOTA EXPA NUME EXPS MXPD ABEX \
    K KPT KATT KPAT L LSTR LARC LATT LCUR LESI ESIZ A AL AATT ASAT ASUR V VA VATT BLOC BLC4 BLC5 CYLI CYL4 CYL5 RECT PCIR SPHE CONE PRIS \
    VGLU AGLU LGLU VADD AADD VSBV ASBA VOVL AOVL VINV VGEN AGEN LGEN KGEN MSHA MSHK MSHM MOPT SMRT KESI AESI LCCA ACCA VCLE ACLE LCLE \
    VDEL ADEL LDEL KDEL MANF SOLO XMLO EXTE LSDE LSCL LSOP LSBA LSDU SSLN PIVC LCDE NWRI CDWR CDOP EWRI GEOM PARS WRIT \
    SET SUBS FILE LCAS ETAB PLNS PRNS PRES PRRS PRDI PLDI ESOL NSOL PRVA PLVA STOR ADD PROD PATH PDEF PPAT PRPA RSYS AVPR FSUM PRRF LAYE \
    SHEL PLES ANFL TRES NLOG EXPC INIS INIT DDOP CMWR MSAV KCAL CINT CZDE CZME GSBD GSGD GSLI SWAD SWGE  PERB MPRI MFOU LIST \
    C*** QRDO STEF THOP EMUN LCAT XVAR SLIS NUMB USER MPLI TBLI LABE TEMP RMOD CEWR RLIS PLOT EPLO NPLO GPLO MSTO CSLI ADDD RESV NOPR \
    SED SV SVTY FREQ MODE RIGI PFAC SPUN SPFR SPVA PSDU PSDF PSDV PSDC PSDR SRSS GRP CMSO MSOP HROU ARCT RADO MPCH UIMP EMIS VTYP \
    FK FKDE RFOR PRET PRCI PRCA PRCP PRNL PRTI PRIT PRFA PRSE PLPA PLCA PLVE PLET PLF2 PLSE NUMV NUMS NPRI NSOR ESOR SSUM SMUL SQRT ABS EXP \
    QUOT DERI EXTR LCFA LCOP LCWR LCSE PCAL PAGE PAPU ANSO RES2 RES3 VGET VPUT ASUM VSUM RPSD JPEG JPGP APLO VPLO CMPL FLIS DLIS ETLI \
    WPLA WPRO WPOF WPAV WPST KWPA KSCO KPSC LVSC DESI MODM VEOR BSPL CIRC PTXY POLY ASBW ASBL VSBW VSBA AFIL MMAS";

/// The effect of an unsupported command.
pub fn effect(key: CommandKey) -> CommandEffect {
    let name = key.trim_ascii_end();
    let among = |list: &str| list.split_ascii_whitespace().any(|known| known.as_bytes() == name);
    match name.first() {
        _ if among(CONSTRAIN) => CommandEffect::Constrains,
        _ if among(PRESCRIBE) => CommandEffect::Prescribes,
        _ if among(OTHERS) => CommandEffect::RunsOthers,
        _ if among(REPLACE) => CommandEffect::Replaces,
        _ if among(NODES) => CommandEffect::MakesNodes,
        Some(b'/' | b'*' | b':') => CommandEffect::Nothing,
        _ if among(NOTHING) => CommandEffect::Nothing,
        _ => CommandEffect::Unknown,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_letters_identify_commands() {
        for (key, expected) in [
            (b"CEIN", CommandEffect::Constrains),
            (b"DL  ", CommandEffect::Prescribes),
            (b"NGEN", CommandEffect::MakesNodes),
            (b"/INP", CommandEffect::RunsOthers),
            (b"*GO ", CommandEffect::RunsOthers),
            (b"*GET", CommandEffect::Nothing),
            (b"/PRE", CommandEffect::Nothing),
            (b"EBLO", CommandEffect::Nothing),
            (b"QXYZ", CommandEffect::Unknown),
        ] {
            assert_eq!(effect(*key), expected);
        }
    }
}
