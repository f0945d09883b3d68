//! The modules of a crate, and which module imports which.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use syn::visit::{self, Visit};

/// A module by its path inside the crate; the root is empty.
pub type Module = Vec<String>;

/// Modules and imports of one crate.
pub struct Crate {
    pub name: String,
    pub modules: BTreeMap<Module, PathBuf>,
    /// For each module the modules that it imports from, re-exports followed.
    pub imports: BTreeMap<Module, BTreeSet<Module>>,
}

/// The folders of all crates whose source is in this package or its workspace.
pub fn crates() -> Vec<Crate> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut folders: Vec<PathBuf> =
        entries(&root.join("crates")).into_iter().chain([root.join("vendor-sys")]).collect();
    folders.retain(|folder| folder.join("src").is_dir());
    folders.iter().map(|folder| Crate::read(folder)).collect()
}

fn entries(folder: &Path) -> Vec<PathBuf> {
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    paths.sort();
    paths
}

/// All Rust files below a folder, except those of unit tests.
pub fn sources(folder: &Path) -> Vec<PathBuf> {
    let (folders, files): (Vec<_>, Vec<_>) = entries(folder).into_iter().partition(|path| path.is_dir());
    let files = files.into_iter().filter(|path| path.extension().is_some_and(|ending| ending == "rs"));
    let below = folders.iter().filter(|folder| !folder.ends_with("tests")).flat_map(|folder| sources(folder));
    files.filter(|path| !path.ends_with("tests.rs")).chain(below).collect()
}

impl Crate {
    fn read(folder: &Path) -> Self {
        let source = folder.join("src");
        let modules: BTreeMap<Module, PathBuf> = sources(&source)
            .into_iter()
            .map(|path| (module_of(path.strip_prefix(&source).expect("below")), path))
            .collect();
        let mut uses = BTreeMap::new();
        for (module, path) in &modules {
            let text = std::fs::read_to_string(path).expect("a source file");
            let file = syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            let mut found = Paths { module: module.clone(), modules: &modules, uses: Vec::new(), is_public: false };
            found.visit_file(&file);
            uses.insert(module.clone(), found.uses);
        }
        let imports = uses.iter().map(|(module, own)| (module.clone(), targets(module, own, &uses))).collect();
        Self { name: folder.file_name().expect("a name").to_string_lossy().into_owned(), modules, imports }
    }
}

fn module_of(path: &Path) -> Module {
    let mut module: Module = path.with_extension("").iter().map(|part| part.to_string_lossy().into_owned()).collect();
    if module.last().is_some_and(|last| ["mod", "lib", "main"].contains(&last.as_str())) {
        module.pop();
    }
    module
}

/// A path inside the crate, from its root, that a module uses; `name` is what the module calls it.
struct Use {
    name: String,
    path: Module,
    is_import: bool,
    is_public: bool,
}

/// Collects the paths that a file uses.
struct Paths<'a> {
    module: Module,
    modules: &'a BTreeMap<Module, PathBuf>,
    uses: Vec<Use>,
    /// Whether the `use` item that is being read is `pub`.
    is_public: bool,
}

impl Paths<'_> {
    fn add(&mut self, path: &[String], name: &str, is_import: bool) {
        let first = path.first().map_or("", String::as_str);
        let from_root = match first {
            "crate" => path[1..].to_vec(),
            "self" | "super" => {
                let up = path.iter().take_while(|word| *word == "super").count();
                let skipped = path.iter().take_while(|word| ["self", "super"].contains(&word.as_str())).count();
                let kept = self.module.len().saturating_sub(up);
                [&self.module[..kept], &path[skipped..]].concat()
            }
            _ => {
                let child = [self.module.as_slice(), &path[..1.min(path.len())]].concat();
                if !self.modules.contains_key(&child) {
                    return;
                }
                [self.module.as_slice(), path].concat()
            }
        };
        self.uses.push(Use {
            name: name.to_owned(),
            path: from_root,
            is_import,
            is_public: is_import && self.is_public,
        });
    }

    fn tree(&mut self, mut prefix: Vec<String>, tree: &syn::UseTree) {
        match tree {
            syn::UseTree::Path(path) => {
                prefix.push(path.ident.to_string());
                self.tree(prefix, &path.tree);
            }
            syn::UseTree::Group(group) => group.items.iter().for_each(|item| self.tree(prefix.clone(), item)),
            syn::UseTree::Name(name) if name.ident == "self" => {
                let last = prefix.last().cloned().unwrap_or_default();
                self.add(&prefix, &last, true);
            }
            syn::UseTree::Name(name) => {
                prefix.push(name.ident.to_string());
                self.add(&prefix, &name.ident.to_string(), true);
            }
            syn::UseTree::Rename(rename) => {
                prefix.push(rename.ident.to_string());
                self.add(&prefix, &rename.rename.to_string(), true);
            }
            syn::UseTree::Glob(_) => self.add(&prefix, "*", true),
        }
    }
}

/// Whether `cfg(test)`, or `cfg(all(test, ..))`, guards an item.
fn is_test(attributes: &[syn::Attribute]) -> bool {
    let of_cfg = attributes.iter().filter(|attribute| attribute.path().is_ident("cfg"));
    of_cfg.filter_map(|attribute| attribute.meta.require_list().ok()).any(|list| {
        let words = list.tokens.to_string();
        words.split(|c: char| !c.is_alphanumeric()).any(|word| word == "test")
    })
}

impl<'ast> Visit<'ast> for Paths<'_> {
    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if !is_test(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        if !is_test(&item.attrs) {
            visit::visit_impl_item_fn(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        self.is_public = !matches!(item.vis, syn::Visibility::Inherited);
        self.tree(Vec::new(), &item.tree);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let words: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        if words.len() > 1 && ["crate", "self", "super"].contains(&words[0].as_str()) {
            self.add(&words, "", false);
        }
        visit::visit_path(self, path);
    }
}

/// The modules in which the things that a module uses are defined.
fn targets(module: &Module, own: &[Use], uses: &BTreeMap<Module, Vec<Use>>) -> BTreeSet<Module> {
    // The root of a folder re-exports names for its public path, which does not count as an import.
    let is_folder = uses.keys().any(|other| other.len() > module.len() && other.starts_with(module));
    let counts = |one: &&Use| !(one.is_public && is_folder);
    let found = own.iter().filter(counts).filter_map(|one| resolve(&one.path, uses, 0));
    found.filter(|target| target != module).collect()
}

/// The module that defines what a path leads to; names that a module imports itself lead on.
fn resolve(path: &[String], uses: &BTreeMap<Module, Vec<Use>>, depth: usize) -> Option<Module> {
    if uses.contains_key(path) {
        return Some(path.to_vec());
    }
    let (longest, rest) =
        (0..path.len()).rev().map(|n| path.split_at(n)).find(|(front, _)| uses.contains_key(*front))?;
    let again = uses[longest].iter().find(|one| one.is_import && one.name == rest[0] && one.path != path);
    match again {
        Some(one) if depth < 20 => {
            resolve(&[one.path.as_slice(), &rest[1..]].concat(), uses, depth + 1).or_else(|| Some(longest.to_vec()))
        }
        _ => Some(longest.to_vec()),
    }
}
