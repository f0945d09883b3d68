//! The report as a page for a browser.

use std::fs;

use serde_json::Value;

use super::harness::{Place, lines};

/// Nodes, and a place for constraints and the cards of a step.
fn deck(constraints: &str, step: &str) -> String {
    let nodes = "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,0.,1.,0.\n4,0.,0.,1.\n";
    format!("{nodes}*BOUNDARY\n1,1,3\n{constraints}*STEP\n*STATIC\n{step}*END STEP\n")
}

const TWICE: &str = "*EQUATION\n2\n2,1,1.,3,1,-1.\n2\n3,1,2.,2,1,-2.\n";
/// Two bodies that both take node 2: ccx makes no equations of the second.
const LOST: &str =
    "*NSET,NSET=A\n2\n*RIGID BODY,NSET=A,REF NODE=3,ROT NODE=1\n*RIGID BODY,NSET=A,REF NODE=4,ROT NODE=1\n";

/// The JSON of a page.
fn page_data(page: &str) -> Value {
    let start = page.find("id=\"data\">").expect("data") + 10;
    let end = page[start..].find("</script>").expect("an end") + start;
    serde_json::from_str(&page[start..end]).expect("JSON")
}

#[test]
fn a_page_needs_nothing_else_and_says_all() {
    let place = Place::new();
    place.file("twice.inp", deck(TWICE, "")).file("case/rows.txt", "</script><b>\nplain\n");
    place
        .case("case", [2, 1], &[(1, 1, 1.0), (2, 1, 2.0)], &[0.0, 0.0], &[])
        .file("case/rows.txt", "plain\n</script><b>\n");
    assert_eq!(place.run("check -q twice.inp --format html -o twice.html").code, 0);
    let page = fs::read_to_string(place.path("twice.html")).expect("written");
    let data = page_data(&page);
    assert_eq!(data["report"]["dependent"][0]["label"], "line 11 *EQUATION 3:1");
    assert_eq!(data["picture"]["nodes"], serde_json::json!([[2, 1.0, 0.0, 0.0], [3, 0.0, 1.0, 0.0]]));
    assert_eq!(data["picture"]["parts"], serde_json::json!([[2, 1]]));
    assert_eq!(data["picture"]["rows"], serde_json::json!([[1, [2, 3]], [2, [2, 3]]]));
    // The one address in it names SVG's elements; nothing is loaded.
    let addresses: Vec<_> = page.match_indices("http").map(|(at, _)| &page[at..at + 26]).collect();
    assert_eq!(addresses, ["http://www.w3.org/2000/svg"]);
    assert!(!page.contains(" src=") && !page.contains("<link") && !page.contains("@import"));
    // A label cannot end the script.
    let run = place.run("check -q case --format html");
    assert_eq!(page_data(&run.out)["report"]["dependent"][0]["label"], "</script><b>");
}

/// The text that a browser shows for a page; `None` without a browser.
fn shown(place: &Place, page: &str) -> Option<String> {
    let chromium = |arguments: &[&str]| std::process::Command::new("chromium").args(arguments).output();
    if chromium(&["--version"]).is_err() {
        let left_out = std::env::var_os("QLESS_CORPUS").is_some_and(|corpus| corpus == "none");
        assert!(left_out, "install chromium, or say QLESS_CORPUS=none");
        eprintln!("SKIPPED: chromium is not installed: nothing to run");
        return None;
    }
    let address = format!("file://{}", place.path(page).display());
    let home = format!("--user-data-dir={}", place.path("browser").display());
    let options =
        ["--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=2000", "--dump-dom", &home, &address];
    let shown = chromium(&options).expect("it ran");
    Some(String::from_utf8(shown.stdout).expect("UTF-8"))
}

#[test]
fn a_browser_shows_the_page() {
    let place = Place::new();
    place.file("twice.inp", deck(TWICE, ""));
    assert_eq!(place.run("check -q twice.inp --format html -o twice.html").code, 0);
    let Some(shown) = shown(&place, "twice.html") else { return };
    for part in [
        "1 of 2 equations is redundant; the other one is independent.",
        ">line 11 *EQUATION 3:1</td>",
        "-2&nbsp;\u{b7}&nbsp;line 9 *EQUATION 2:1",
        "1 of 1</span>",
        "<section id=\"space\">",
    ] {
        assert!(shown.contains(part), "{part} is not in\n{shown}");
    }
    assert!(!shown.contains("did not finish"), "{shown}");
}

/// A label may contain anything except a line break; the page shows it unchanged.
#[test]
fn labels_cannot_break_the_page() {
    let ascii: String = (1..128_u8).map(char::from).filter(|c| !matches!(c, '\n' | '\r')).collect();
    let labels = ["<!--", "<!-- <script>", "</script><b>", "]]>", "a\u{2028}b\u{2029}c", "\"'`\\u0041 &lt;", &ascii];
    let place = Place::new();
    let twice: Vec<_> = (0..=labels.len()).map(|i| (i + 1, 1, 1.0)).collect();
    place.case("case", [labels.len() + 1, 1], &twice, &vec![0.0; labels.len() + 1], &[]);
    place.file("case/rows.txt", format!("kept\n{}\n", labels.join("\n")));
    assert_eq!(place.run("check -q case --format html -o page.html").code, 0);
    let page = fs::read_to_string(place.path("page.html")).expect("written");
    let data = page_data(&page);
    for (k, label) in labels.iter().enumerate() {
        assert_eq!(data["report"]["dependent"][k]["label"], *label);
    }
    if let Some(shown) = shown(&place, "page.html") {
        assert!(shown.contains("7 of 8 equations are redundant"), "{shown}");
        assert!(shown.contains(">&lt;!--</td>") && shown.contains(">&lt;/<wbr>script&gt;&lt;b&gt;</td>"), "{shown}");
        assert!(shown.contains("7 of 7</span>") && !shown.contains("did not finish"), "{shown}");
    }
    // If the script of a page fails, the page shows an error and no green bar.
    fs::write(place.path("broken.html"), page.replace("id=\"data\">{", "id=\"data\">{,")).expect("written");
    if let Some(shown) = shown(&place, "broken.html") {
        assert!(shown.contains("did not finish") && shown.contains("SyntaxError"), "{shown}");
        assert!(shown.contains("<div id=\"headline\" role=\"status\"></div>"), "{shown}");
    }
}

