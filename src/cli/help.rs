//! `tyndall help`: commands, and the documentation of components.

mod fields;
mod markdown;

use super::arguments::{Arguments, HelpArguments};
use super::exit::Failure;
use super::terminal;
use crate::scene::{Known, meant};
use bevy_app::App;
use bevy_ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy_reflect::{TypeInfo, TypeRegistration, TypeRegistry};
use clap::CommandFactory;
use fields::Listing;
use std::io::IsTerminal;

/// Columns where the output is not a terminal, and at most.
const WIDTH: usize = 100;

pub(super) fn run(app: &App, arguments: &HelpArguments) -> Result<(), Failure> {
    let mut command = Arguments::command();
    command.build();
    let Some(topic) = arguments.topic.as_deref() else {
        return terminal::data(&command.render_long_help().to_string());
    };
    if let Some(command) = command.find_subcommand_mut(topic) {
        return terminal::data(&command.render_long_help().to_string());
    }
    let registry = app.world().resource::<AppTypeRegistry>().read();
    if topic.eq_ignore_ascii_case("components") {
        return terminal::data(&list(&registry, width()));
    }
    match find(&registry, topic) {
        Some(registration) => terminal::data(&page(&registry, registration, width())),
        None => Err(unknown(&registry, &command, topic)),
    }
}

/// The type that a topic names: a component, else any type that stands in one; in small or capital letters.
fn find<'r>(registry: &'r TypeRegistry, topic: &str) -> Option<&'r TypeRegistration> {
    let named = || {
        let name = |registration: &TypeRegistration| registration.type_info().type_path_table().short_path();
        registry.iter().filter(move |registration| name(registration).eq_ignore_ascii_case(topic))
    };
    let component = named().find(|registration| registration.data::<ReflectComponent>().is_some());
    component.or_else(|| named().find(|registration| docs(registration.type_info()).is_some()))
}

fn docs(info: &'static TypeInfo) -> Option<&'static str> {
    info.docs().filter(|docs| !docs.trim().is_empty())
}

/// All that there is to be told of a type.
fn page(registry: &TypeRegistry, registration: &TypeRegistration, width: usize) -> String {
    let info = registration.type_info();
    let docs =
        docs(info).map_or_else(|| "It has no documentation.".into(), |docs| markdown::laid_out(docs, width));
    let mut parts = vec![title(info), docs];
    parts.extend(Listing::new(registry, width).parts(registration));
    parts.join("\n\n") + "\n"
}

/// Its name, and where it comes from if that is a plugin.
fn title(info: &'static TypeInfo) -> String {
    let name = info.type_path_table().short_path();
    plugin(info).map_or(name.to_owned(), |plugin| format!("{name} (of {plugin})"))
}

/// The crate of a component that is not of the framework.
fn plugin(info: &'static TypeInfo) -> Option<&'static str> {
    info.type_path_table().crate_name().filter(|name| *name != env!("CARGO_CRATE_NAME"))
}

/// Every component with its first sentence.
fn list(registry: &TypeRegistry, width: usize) -> String {
    let mut components: Vec<&'static TypeInfo> = registry
        .iter()
        .filter(|registration| registration.data::<ReflectComponent>().is_some())
        .map(TypeRegistration::type_info)
        .collect();
    components.sort_unstable_by_key(|info| info.type_path_table().short_path());
    let longest = components.iter().map(|info| title(info).chars().count()).max().unwrap_or(0);
    let mut text = String::new();
    for info in components {
        let sentence = markdown::first_sentence(docs(info).unwrap_or_default());
        let head = format!("{:longest$}  ", title(info));
        text += &markdown::wrapped(&sentence, width, &head, &" ".repeat(longest + 2));
        text += "\n";
    }
    text + "\n`tyndall help NAME` tells of one of them, `tyndall help SceneSettings` of the head of a scene.\n"
}

fn unknown(registry: &TypeRegistry, command: &clap::Command, topic: &str) -> Failure {
    let mut known = Known::components(registry);
    known.extend(command.get_subcommands().map(|command| Known::plain(command.get_name())));
    known.push(Known::plain("components"));
    let meant: Vec<String> = meant(topic, &known).iter().map(|name| format!("`{name}`")).collect();
    let help = match meant.is_empty() {
        true => "`tyndall help components` lists all components".into(),
        false => format!("did you mean {}?", meant.join(" or ")),
    };
    Failure::Usage(format!("there is no command and no component `{topic}`: {help}"))
}

fn width() -> usize {
    let terminal = terminal_size::terminal_size().filter(|_| std::io::stdout().is_terminal());
    terminal.map_or(WIDTH, |(width, _)| usize::from(width.0).clamp(20, WIDTH))
}
