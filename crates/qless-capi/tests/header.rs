//! The header declares exactly the functions of the library, with the same arguments, and the numbers of its version.

use std::collections::BTreeMap;

const HERE: &str = env!("CARGO_MANIFEST_DIR");

fn header() -> String {
    std::fs::read_to_string(format!("{HERE}/include/qless.h")).expect("the header")
}

/// Declarations by name, white space and comments taken out.
fn declared() -> BTreeMap<String, String> {
    let text = header();
    let statements = text.split("\nQLESS_API ").skip(1).filter_map(|rest| rest.split(';').next());
    let words = statements.map(|one| one.split_whitespace().collect::<Vec<_>>().join(" "));
    words.filter(|one| one.contains('(')).map(|one| (name_of(&one), one)).collect()
}

fn name_of(declaration: &str) -> String {
    let before = declaration.split('(').next().unwrap_or_default();
    before.rsplit([' ', '*']).next().unwrap_or_default().to_owned()
}

/// The declarations that the source means.
fn defined() -> BTreeMap<String, String> {
    let files = std::fs::read_dir(format!("{HERE}/src")).expect("the source").flatten();
    let mut functions = BTreeMap::new();
    for file in files {
        let source = syn::parse_file(&std::fs::read_to_string(file.path()).expect("a file")).expect("Rust");
        for item in source.items {
            let signatures = match item {
                syn::Item::Fn(function) if function.sig.abi.is_some() => vec![function.sig],
                syn::Item::Macro(call) if call.mac.path.is_ident("for_both_indices") => both(&call.mac),
                _ => Vec::new(),
            };
            functions.extend(signatures.iter().map(|one| (one.ident.to_string(), declaration(one))));
        }
    }
    functions
}

/// The two functions of `for_both_indices! { wide = fn narrow<I>(..) { .. } }`.
fn both(call: &syn::Macro) -> Vec<syn::Signature> {
    let parts = |input: syn::parse::ParseStream| {
        let wide: syn::Ident = input.parse()?;
        input.parse::<syn::Token![=]>()?;
        Ok((wide, input.parse::<syn::ItemFn>()?.sig))
    };
    let (wide, narrow) = call.parse_body_with(parts).expect("a name and a function");
    let mut both = vec![narrow.clone(), syn::Signature { ident: wide, ..narrow }];
    for (signature, index) in both.iter_mut().zip(["i32", "i64"]) {
        for argument in &mut signature.inputs {
            let syn::FnArg::Typed(argument) = argument else { continue };
            let syn::Type::Ptr(pointer) = &mut *argument.ty else { continue };
            if matches!(&*pointer.elem, syn::Type::Path(path) if path.path.is_ident("I")) {
                pointer.elem = syn::parse_str(index).expect("a type");
            }
        }
    }
    both
}

fn declaration(signature: &syn::Signature) -> String {
    let argument = |argument: &syn::FnArg| {
        let syn::FnArg::Typed(argument) = argument else { panic!("a function of C has no self") };
        let syn::Pat::Ident(name) = &*argument.pat else { panic!("an argument without a name") };
        joined(&in_c(&argument.ty), &name.ident.to_string())
    };
    let arguments: Vec<String> = signature.inputs.iter().map(argument).collect();
    let arguments = if arguments.is_empty() { "void".to_owned() } else { arguments.join(", ") };
    let syn::ReturnType::Type(_, result) = &signature.output else { panic!("a function without a status") };
    format!("{}({arguments})", joined(&in_c(result), &signature.ident.to_string()))
}

fn joined(kind: &str, name: &str) -> String {
    if kind.ends_with('*') { format!("{kind}{name}") } else { format!("{kind} {name}") }
}

fn in_c(kind: &syn::Type) -> String {
    match kind {
        syn::Type::Ptr(pointer) => {
            let to = in_c(&pointer.elem);
            let is_const = if pointer.const_token.is_some() { "const " } else { "" };
            if to.ends_with('*') { format!("{is_const}{to}*") } else { format!("{is_const}{to} *") }
        }
        syn::Type::Path(path) => {
            let name = path.path.segments.last().expect("a name").ident.to_string();
            match name.as_str() {
                "f64" => "double",
                "i8" => "int8_t",
                "i32" => "int32_t",
                "i64" => "int64_t",
                "c_int" => "int",
                "c_char" => "char",
                "c_void" => "void",
                handle if handle.starts_with("qless_") => handle,
                other => panic!("{other} has no name in C"),
            }
            .to_owned()
        }
        _ => panic!("a type that C does not know"),
    }
}

#[test]
fn the_header_declares_every_function_as_it_is() {
    let (declared, defined) = (declared(), defined());
    assert!(defined.len() > 20, "{} functions", defined.len());
    for (name, declaration) in &defined {
        assert_eq!(declared.get(name), Some(declaration), "{name}");
    }
    assert_eq!(declared.len(), defined.len());
}

/// The structures of the source: a line for each field, as in the header.
#[test]
fn the_header_has_the_structures_of_the_source() {
    let text = header();
    let files = ["findings", "ranks", "repairs"]
        .map(|name| std::fs::read_to_string(format!("{HERE}/src/{name}.rs")).expect("a file"));
    let mut count = 0;
    for item in files.iter().flat_map(|file| syn::parse_file(file).expect("Rust").items) {
        let syn::Item::Struct(one) = item else { continue };
        if !one.ident.to_string().starts_with("qless_") {
            continue;
        }
        let field = |field: &syn::Field| {
            let name = field.ident.as_ref().expect("a name").to_string();
            format!("    {};\n", joined(&in_c(&field.ty), &name))
        };
        let fields: String = one.fields.iter().map(field).collect();
        let declaration = format!("typedef struct {0} {{\n{fields}}} {0};\n", one.ident);
        assert!(text.contains(&declaration), "the header lacks\n{declaration}");
        count += 1;
    }
    assert_eq!(count, 3);
}

#[test]
fn the_header_has_the_version_of_the_library() {
    let text = header();
    for (part, value) in [
        ("MAJOR", env!("CARGO_PKG_VERSION_MAJOR")),
        ("MINOR", env!("CARGO_PKG_VERSION_MINOR")),
        ("PATCH", env!("CARGO_PKG_VERSION_PATCH")),
    ] {
        assert!(text.contains(&format!("#define QLESS_VERSION_{part} {value}\n")), "{part}");
    }
}

/// The names that programs link against; a name that goes, or whose arguments change, needs a new number of the shared library.
#[test]
fn the_list_of_names_is_that_of_the_file() {
    let listed = std::fs::read_to_string(format!("{HERE}/abi.txt")).expect("abi.txt");
    let defined: Vec<String> = defined().into_values().collect();
    assert_eq!(listed.lines().collect::<Vec<_>>(), defined, "abi.txt");
}
