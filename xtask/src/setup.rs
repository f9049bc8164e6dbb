//! `cargo xtask setup`: make this machine able to draw, and with `--ci` to run the whole gate.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::adapter::{self, Adapter, Missing};
use crate::process::{self, Program};
use crate::tools;

const DEBIAN_PACKAGES: [&str; 2] = ["mesa-vulkan-drivers", "libvulkan1"];

/// An X server in memory and what a window loads at run time; nothing of this is needed to compile.
const DEBIAN_WINDOW_PACKAGES: [&str; 7] =
    ["xvfb", "libx11-6", "libx11-xcb1", "libxcursor1", "libxi6", "libxkbcommon0", "libxkbcommon-x11-0"];

/// Finds or installs an adapter and what the tests of the window take and, for the gate, the tools.
pub fn run(ci: bool) -> Result<()> {
    match adapter()? {
        Adapter::System(name) => eprintln!("adapter: {name}, part of the system"),
        Adapter::Vulkan(manifest) => eprintln!("adapter: Vulkan, by {}", manifest.display()),
    }
    eprintln!("window: {}", window()?);
    if ci { tools::install_missing() } else { Ok(()) }
}

/// What windows are tested on, installed first where that is possible without asking. Without it those tests are ignored.
fn window() -> Result<String> {
    if !cfg!(target_os = "linux") {
        return Ok("its tests need Xvfb, and are ignored here".to_owned());
    }
    if process::find("Xvfb").is_none() && is_debian() && is_root() {
        eprintln!("no Xvfb\ninstalling {}", DEBIAN_WINDOW_PACKAGES.join(" "));
        install_on_debian(&DEBIAN_WINDOW_PACKAGES)?;
    }
    Ok(match process::find("Xvfb") {
        Some(server) => format!("tested on {}", server.display()),
        None => format!(
            "its tests are ignored without Xvfb; on Debian, as root:\n    apt-get install {}",
            DEBIAN_WINDOW_PACKAGES.join(" ")
        ),
    })
}

/// The adapter, installed first where that is possible without asking.
pub fn adapter() -> Result<Adapter> {
    let missing = match adapter::find() {
        Ok(adapter) => return Ok(adapter),
        Err(missing) => missing,
    };
    if !is_debian() || !is_root() {
        bail!("{}\n{}", complaint(&missing), advice(&os_release()));
    }
    eprintln!("{}\ninstalling {}", complaint(&missing), DEBIAN_PACKAGES.join(" and "));
    install_on_debian(&DEBIAN_PACKAGES)?;
    adapter::find().map_err(|missing| {
        let set = "Are VK_ICD_FILENAMES, VK_DRIVER_FILES or LD_LIBRARY_PATH set to something else?";
        anyhow::anyhow!(
            "{} even after installing {}. {set}",
            complaint(&missing),
            DEBIAN_PACKAGES.join(" and ")
        )
    })
}

fn complaint(missing: &Missing) -> &'static str {
    match missing {
        Missing::Loader => "no GPU adapter: the Vulkan loader, libvulkan.so.1, was not found",
        Missing::Driver => "no GPU adapter: no Vulkan driver that could work here was found",
    }
}

fn install_on_debian(packages: &[&str]) -> Result<()> {
    let apt_get = |arguments: &[&str]| {
        let wait_for_others = ["-o", "DPkg::Lock::Timeout=300"];
        Program::new("apt-get")
            .arguments(arguments)
            .arguments(wait_for_others)
            .variable("DEBIAN_FRONTEND", "noninteractive")
    };
    let install = || apt_get(&["install", "-y", "--no-install-recommends"]).arguments(packages);
    // The package lists of a fresh image are empty, those of an old one name files that are gone.
    if install().capture().is_ok() {
        return Ok(());
    }
    apt_get(&["update"]).run()?;
    install().run()
}

fn is_debian() -> bool {
    Path::new("/etc/debian_version").exists() && process::find("apt-get").is_some()
}

fn is_root() -> bool {
    Program::new("id").arguments(["-u"]).capture().is_ok_and(|id| id.trim() == "0")
}

fn os_release() -> String {
    fs::read_to_string("/etc/os-release").unwrap_or_default()
}

/// What to type on the system that /etc/os-release describes.
fn advice(os_release: &str) -> String {
    let value = |key: &str| {
        let line = os_release.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix('='));
        line.unwrap_or_default().trim_matches('"').to_owned()
    };
    let families = format!("{} {}", value("ID"), value("ID_LIKE"));
    let known = families.split_whitespace().find_map(|family| {
        Some(match family {
            "debian" | "ubuntu" => "apt-get install mesa-vulkan-drivers libvulkan1",
            "fedora" | "rhel" | "centos" => "dnf install mesa-vulkan-drivers vulkan-loader",
            "arch" => "pacman -S vulkan-swrast vulkan-icd-loader",
            "suse" | "opensuse" => "zypper install libvulkan_lvp libvulkan1",
            "alpine" => "apk add mesa-vulkan-swrast vulkan-loader",
            _ => return None,
        })
    });
    match known {
        Some(command) => {
            format!("Install your GPU's Vulkan driver, or the software one, as root:\n    {command}")
        }
        None => {
            "Install the Vulkan loader and your GPU's Vulkan driver, or Mesa's software driver, lavapipe."
                .to_owned()
        }
    }
}

/// The adapter and the variables that go with it, for commands that run the program.
pub fn environment() -> Result<crate::environment::Environment> {
    adapter()?;
    crate::environment::Environment::new().context("cannot prepare the environment of the program")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_fits_the_system() {
        assert!(advice("ID=ubuntu\nID_LIKE=debian\n").contains("apt-get install"));
        assert!(advice("ID=\"rocky\"\nID_LIKE=\"rhel centos fedora\"\n").contains("dnf install"));
        assert!(advice("NAME=\"Arch Linux\"\nID=arch\n").contains("pacman -S"));
        assert!(advice("ID=\"opensuse-leap\"\nID_LIKE=\"suse opensuse\"\n").contains("zypper install"));
        assert!(advice("ID=alpine\n").contains("apk add"));
        assert!(advice("").contains("lavapipe"));
    }
}