#[test]
fn the_headline_has_the_colour_of_the_worst_finding() {
    let place = Place::new();
    let tie = "*EQUATION\n2\n2,1,1.,3,1,-1.\n";
    let near = "*EQUATION\n2\n2,3,1.,3,3,-1.\n3\n3,3,1.00000001,2,3,-1.,4,3,-1.\n*BOUNDARY\n4,3,3\n";
    for (constraints, step, colour, sentence) in [
        (tie, "", "good", "The only equation is independent."),
        (TWICE, "", "bad", "ccx refuses the deck, for 2 reasons."),
        (tie, "*BOUNDARY\n2,1,1\n3,1,1,0.5\n", "bad", "1 of 1 equation conflicts; none is independent."),
        (tie, "*BOUNDARY\n2,1,1\n", "bad", "ccx refuses the deck, for 1 reason."),
        (LOST, "", "bad", "ccx drops 3 claims that the rest does not imply; 3 motions come free."),
        (near, "", "bad", "ccx may continue, but its results are unreliable, for 2 reasons."),
        ("*MPC\nNOVELTY,1,2\n", "", "doubtful", "INCOMPLETE: 1 constraint card was left out. No equation was read."),
    ] {
        place.file("a.inp", deck(constraints, step));
        let data = page_data(&place.run("check -q a.inp --format html").out);
        let headline = &data["headline"];
        assert_eq!((&headline["colour"], &headline["sentences"][0]), (&colour.into(), &sentence.into()), "{headline}");
    }
    // Without a solver, the equations decide.
    assert_eq!(place.paper("paper", 1.0).run("generate near -o near").code, 0);
    let headline = |case: &str| {
        let data = page_data(&place.run(&format!("check -q {case} --format html")).out);
        (data["headline"]["colour"].clone(), data["facts"].to_string())
    };
    assert_eq!(headline("paper").0, "doubtful");
    let (colour, facts) = headline("near");
    assert!(colour == "doubtful" && facts.contains("AMBIGUOUS."), "{facts}");
}

/// The elements of a page that a browser shows, in its order: the text after each `start` up to the next tag.
fn texts<'a>(shown: &'a str, start: &str) -> Vec<&'a str> {
    shown.split(start).skip(1).map(|rest| rest.split("</").next().unwrap_or_default()).collect()
}

#[test]
fn conflicts_come_first_with_their_cure() {
    let place = Place::new();
    // Rows 1 and 2 are equal; rows 3 and 4 differ in their right-hand sides.
    let pairs = [(2, 1), (2, 1), (4, 3), (4, 3)];
    let ties: Vec<_> = (1..).zip(pairs).flat_map(|(row, (a, b))| [(row, a, 1.0), (row, b, -1.0)]).collect();
    place.case("case", [4, 4], &ties, &[0.0, 0.0, 0.0, 0.5], &[]);
    let run = place.run("check -q case --format html -o page.html");
    assert_eq!(run.code, 1);
    let Some(shown) = shown(&place, "page.html") else { return };
    assert_eq!(texts(&shown, "data-column=\"Kind\">"), ["conflicting", "redundant"]);
    assert!(texts(&shown, "<h2>").contains(&"Next: each of these 2 ways cures row 4"), "{shown}");
    assert!(
        shown.contains("<li>change the right-hand side of row 4 from 0.5 to 0, or leave the equation out"),
        "{shown}"
    );
}

#[test]
fn motions_that_come_free_are_named_and_nothing_is_said_twice() {
    let place = Place::new();
    place.file("lost.inp", deck(LOST, "")).file("unread.inp", deck("*MPC\nNOVELTY,1,2\n", ""));
    for (name, once) in [("lost", "DOFs that come free: 2:1, 2:2, 2:3</p>"), ("unread", "NOVELTY")] {
        assert_eq!(place.run(&format!("check -q {name}.inp --allow-incomplete --format html -o {name}.html")).code, 0);
        let Some(shown) = shown(&place, &format!("{name}.html")) else { return };
        let body = &shown[shown.find("<body>").expect("a body")..shown.find("<script").expect("scripts")];
        assert_eq!(body.matches(once).count(), 1, "{body}");
        // Without an equation there is no picture of them.
        assert_eq!(body.contains("id=\"pictures\" hidden"), name == "unread", "{body}");
    }
}

#[test]
fn many_rows_are_shown_in_chunks() {
    let place = Place::new();
    let ties: Vec<_> = (1..=3000).flat_map(|row| [(row, 1, 1.0), (row, 2, -1.0)]).collect();
    place.case("many", [3000, 2], &ties, &vec![0.0; 3000], &[]);
    place.file("many/rows.txt", lines((1..=3000).map(|row| format!("tie {row}\n"))));
    assert_eq!(place.run("check -q many --format html -o many.html").code, 0);
    let Some(shown) = shown(&place, "many.html") else { return };
    let rows = texts(&shown, "data-column=\"Equation\">").len();
    assert!((200..3000).contains(&rows), "{rows}");
    assert!(shown.contains("2999 of 2999</span>") && shown.contains("<button id=\"more\""), "{shown}");
}
