//! Limits for short source files and for type names that are defined twice.

use std::collections::BTreeMap;

use syn::visit::Visit;

use super::imports::crates;

/// A file with fewer lines is short.
const CRUMB: usize = 40;
/// Number of short files that are allowed: roots of folders and lists of formats can be short.
const MOST_CRUMBS: usize = 60;
/// Type names that may be defined in several crates, for the same idea.
const MOST_REPEATED: usize = 40;

#[test]
fn few_source_files_are_crumbs() {
    let files = crates().into_iter().flat_map(|one| one.modules.into_values());
    let lines = |path: &std::path::PathBuf| std::fs::read_to_string(path).expect("a source file").lines().count();
    let crumbs: Vec<String> = files.filter(|path| lines(path) < CRUMB).map(|path| path.display().to_string()).collect();
    assert!(crumbs.len() <= MOST_CRUMBS, "{} files below {CRUMB} lines:\n{}", crumbs.len(), crumbs.join("\n"));
}

#[derive(Default)]
struct TypeNames(Vec<String>);

impl<'ast> Visit<'ast> for TypeNames {
    fn visit_item_struct(&mut self, item: &'ast syn::ItemStruct) {
        self.0.push(item.ident.to_string());
    }

    fn visit_item_enum(&mut self, item: &'ast syn::ItemEnum) {
        self.0.push(item.ident.to_string());
    }

    fn visit_item_trait(&mut self, item: &'ast syn::ItemTrait) {
        self.0.push(item.ident.to_string());
    }

    fn visit_item_type(&mut self, item: &'ast syn::ItemType) {
        self.0.push(item.ident.to_string());
    }
}

#[test]
fn few_type_names_are_defined_twice() {
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for path in crates().into_iter().flat_map(|one| one.modules.into_values()) {
        let file = syn::parse_file(&std::fs::read_to_string(&path).expect("a source file")).expect("Rust");
        let mut names = TypeNames::default();
        names.visit_file(&file);
        names.0.into_iter().for_each(|name| places.entry(name).or_default().push(path.display().to_string()));
    }
    // Each crate tests the examples of its README in a type of this name.
    places.remove("Readme");
    places.retain(|_, of_name| of_name.len() > 1);
    let said: Vec<String> = places.iter().map(|(name, of_name)| format!("{name}: {}", of_name.join(" "))).collect();
    assert!(said.len() <= MOST_REPEATED, "{} names:\n{}", said.len(), said.join("\n"));
}
