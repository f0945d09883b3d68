"""Decks, Matrix Market files and case folders."""

import pathlib
import pickle

import pytest

import qless

CORPUS = pathlib.Path(__file__).resolve().parents[3] / "tests" / "corpus"


def test_a_deck_keeps_its_labels():
    c = qless.read(CORPUS / "decks" / "two_ties.inp")
    r = c.analyse()
    assert (r.rank, r.redundant.tolist(), c.warnings, c.left_out) == (2, [2], [], [])
    assert '"line 13 *EQUATION 1:1"' in str(r.because(2))


def test_a_case_folder_and_its_matrix():
    folder = qless.read(CORPUS / "cases" / "cycle_conflict")
    assert folder.analyse().conflicting.tolist() == [59]
    assert qless.read(CORPUS / "cases" / "cycle_conflict" / "C.mtx").analyse().redundant.tolist() == [59]


def test_constraints_that_are_left_out_are_said(tmp_path):
    deck = tmp_path / "spline.bdf"
    deck.write_text("GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,2.,0.,0.\nRSPLINE,7,,1,2,123,3\nMPC,1,1,1,1.,2,1,-1.\n")
    with pytest.warns(UserWarning, match="left out.*RSPLINE"):
        c = qless.read(deck)
    r = c.analyse()
    assert r.left_out == c.left_out and len(c.left_out) == 1
    assert (r.status, pickle.loads(pickle.dumps(r)).status) == ("incomplete", "incomplete") and "INCOMPLETE" in r.report()


def test_load_cases_that_differ_must_be_named(tmp_path):
    deck = tmp_path / "steps.inp"
    step = "*STEP\n*STATIC\n*BOUNDARY,OP=NEW\n{}\n*END STEP\n"
    deck.write_text("*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n*EQUATION\n2\n1,1,1.,2,1,-1.\n" + step.format("2,1,1,0.5") + step.format("2,2,2"))
    with pytest.raises(qless.ReadError, match="name one with `case`: step 1, step 2"):
        qless.read(deck)
    assert list(qless.read(deck, case="step 1").prescribed.values()) == [0.5]
    assert not qless.read(deck, case="step 2").analyse().fixed
    with pytest.raises(qless.ReadError, match="no load case `x`"):
        qless.read(deck, case="x")


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(qless.ReadError, match="missing.inp"):
        qless.read(tmp_path / "missing.inp")
    with pytest.raises(qless.ReadError, match="solver"):
        qless.read(CORPUS / "decks" / "two_ties.inp", solver="magic")
