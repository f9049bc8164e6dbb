//! Tests that need what not every machine has.
//!
//! Where it is missing they read *ignored*, never passed. What the machine has is found out when this package is built, so that neither
//! the library nor the program has a build script that follows the environment.

use proc_macro::{TokenStream, TokenTree};

/// What a test may need: its name, whether it is there, and what is said where it is not.
const KNOWN: [(&str, bool, &str); 3] = [
    ("gpu", cfg!(has_gpu), "a graphics adapter"),
    ("data", cfg!(has_data), "TYNDALL_DATA, the folder of test data"),
    ("display", cfg!(has_display), "Xvfb"),
];

/// Says in front of `#[test]` what a test needs: `#[needs(gpu)]`, `#[needs(gpu, data)]`, `#[needs(display)]`.
#[proc_macro_attribute]
pub fn needs(needed: TokenStream, test: TokenStream) -> TokenStream {
    match ignored(needed, &test) {
        // `#[test]` looks for `#[ignore]` when it is expanded, which is after this.
        Ok(reason) => reason.into_iter().flat_map(|text| tokens(&text)).chain(test).collect(),
        Err(message) => tokens(&format!("compile_error!({message:?});")),
    }
}

/// The attribute that ignores a test which lacks something, or what is wrong with how it says what it needs.
fn ignored(needed: TokenStream, test: &TokenStream) -> Result<Option<String>, String> {
    if !has_test_attribute(test) {
        return Err("`#[needs(…)]` stands in front of `#[test]`".into());
    }
    let mut missing = Vec::new();
    for token in needed {
        match token {
            TokenTree::Punct(comma) if comma.as_char() == ',' => {}
            token => {
                let name = token.to_string();
                let known = KNOWN.iter().find(|(known, ..)| *known == name);
                let (_, is_there, what) = known.ok_or_else(|| {
                    let all = KNOWN.map(|(name, ..)| name).join(", ");
                    format!("a test cannot need `{name}`; known are: {all}")
                })?;
                missing.extend((!is_there).then_some(*what));
            }
        }
    }
    Ok((!missing.is_empty()).then(|| format!("#[ignore = \"needs {}\"]", missing.join(" and "))))
}

/// Whether `#[test]` is still to come.
fn has_test_attribute(test: &TokenStream) -> bool {
    test.clone().into_iter().any(|token| match token {
        TokenTree::Group(group) => group.stream().to_string() == "test",
        _ => false,
    })
}

fn tokens(text: &str) -> TokenStream {
    text.parse().unwrap_or_default()
}
